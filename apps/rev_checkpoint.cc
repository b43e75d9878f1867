#include "apps/rev_checkpoint.h"

#include "dem/snapshot.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <stdexcept>

namespace apps
{
  namespace
  {
    constexpr const char *position_dataset = "/progress/position";

    // The shortest decimals that read back as the same numbers: a resumed run has the same bits.
    nlohmann::json to_json(const dem::Matrix &matrix)
    {
      return std::vector<double>(matrix.data(), matrix.data() + 9);
    }

    dem::Matrix to_matrix(const nlohmann::json &json)
    {
      const auto values = json.get<std::vector<double>>();
      if (values.size() != 9)
        throw std::invalid_argument("a tensor has not nine entries");
      return Eigen::Map<const dem::Matrix>(values.data());
    }

    std::string write_position(const RevCheckpoint &checkpoint)
    {
      const dem::LaboratoryPosition &position = checkpoint.position;
      return nlohmann::json{{"stage", position.stage},
                            {"share", position.share},
                            {"share_step", position.share_step},
                            {"time_in_stage_s", position.time_in_stage},
                            {"n_cuts", position.n_cuts},
                            {"stress_at_start_Pa", to_json(position.stress_at_start)},
                            {"strain_at_start", to_json(position.strain_at_start)},
                            {"history_rows", checkpoint.n_rows}}
          .dump(1);
    }

    void read_position(const std::string &text, RevCheckpoint &checkpoint)
    {
      const auto json = nlohmann::json::parse(text);
      dem::LaboratoryPosition &position = checkpoint.position;
      position.stage = json.at("stage").get<std::size_t>();
      position.share = json.at("share").get<double>();
      position.share_step = json.at("share_step").get<double>();
      position.time_in_stage = json.at("time_in_stage_s").get<double>();
      position.n_cuts = json.at("n_cuts").get<unsigned int>();
      position.stress_at_start = to_matrix(json.at("stress_at_start_Pa"));
      position.strain_at_start = to_matrix(json.at("strain_at_start"));
      checkpoint.n_rows = json.at("history_rows").get<std::uint64_t>();
    }
  } // namespace

  void write_rev_checkpoint(const std::string &file, const dem::Rev &rev, const RevCheckpoint &checkpoint)
  {
    const std::string unfinished = file + ".part";
    try
      {
        dem::write_snapshot(unfinished, checkpoint.state, dem::list_contacts(checkpoint.state, rev.get_law()),
                            {rev.get_model().identity.seed, rev.get_model().identity.rev});
        dem::write_text(unfinished, position_dataset, write_position(checkpoint));
        dem::publish_file(unfinished, file);
      }
    catch (...)
      {
        std::error_code ignored; // what went wrong first is what counts
        std::filesystem::remove(unfinished, ignored);
        throw;
      }
  }

  RevCheckpoint read_rev_checkpoint(const std::string &file)
  {
    RevCheckpoint checkpoint;
    checkpoint.state = dem::read_snapshot(file).state;
    const std::string text = dem::read_text(file, position_dataset);
    try
      {
        read_position(text, checkpoint);
      }
    catch (const std::exception &error)
      {
        throw std::runtime_error(fmt::format("{}: {}: {}", file, position_dataset, std::string(error.what())));
      }
    return checkpoint;
  }
} // namespace apps
