#include "apps/run_folder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <stdexcept>
#include <sys/resource.h>
#include <unistd.h>

namespace apps
{
  namespace
  {
    /** All that a run leaves; nothing else is ever removed. */
    constexpr const char *entries_of_a_run[] = {
        "parameters.prm", "history.csv",   "summary.json",           "breakage.csv", "jumps.csv", "fractures.csv",
        "costs.csv",      "checkpoint.h5", "checkpoint_previous.h5", "snapshots",    "fields",    "fields.pvd",
        "figures",        "failures"};
    constexpr const char *files_that_mean_a_run[] = {"parameters.prm", "history.csv", "summary.json", "checkpoint.h5"};

    [[noreturn]] void fail(const std::string &path, const std::string &cause)
    {
      throw std::runtime_error(fmt::format("{}: cannot be written: {}", path, cause));
    }

    void create_folder(const std::string &path)
    {
      std::error_code error;
      std::filesystem::create_directories(path, error);
      if (error)
        fail(path, error.message());
    }

    std::string find_run(const std::string &path)
    {
      for (const char *name : files_that_mean_a_run)
        if (std::filesystem::exists(path + "/" + name))
          return name;
      return "";
    }
  } // namespace

  RunFolder::RunFolder(const CommandLine &line)
      : path_(line.output), is_resumed_(line.is_resumed), may_overwrite_(line.may_overwrite)
  {}

  void RunFolder::check() const
  {
    if (std::filesystem::exists(path_) && !std::filesystem::is_directory(path_))
      throw BadInput(fmt::format("{}: is not a folder", path_));
    const std::string found = find_run(path_);
    if (is_resumed_ && !std::filesystem::exists(get_file("checkpoint.h5")) &&
        !std::filesystem::exists(get_file("checkpoint_previous.h5")))
      throw BadInput(fmt::format("{}: holds no checkpoint.h5 to resume from", path_));
    if (!is_resumed_ && !may_overwrite_ && !found.empty())
      throw BadInput(
          fmt::format("{}: holds a run already ({}); give another --output, or --resume {} to go on with it, "
                      "or --overwrite to remove it",
                      path_, found, path_));
  }

  void RunFolder::prepare(const std::string &parameters) const
  {
    create_folder(path_);
    if (!is_resumed_)
      for (const char *name : entries_of_a_run)
        std::filesystem::remove_all(get_file(name));
    create_folder(get_file("snapshots"));
    write_text_file(get_file("parameters.prm"), parameters);
  }

  std::string RunFolder::get_snapshot_file(const std::string &name) const
  {
    return get_file("snapshots/" + name + ".h5");
  }

  void RunFolder::write_summary(const Summary &summary) const
  {
    nlohmann::ordered_json json;
    json["program"] = "slowsand";
    json["version"] = get_version();
    json["git_revision"] = get_git_revision();
    json["march"] = get_march();
    json["status"] = summary.status;
    json["seed"] = summary.seed;
    json["ranks"] = summary.n_ranks;
    json["threads"] = summary.n_threads;
    json["grains"] = summary.grains;
    json["cycles"] = summary.cycles;
    json["broken_instant"] = summary.broken_instant;
    json["broken_delayed"] = summary.broken_delayed;
    for (const auto &[name, finding] : summary.findings)
      std::visit([&, &key = name](const auto &value) { json[key] = value; }, finding);
    json["wall_s"] = summary.wall_s;
    for (std::size_t part = 0; part < dem::part_names.size(); ++part)
      json["profile_s"][dem::part_names[part]] = summary.profile.seconds[part];
    json["profile_s"]["output"] = summary.output_s;
    json["figures"] = summary.figures;
    json["peak_memory_bytes"] = measure_peak_memory();
    write_text_file(get_file("summary.json"), json.dump(2) + "\n");
  }

  void write_text_file(const std::string &file, const std::string &text)
  {
    const std::string temporary = file + ".tmp";
    std::FILE *stream = std::fopen(temporary.c_str(), "w");
    if (stream == nullptr)
      fail(file, std::strerror(errno));
    bool is_written = std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    is_written = std::fflush(stream) == 0 && is_written && ::fsync(::fileno(stream)) == 0;
    const std::string cause = std::strerror(errno);
    std::fclose(stream);
    if (!is_written)
      {
        std::remove(temporary.c_str());
        fail(file, cause);
      }
    if (std::rename(temporary.c_str(), file.c_str()) != 0)
      fail(file, std::strerror(errno));
  }

  std::uint64_t measure_peak_memory()
  {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024; // the kernel counts kilobytes
  }
} // namespace apps
