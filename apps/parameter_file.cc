#include "apps/parameter_file.h"

#include "apps/bad_input.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

namespace apps
{
  namespace
  {
    std::string read_text(const std::string &file)
    {
      std::ifstream stream(file);
      std::ostringstream text;
      if (stream && !std::filesystem::is_directory(file))
        text << stream.rdbuf();
      if (!stream || std::filesystem::is_directory(file))
        throw BadInput(fmt::format("{}: cannot be read: {}", file, std::strerror(errno != 0 ? errno : EISDIR)));
      return text.str();
    }

    std::string trim(const std::string &text)
    {
      const auto first = text.find_first_not_of(" \t\r");
      return first == std::string::npos ? "" : text.substr(first, text.find_last_not_of(" \t\r") - first + 1);
    }

    std::string join(const std::vector<std::string> &sections, const std::string &name)
    {
      std::string path;
      for (const std::string &section : sections)
        path += section + "/";
      return path + name;
    }

    bool starts_with(const std::string &text, const std::string &word)
    {
      return text.rfind(word + " ", 0) == 0 || text.rfind(word + "\t", 0) == 0;
    }

    /** The lines of a .prm file one by one, with the sections that are open. */
    class PrmScanner
    {
    public:
      explicit PrmScanner(const std::string &file) : file_(file) {}

      std::vector<ParameterEntry> scan()
      {
        std::istringstream text(read_text(file_));
        for (std::string raw, line; std::getline(text, raw);)
          {
            ++n_lines_;
            line += trim(raw.substr(0, raw.find('#')));
            if (!line.empty() && line.back() == '\\') // goes on in the next line
              line.back() = ' ';
            else
              take(std::exchange(line, ""));
          }
        if (!sections_.empty())
          reject(fmt::format("the file ends inside subsection '{}'", sections_.back()));
        return entries_;
      }

    private:
      [[noreturn]] void reject(const std::string &why) const { throw BadInput(fmt::format("{}: {}", where(), why)); }

      std::string where() const { return fmt::format("{}, line {}", file_, n_lines_); }

      void take(const std::string &line)
      {
        if (line.empty())
          return;
        if (starts_with(line, "subsection"))
          sections_.push_back(trim(line.substr(10)));
        else if (line == "end" && !sections_.empty())
          sections_.pop_back();
        else if (line == "end")
          reject("'end' without a subsection");
        else if (starts_with(line, "set") && line.find('=') != std::string::npos)
          {
            const auto equals = line.find('=');
            entries_.push_back(
                {join(sections_, trim(line.substr(3, equals - 3))), trim(line.substr(equals + 1)), where()});
          }
        else
          reject(fmt::format("'{}' is neither 'set NAME = VALUE', 'subsection NAME', 'end' nor a comment", line));
      }

      std::string file_;
      std::size_t n_lines_ = 0;
      std::vector<std::string> sections_;
      std::vector<ParameterEntry> entries_;
    };

    /** The entries of a .json file; nlohmann keeps no positions, so each key is searched for behind the one before. */
    class JsonScanner
    {
    public:
      explicit JsonScanner(const std::string &file) : file_(file), text_(read_text(file)) {}

      std::vector<ParameterEntry> scan()
      {
        try
          {
            walk(nlohmann::ordered_json::parse(text_));
          }
        catch (const nlohmann::json::parse_error &error)
          {
            throw BadInput(fmt::format("{}: not valid JSON: {}", where(std::min(error.byte, text_.size())),
                                       std::string(error.what())));
          }
        return entries_;
      }

    private:
      std::string where(const std::size_t position) const
      {
        return fmt::format("{}, line {}", file_, 1 + std::count(text_.begin(), text_.begin() + position, '\n'));
      }

      void walk(const nlohmann::ordered_json &object)
      {
        if (!object.is_object())
          throw BadInput(fmt::format("{}: a parameter file is a JSON object", where(position_)));
        for (const auto &[key, value] : object.items())
          {
            const std::string quoted = nlohmann::json(key).dump();
            position_ = std::min(text_.find(quoted, position_), text_.size());
            const std::string here = where(position_);
            position_ += quoted.size();
            if (value.is_object())
              {
                sections_.push_back(key);
                walk(value);
                sections_.pop_back();
              }
            else if (value.is_array() || value.is_null())
              throw BadInput(fmt::format("{}: parameter '{}' is neither text, a number, true nor false", here,
                                         join(sections_, key)));
            else
              entries_.push_back(
                  {join(sections_, key), value.is_string() ? trim(value.get<std::string>()) : value.dump(), here});
          }
      }

      std::string file_, text_;
      std::size_t position_ = 0;
      std::vector<std::string> sections_;
      std::vector<ParameterEntry> entries_;
    };
  } // namespace

  ParameterFile::ParameterFile(const std::string &file)
  {
    const bool is_json = std::filesystem::path(file).extension() == ".json";
    for (const ParameterEntry &entry : is_json ? JsonScanner(file).scan() : PrmScanner(file).scan())
      {
        if (find(entry.path))
          throw BadInput(fmt::format("{}: parameter '{}' is given twice, first at {}", entry.where, entry.path,
                                     locate(entry.path)));
        entries_.push_back(entry);
      }
  }

  void ParameterFile::override_with(const std::string &assignment)
  {
    const auto equals = assignment.find('=');
    if (equals == std::string::npos)
      throw BadInput(fmt::format("--set '{}': not of the form \"Section/Name=value\"", assignment));
    const ParameterEntry entry{trim(assignment.substr(0, equals)), trim(assignment.substr(equals + 1)), "--set"};
    std::erase_if(entries_, [&](const ParameterEntry &other) { return other.path == entry.path; });
    entries_.push_back(entry);
  }

  std::optional<std::string> ParameterFile::find(const std::string &path) const
  {
    for (const ParameterEntry &entry : entries_)
      if (entry.path == path)
        return entry.value;
    return std::nullopt;
  }

  std::string ParameterFile::locate(const std::string &path) const
  {
    for (const ParameterEntry &entry : entries_)
      if (entry.path == path)
        return entry.where;
    return "default";
  }
} // namespace apps
