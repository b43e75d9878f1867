#pragma once

#include "apps/bad_input.h"
#include "apps/parameter_file.h"

#include <deal.II/base/parameter_handler.h>

#include <concepts>
#include <functional>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

namespace apps
{
  /** Allowed values of a number. */
  struct Range
  {
    double lowest = -std::numeric_limits<double>::infinity();
    double highest = std::numeric_limits<double>::infinity();
    bool excludes_lowest = false;
    bool excludes_highest = false;

    bool contains(double value) const;
    std::string describe() const; ///< "> 0 and <= 1"
  };

  inline constexpr Range positive{0., std::numeric_limits<double>::infinity(), true, false};
  inline constexpr Range non_negative{0.};
  inline constexpr Range share{0., 1.};
  inline constexpr Range at_least_one{1.};
  inline constexpr Range any_number{};

  /**
   * Ties the members of plain structs to the names of a parameter file: name, member, text with units and range are
   * said once. The member's value at that moment is the default.
   *
   *     binder.enter("Grains");
   *     binder.bind("Friction", material.friction, non_negative, "mu. Units: [-].");
   *     binder.leave();
   *     ...
   *     binder.read(file);
   */
  class ParameterBinder
  {
  public:
    void enter(const std::string &section);
    void leave();

    void bind(const std::string &name, double &member, const Range &range, const std::string &text);
    void bind(const std::string &name, bool &member, const std::string &text);
    void bind(const std::string &name, std::string &member, const std::string &text);

    template <std::unsigned_integral Integer>
    void bind(const std::string &name, Integer &member, const Range &range, const std::string &text);

    /** How many subsections there are, before they can be bound. Throws BadInput as read(). @param path "Section/Name"
     */
    static unsigned int read_number(const ParameterFile &file, const std::string &path, const Range &range,
                                    unsigned int otherwise);

    /** A number that was needed before and is known by now: it is declared, and checked again, for the sake of
     * printing.
     */
    void bind_fixed(const std::string &name, unsigned int value, const Range &range, const std::string &text);

    /** A word that stands for a value. */
    template <typename Value>
    void bind_choice(const std::string &name, Value &member, const std::vector<std::pair<std::string, Value>> &choices,
                     const std::string &text);

    /** Comma-separated numbers; `n` of them, or any number if 0. */
    void bind_list(const std::string &name, std::vector<double> &member, std::size_t n, const std::string &text);

    /** Gives every bound member its value. Throws BadInput naming place, parameter, value and allowed range for the
     *  first thing that is wrong: an unknown name, or a value out of range. */
    void read(const ParameterFile &file);

    /** Says that a value, although in its range, contradicts others. @param path "Section/Name" */
    [[noreturn]] void reject(const std::string &path, const std::string &why) const;

    /** Every parameter with its value, default and text, as a .prm file that can be read again. */
    void print(std::ostream &stream) const;

  private:
    using Take = std::function<void(const std::string &value)>; // throws BadInput(allowed range) if it cannot

    struct Binding
    {
      std::string path;
      std::vector<std::string> sections;
      std::string name;
      Take take;
    };

    void declare(const std::string &name, const std::string &value, const std::string &text, Take take);
    Binding *find(const std::string &path);
    [[noreturn]] void reject_unknown(const ParameterEntry &entry) const;
    static double parse_number(const std::string &value, const Range &range, bool is_integer);

    dealii::ParameterHandler handler_;
    std::vector<std::string> sections_;
    std::vector<Binding> bindings_;
    ParameterFile file_;
  };

  template <std::unsigned_integral Integer>
  void ParameterBinder::bind(const std::string &name, Integer &member, const Range &range, const std::string &text)
  {
    declare(name, std::to_string(member), text + " Range: integer " + range.describe() + ".",
            [&member, range](const std::string &value) {
              member = static_cast<Integer>(parse_number(value, range, true));
            });
  }

  template <typename Value>
  void ParameterBinder::bind_choice(const std::string &name, Value &member,
                                    const std::vector<std::pair<std::string, Value>> &choices, const std::string &text)
  {
    std::string allowed, present;
    for (const auto &[word, value] : choices)
      {
        allowed += (allowed.empty() ? "" : " | ") + word;
        if (value == member)
          present = word;
      }
    declare(name, present, text + " Range: " + allowed + ".", [&member, choices, allowed](const std::string &given) {
      for (const auto &[word, value] : choices)
        if (word == given)
          {
            member = value;
            return;
          }
      throw BadInput(allowed);
    });
  }
} // namespace apps
