#include "apps/parameter_binder.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <numeric>

namespace apps
{
  namespace
  {
    /** Letters to change, add or take away to make one word of the other: finds what a misspelt name was to be. */
    std::size_t compute_distance(const std::string &a, const std::string &b)
    {
      std::vector<std::size_t> row(b.size() + 1);
      std::iota(row.begin(), row.end(), std::size_t(0));
      for (std::size_t i = 1; i <= a.size(); ++i)
        {
          std::size_t diagonal = std::exchange(row[0], i);
          for (std::size_t j = 1; j <= b.size(); ++j)
            {
              const std::size_t change = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
              diagonal = row[j];
              row[j] = std::min({change, row[j] + 1, row[j - 1] + 1});
            }
        }
      return row.back();
    }

    /** The shortest text that reads back as the same number. */
    std::string write_number(const double value)
    {
      for (int digits = 1; digits < 17; ++digits)
        if (const std::string text = fmt::format("{:.{}g}", value, digits); std::strtod(text.c_str(), nullptr) == value)
          return text;
      return fmt::format("{:.17g}", value);
    }

    std::vector<std::string> split_list(const std::string &text)
    {
      std::vector<std::string> parts;
      for (std::size_t begin = 0; begin <= text.size() && !text.empty();)
        {
          const std::size_t end = std::min(text.find(',', begin), text.size());
          const auto first = text.find_first_not_of(' ', begin);
          const auto last = text.find_last_not_of(' ', end - 1);
          parts.push_back(first < end && last >= first ? text.substr(first, last - first + 1) : "");
          begin = end + 1;
        }
      return parts;
    }

    std::string describe_refusal(const std::string &where, const std::string &path, const std::string &value,
                                 const BadInput &allowed)
    {
      return fmt::format("{}: parameter '{}' = '{}' is not allowed; allowed: {}", where, path, value,
                         std::string(allowed.what()));
    }
  } // namespace

  bool Range::contains(const double value) const
  {
    return (excludes_lowest ? value > lowest : value >= lowest) &&
           (excludes_highest ? value < highest : value <= highest);
  }

  std::string Range::describe() const
  {
    std::string text;
    if (std::isfinite(lowest))
      text = fmt::format("{} {:g}", excludes_lowest ? ">" : ">=", lowest);
    if (std::isfinite(highest))
      text += fmt::format("{}{} {:g}", text.empty() ? "" : " and ", excludes_highest ? "<" : "<=", highest);
    return text.empty() ? "any number" : text;
  }

  double ParameterBinder::parse_number(const std::string &value, const Range &range, const bool is_integer)
  {
    const std::string allowed = (is_integer ? "integer " : "number ") + range.describe();
    double number = 0.;
    const char *first = value.data() + (value.rfind('+', 0) == 0 ? 1 : 0), *last = value.data() + value.size();
    const auto [end, error] = std::from_chars(first, last, number);
    // Integers beyond 2^53 would lose digits on their way through a double.
    const bool fits = !is_integer || (number == std::floor(number) && std::abs(number) <= 9007199254740992.);
    if (error != std::errc() || end != last || !std::isfinite(number) || !fits || !range.contains(number))
      throw BadInput(allowed);
    return number;
  }

  unsigned int ParameterBinder::read_number(const ParameterFile &file, const std::string &path, const Range &range,
                                            const unsigned int otherwise)
  {
    const auto given = file.find(path);
    if (!given)
      return otherwise;
    try
      {
        return static_cast<unsigned int>(parse_number(*given, range, true));
      }
    catch (const BadInput &allowed)
      {
        throw BadInput(describe_refusal(file.locate(path), path, *given, allowed));
      }
  }

  void ParameterBinder::enter(const std::string &section)
  {
    sections_.push_back(section);
    handler_.enter_subsection(section);
  }

  void ParameterBinder::leave()
  {
    sections_.pop_back();
    handler_.leave_subsection();
  }

  void ParameterBinder::declare(const std::string &name, const std::string &value, const std::string &text, Take take)
  {
    handler_.declare_entry(name, value, dealii::Patterns::Anything(), text);
    std::string path;
    for (const std::string &section : sections_)
      path += section + "/";
    bindings_.push_back({path + name, sections_, name, std::move(take)});
  }

  void ParameterBinder::bind(const std::string &name, double &member, const Range &range, const std::string &text)
  {
    declare(name, write_number(member), text + " Range: " + range.describe() + ".",
            [&member, range](const std::string &value) { member = parse_number(value, range, false); });
  }

  void ParameterBinder::bind(const std::string &name, bool &member, const std::string &text)
  {
    bind_choice(name, member, {{"true", true}, {"false", false}}, text);
  }

  void ParameterBinder::bind(const std::string &name, std::string &member, const std::string &text)
  {
    declare(name, member, text, [&member](const std::string &value) { member = value; });
  }

  void ParameterBinder::bind_fixed(const std::string &name, const unsigned int value, const Range &range,
                                   const std::string &text)
  {
    declare(name, std::to_string(value), text + " Range: integer " + range.describe() + ".",
            [range](const std::string &given) { parse_number(given, range, true); });
  }

  void ParameterBinder::bind_list(const std::string &name, std::vector<double> &member, const std::size_t n,
                                  const std::string &text)
  {
    const std::string allowed = n == 0 ? "comma-separated numbers" : fmt::format("{} comma-separated numbers", n);
    std::string present;
    for (const double value : member)
      present += (present.empty() ? "" : ", ") + write_number(value);
    declare(name, present, text + " Range: " + allowed + ".", [&member, n, allowed](const std::string &value) {
      std::vector<double> numbers;
      try
        {
          for (const std::string &part : split_list(value))
            numbers.push_back(parse_number(part, any_number, false));
        }
      catch (const BadInput &)
        {
          throw BadInput(allowed);
        }
      if (n != 0 && numbers.size() != n)
        throw BadInput(allowed);
      member = numbers;
    });
  }

  ParameterBinder::Binding *ParameterBinder::find(const std::string &path)
  {
    const auto found =
        std::find_if(bindings_.begin(), bindings_.end(), [&](const Binding &binding) { return binding.path == path; });
    return found == bindings_.end() ? nullptr : &*found;
  }

  void ParameterBinder::read(const ParameterFile &file)
  {
    file_ = file;
    for (const ParameterEntry &entry : file.get_entries())
      {
        const Binding *binding = find(entry.path);
        if (binding == nullptr)
          reject_unknown(entry);
        try
          {
            binding->take(entry.value);
          }
        catch (const BadInput &allowed)
          {
            throw BadInput(describe_refusal(entry.where, entry.path, entry.value, allowed));
          }
        for (const std::string &section : binding->sections)
          handler_.enter_subsection(section);
        handler_.set(binding->name, entry.value);
        for (std::size_t i = 0; i < binding->sections.size(); ++i)
          handler_.leave_subsection();
      }
  }

  void ParameterBinder::reject_unknown(const ParameterEntry &entry) const
  {
    std::string nearest;
    std::size_t smallest = entry.path.size() / 2 + 2;
    for (const Binding &binding : bindings_)
      if (const std::size_t distance = compute_distance(binding.path, entry.path); distance < smallest)
        {
          smallest = distance;
          nearest = binding.path;
        }
    throw BadInput(fmt::format("{}: unknown parameter '{}' = '{}'{}; allowed: those that --template prints",
                               entry.where, entry.path, entry.value,
                               nearest.empty() ? "" : fmt::format("; did you mean '{}'?", nearest)));
  }

  void ParameterBinder::reject(const std::string &path, const std::string &why) const
  {
    const auto given = file_.find(path);
    throw BadInput(fmt::format("{}: parameter '{}'{} {}", file_.locate(path), path,
                               given ? fmt::format(" = '{}'", *given) : "", why));
  }

  void ParameterBinder::print(std::ostream &stream) const
  {
    handler_.print_parameters(stream, dealii::ParameterHandler::PRM | dealii::ParameterHandler::KeepDeclarationOrder);
  }
} // namespace apps
