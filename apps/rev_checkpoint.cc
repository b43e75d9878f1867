#include "apps/rev_checkpoint.h"

#include "dem/rev_snapshot.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <stdexcept>

namespace apps
{
  namespace
  {
    constexpr const char *position_dataset = "/progress/position";
    constexpr const char *search_dataset = "/progress/before_search";

    /** 1: no strength, no search; read as such. */
    constexpr unsigned int format_version = 2;

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
      return nlohmann::json{{"format_version", format_version},
                            {"stage", position.stage},
                            {"share", position.share},
                            {"share_step", position.share_step},
                            {"time_in_stage_s", position.time_in_stage},
                            {"n_cuts", position.n_cuts},
                            {"stress_at_start_Pa", to_json(position.stress_at_start)},
                            {"strain_at_start", to_json(position.strain_at_start)},
                            {"strength_Pa", position.strength},
                            {"strain_at_strength", position.strain_at_strength},
                            {"is_searching", position.before_search.has_value()},
                            {"rows", checkpoint.n_rows},
                            {"initial_diameters_m", checkpoint.initial_diameters}}
          .dump();
    }

    /** @return whether a search is under way */
    bool read_position(const std::string &text, RevCheckpoint &checkpoint)
    {
      const auto json = nlohmann::json::parse(text);
      const auto version = json.value("format_version", 1u);
      if (version != format_version)
        throw std::invalid_argument(
            fmt::format("format_version is {}, this program reads {}", version, format_version));
      dem::LaboratoryPosition &position = checkpoint.position;
      position.stage = json.at("stage").get<std::size_t>();
      position.share = json.at("share").get<double>();
      position.share_step = json.at("share_step").get<double>();
      position.time_in_stage = json.at("time_in_stage_s").get<double>();
      position.n_cuts = json.at("n_cuts").get<unsigned int>();
      position.stress_at_start = to_matrix(json.at("stress_at_start_Pa"));
      position.strain_at_start = to_matrix(json.at("strain_at_start"));
      position.strength = json.at("strength_Pa").get<double>();
      position.strain_at_strength = json.at("strain_at_strength").get<double>();
      checkpoint.n_rows = json.at("rows").get<RowCounts>();
      checkpoint.initial_diameters = json.at("initial_diameters_m").get<std::vector<double>>();
      return json.at("is_searching").get<bool>();
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
        if (checkpoint.position.before_search)
          dem::write_bytes(unfinished, search_dataset, dem::serialise(*checkpoint.position.before_search));
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
        if (read_position(text, checkpoint))
          checkpoint.position.before_search = dem::deserialise(dem::read_bytes(file, search_dataset));
      }
    catch (const std::exception &error)
      {
        throw std::runtime_error(fmt::format("{}: {}: {}", file, position_dataset, std::string(error.what())));
      }
    return checkpoint;
  }
} // namespace apps
