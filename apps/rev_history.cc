#include "apps/rev_history.h"

#include "apps/bad_input.h"

#include <fmt/format.h>

#include <limits>

namespace apps
{
  namespace
  {
    using Columns = std::vector<std::string>;

    void add(Columns &columns, const Columns &more)
    {
      columns.insert(columns.end(), more.begin(), more.end());
    }

    Columns name_history_columns(const dem::CellKind kind)
    {
      Columns columns = {"time_s", "stage", "kind", "cycles"};
      add(columns, name_tensor_columns("strain", ""));
      add(columns, name_tensor_columns("stress", "_Pa"));
      add(columns, {"void_ratio", "void_ratio_with_fines", "grains", "broken_instant", "broken_delayed", "coordination",
                    "unbalanced_ratio"});
      if (kind == dem::CellKind::rigid)
        add(columns, {"wall_stress_xx_Pa", "wall_stress_yy_Pa", "wall_stress_zz_Pa"});
      return columns;
    }

    Columns name_breakage_columns()
    {
      Columns columns = {"time_s", "stage", "broken_instant", "broken_delayed", "fines_share"};
      for (const char *suffix : {"", "_with_fines"})
        for (const char *name :
             {"relative_breakage_hardin{}", "relative_breakage_einav{}", "d10{}_m", "d50{}_m", "d90{}_m"})
          columns.push_back(fmt::format(fmt::runtime(name), suffix));
      add(columns, {"whole_grains", "whole_strength_mean", "whole_strength_deviation", "whole_strength_smallest"});
      return columns;
    }

    Columns name_jump_columns()
    {
      Columns columns = {"jump", "stage", "time_s", "length_s", "broken", "cause", "cycles"};
      add(columns, name_tensor_columns("largest_deviation", "_Pa"));
      add(columns, name_tensor_columns("smallest_deviation", "_Pa"));
      add(columns, name_tensor_columns("strain_change", ""));
      return columns;
    }

    std::map<std::string, Columns> name_tables(const dem::CellKind kind)
    {
      return {{"history.csv", name_history_columns(kind)},
              {"breakage.csv", name_breakage_columns()},
              {"jumps.csv", name_jump_columns()},
              {"fractures.csv", {"time_s", "stage", "cause", "grain", "generation", "diameter_m", "strength_Pa"}}};
    }

    /** The six components that people read: compression-positive. */
    void add_tensor(HistoryRow &row, const dem::Matrix &tensor)
    {
      for (const auto &index : dem::tangent_index)
        row.add(-tensor(index[0], index[1]) + 0.); // no negative zero in a table
    }

    /** Deviations where a stress is controlled, nan elsewhere. */
    void add_deviations(HistoryRow &row, const dem::DynamicRecord &record, const std::array<double, 6> &deviation)
    {
      for (std::size_t m = 0; m < deviation.size(); ++m)
        row.add(record.is_stress_controlled[m] ? -deviation[m] + 0. : std::numeric_limits<double>::quiet_NaN());
    }
  } // namespace

  RevHistory::RevHistory(const std::string &folder, const dem::CellKind kind) : kind_(kind)
  {
    for (const auto &[name, columns] : name_tables(kind))
      tables_[name].file = std::make_unique<HistoryFile>(folder + "/" + name, columns);
  }

  RevHistory::RevHistory(const std::string &folder, const dem::CellKind kind, const RowCounts &kept) : kind_(kind)
  {
    for (const auto &[name, columns] : name_tables(kind))
      {
        const auto found = kept.find(name);
        if (found == kept.end())
          throw BadInput(fmt::format("{}/{}: the checkpoint counts no rows of this table", folder, name));
        Table &table = tables_[name];
        const auto is_kept = [&](const Columns &) { return table.n_rows < found->second && ++table.n_rows > 0; };
        table.file = std::make_unique<HistoryFile>(folder + "/" + name, columns, is_kept);
      }
  }

  void RevHistory::write_row(const std::string &name, const HistoryRow &row)
  {
    Table &table = tables_.at(name);
    table.file->write(row);
    ++table.n_rows;
  }

  void RevHistory::write(const dem::Observation &observation)
  {
    HistoryRow row;
    row.add(observation.time).add(observation.stage + 1).add(dem::describe(observation.kind));
    row.add(observation.counters.cycles);
    add_tensor(row, observation.strain);
    add_tensor(row, observation.stress);
    row.add(observation.void_ratio).add(observation.void_ratio_with_fines).add(observation.n_grains);
    row.add(observation.counters.broken_instant).add(observation.counters.broken_delayed);
    row.add(observation.coordination).add(observation.unbalanced_ratio);
    if (kind_ == dem::CellKind::rigid)
      for (const double stress : observation.wall_stress)
        row.add(-stress + 0.);
    write_row("history.csv", row);
  }

  void RevHistory::write(const dem::DynamicRecord &record)
  {
    HistoryRow row;
    row.add(tables_.at("jumps.csv").n_rows + 1).add(record.stage + 1).add(record.time).add(record.jump);
    row.add(record.n_broken).add(record.n_broken > 0 ? dem::describe(record.cause) : "none").add(record.n_cycles);
    add_deviations(row, record, record.smallest_deviation); // the other sign: the largest in compression
    add_deviations(row, record, record.largest_deviation);
    add_tensor(row, record.strain_change);
    write_row("jumps.csv", row);
  }

  void RevHistory::write(const dem::Fracture &fracture, const std::size_t stage)
  {
    HistoryRow row;
    row.add(fracture.time).add(stage + 1).add(dem::describe(fracture.cause)).add(fracture.grain);
    row.add(fracture.generation).add(fracture.diameter).add(fracture.strength);
    write_row("fractures.csv", row);
  }

  void RevHistory::write(const dem::BreakageMeasures &measures, const dem::Counters &counters, const double time,
                         const std::size_t stage)
  {
    HistoryRow row;
    row.add(time).add(stage).add(counters.broken_instant).add(counters.broken_delayed).add(measures.fines_share);
    for (const dem::GradingMeasures &grading : {measures.without_fines, measures.with_fines})
      row.add(grading.hardin).add(grading.einav).add(grading.d10).add(grading.d50).add(grading.d90);
    const dem::StrengthStatistics &whole = measures.whole;
    row.add(whole.n).add(whole.mean).add(whole.standard_deviation).add(whole.smallest);
    write_row("breakage.csv", row);
  }

  RowCounts RevHistory::count_rows() const
  {
    RowCounts counts;
    for (const auto &[name, table] : tables_)
      counts[name] = table.n_rows;
    return counts;
  }
} // namespace apps
