#pragma once

#include <optional>
#include <string>
#include <vector>

namespace apps
{
  /** One "name = value" as the user gave it. */
  struct ParameterEntry
  {
    std::string path;  ///< "Section/Subsection/Name"
    std::string value; ///< trimmed
    std::string where; ///< "case.prm, line 7", or "--set"
  };

  /**
   * What a parameter file says, with the place of each word, before anything is known of what may stand there.
   *
   * The syntax is that of deal.II's ParameterHandler (.prm, or .json with the plain names as keys). The file is scanned
   * here because ParameterHandler does not say where in a .json file an error lies, and because the number of stages
   * must be known before the stages can be declared.
   */
  class ParameterFile
  {
  public:
    /** Nothing given: every parameter keeps its default. */
    ParameterFile() = default;

    /** Throws BadInput: unreadable file, a line that cannot be understood, a parameter given twice. */
    explicit ParameterFile(const std::string &file);

    /** Takes "Section/Name=value" from the command line; it beats the file. Throws BadInput without an equals sign. */
    void override_with(const std::string &assignment);

    /** The value given to a parameter, if any. */
    std::optional<std::string> find(const std::string &path) const;

    /** Where a parameter got its value: "case.prm, line 7", "--set" or "default". */
    std::string locate(const std::string &path) const;

    const std::vector<ParameterEntry> &get_entries() const { return entries_; }

  private:
    std::vector<ParameterEntry> entries_;
  };
} // namespace apps
