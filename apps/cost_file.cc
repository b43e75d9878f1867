#include "apps/cost_file.h"

#include "coupling/rev_travel.h"

#include <cstdlib>
#include <filesystem>

namespace apps
{
  CostFile::CostFile(const std::string &file, const bool is_first_rank, const int resume_step)
  {
    if (!is_first_rank)
      return;
    const std::vector<std::string> columns = {"step", "stage", "time_s", "point", "rank", "cost_s", "size_B"};
    if (resume_step < 0 || !std::filesystem::exists(file))
      table_ = std::make_unique<HistoryFile>(file, columns);
    else
      table_ = std::make_unique<HistoryFile>(
          file, columns, [&](const std::vector<std::string> &row) { return std::atoi(row[0].c_str()) <= resume_step; });
  }

  void CostFile::write(const unsigned int step, const unsigned int stage, const double time,
                       const coupling::RevMaterial &material)
  {
    const coupling::RevPool &pool = material.get_pool();
    const auto sizes = pool.collect(1, [&](const coupling::PointId id, std::span<double> row) {
      row[0] = static_cast<double>(coupling::pack_rev(material.get_local_rev(id)).size());
    });
    if (!table_)
      return;
    for (std::size_t i = 0; i < sizes.size(); ++i)
      {
        const coupling::PointId id = pool.get_points()[i];
        HistoryRow row;
        row.add(step).add(stage).add(time).add(id).add(pool.get_owner(id)).add(pool.get_step_costs()[i]);
        table_->write(row.add(static_cast<std::uint64_t>(sizes[i])));
      }
  }
} // namespace apps
