#include "apps/stage_parameters.h"

#include <deal.II/base/function_parser.h>

#include <fmt/format.h>

#include <iostream>
#include <memory>
#include <sstream>

namespace apps
{
  namespace
  {
    const std::vector<std::pair<std::string, fem::ConditionKind>> condition_kinds = {
        {"displacement", fem::ConditionKind::displacement},
        {"traction", fem::ConditionKind::traction},
        {"pressure", fem::ConditionKind::pressure}};

    void bind_condition(ParameterBinder &binder, fem::BoundaryCondition &condition, std::string &profile)
    {
      binder.bind("Boundary", condition.boundary, "Name of a boundary of the mesh. Units: none.");
      binder.bind_choice("Kind", condition.kind, condition_kinds,
                         "displacement: total, of one component; traction: one component, along the axis; pressure: "
                         "pushes on the body, normal to it. Units: none.");
      binder.bind_choice<std::string>("Component", condition.component,
                                      {{"none", ""}, {"x", "x"}, {"y", "y"}, {"z", "z"}, {"r", "r"}},
                                      "Of a displacement or traction; r is x in axisymmetry. Units: none.");
      binder.bind("Value", condition.initial_value, any_number, "Before the first stage. Units: [m] or [Pa].");
      binder.bind_choice<fem::AreaMeasure>(
          "Area", condition.area, {{"current", fem::AreaMeasure::current}, {"initial", fem::AreaMeasure::initial}},
          "That a traction or pressure is measured on. Units: none.");
      binder.bind("Is held", condition.is_held,
                  "A displacement: from the beginning; else from the stage that holds it. Units: none.");
      binder.bind(
          "Profile", profile,
          "Of a displacement: factor on its value, a function of the initial position x, y, z [m] such as (z + 5) / "
          "0.4; in axisymmetry x is the radius; empty: 1. Units: [-].");
    }

    /** Keeps std::cerr silent while it lives: deal.II prints what its parser says and throws, and one message is
     * enough. */
    class SilentErrors
    {
    public:
      SilentErrors() : usual_(std::cerr.rdbuf(unheard_.rdbuf())) {}
      ~SilentErrors() { std::cerr.rdbuf(usual_); }
      SilentErrors(const SilentErrors &) = delete;
      SilentErrors &operator=(const SilentErrors &) = delete;

    private:
      std::ostringstream unheard_;
      std::streambuf *usual_;
    };

    /** Displacement from a factor that is written as a function of position; throws what deal.II throws. */
    std::function<double(const dealii::Point<3> &, double)> parse_profile(const std::string &text)
    {
      const auto factor = std::make_shared<dealii::FunctionParser<3>>(1);
      const SilentErrors silence;
      factor->initialize("x,y,z", text, {{"pi", dealii::numbers::PI}});
      factor->value({0., 0., 0.}); // what cannot be read is found out now
      return [factor](const dealii::Point<3> &position, double value) { return value * factor->value(position); };
    }

    void bind_stage(ParameterBinder &binder, fem::Stage &stage, StageTexts &texts, std::size_t i)
    {
      binder.bind("Name", stage.name, "For people. Units: none.");
      binder.bind_choice<fem::StageKind>("Kind", stage.kind,
                                         {{"load", fem::StageKind::load}, {"creep", fem::StageKind::creep}},
                                         "load: conditions go to their targets; creep: they are held. Units: none.");
      binder.bind("Duration", stage.duration, non_negative, "0: a load without time. Units: [s].");
      binder.bind("Increments", stage.n_increments, {1., 1e6}, "Of a load. Units: [-].");
      binder.bind_choice<fem::Spacing>("Spacing", stage.spacing,
                                       {{"linear", fem::Spacing::linear}, {"geometric", fem::Spacing::geometric}},
                                       "Of a load's increments. Units: none.");
      binder.bind("Targets", texts.targets[i],
                  "Of a load, 'BOUNDARY KIND [COMPONENT]: VALUE; ...' such as 'top pressure: 21.7e6'. Units: [m] or "
                  "[Pa].");
      binder.bind("First output", stage.first_output, positive, "Of a creep, since its start. Units: [s].");
      binder.bind("Outputs per decade", stage.outputs_per_decade, non_negative,
                  "Of a creep; 0: at its end. Units: [-].");
      binder.bind("Steps per decade", stage.steps_per_decade, non_negative,
                  "Of a creep; 0: events and outputs alone. Units: [-].");
      binder.bind(
          "Places pile", stage.places_pile,
          "Of a load without duration: the absent pile enters free of stress at its start; what the hole's wall "
          "carried goes over to it by its end. Units: none.");
      binder.bind("Releases", texts.releases[i],
                  "Of a load without duration, 'BOUNDARY displacement COMPONENT; ...': conditions let go at its start; "
                  "their forces go to zero by its end. Units: none.");
      binder.bind(
          "Holds", texts.holds[i],
          "Of a load without duration, as Releases: conditions that hold from its start on, their values counted "
          "from where the boundary is then. Units: none.");
    }

    fem::ConditionKind parse_kind(const std::string &word, bool &is_known)
    {
      for (const auto &[known, kind] : condition_kinds)
        if (known == word)
          {
            is_known = true;
            return kind;
          }
      return {};
    }

    /** "shaft displacement r; base displacement z" */
    std::vector<fem::Target> parse_conditions(const ParameterBinder &binder, const std::string &path,
                                              const std::string &text)
    {
      std::vector<fem::Target> found;
      std::string part;
      for (std::istringstream stream(text); std::getline(stream, part, ';');)
        if (part.find_first_not_of(" \t") != std::string::npos)
          {
            fem::Target target;
            std::string kind;
            bool is_known = false;
            std::istringstream words(part);
            words >> target.boundary >> kind >> target.component;
            target.kind = parse_kind(kind, is_known);
            if (!words || !(words >> std::ws).eof() || !is_known)
              binder.reject(path, fmt::format("holds '{}'; allowed: 'BOUNDARY displacement COMPONENT; ...'", part));
            found.push_back(target);
          }
      return found;
    }

    fem::Target parse_target(const ParameterBinder &binder, const std::string &path, const std::string &text)
    {
      const std::string allowed =
          fmt::format("holds '{}'; allowed: 'BOUNDARY displacement|traction|pressure [COMPONENT]: VALUE; ...'", text);
      fem::Target target;
      std::string kind;
      const auto colon = text.find(':');
      std::istringstream words(text.substr(0, colon));
      std::istringstream number(colon == std::string::npos ? "" : text.substr(colon + 1));
      words >> target.boundary >> kind >> target.component;
      number >> target.value;
      bool is_known = false;
      target.kind = parse_kind(kind, is_known);
      if (!number || !(number >> std::ws).eof() || !is_known)
        binder.reject(path, allowed);
      return target;
    }
  } // namespace

  void bind_conditions(const ParameterFile &file, ParameterBinder &binder,
                       std::vector<fem::BoundaryCondition> &conditions, std::vector<std::string> &profiles)
  {
    const Range allowed{1., 1000.};
    const unsigned int number =
        ParameterBinder::read_number(file, "Boundary conditions/Number of conditions", allowed, 1);
    conditions.resize(number);
    profiles.resize(number);
    binder.enter("Boundary conditions");
    binder.bind_fixed("Number of conditions", number, allowed, "Sections 'Condition 1' and so on. Units: [-].");
    for (std::size_t i = 0; i < conditions.size(); ++i)
      {
        conditions[i].boundary = "bottom";
        conditions[i].component = "z";
        binder.enter(fmt::format("Condition {}", i + 1));
        bind_condition(binder, conditions[i], profiles[i]);
        binder.leave();
      }
    binder.leave();
  }

  void complete_conditions(const ParameterBinder &binder, const std::vector<std::string> &profiles,
                           std::vector<fem::BoundaryCondition> &conditions)
  {
    for (std::size_t i = 0; i < profiles.size(); ++i)
      {
        fem::BoundaryCondition &condition = conditions[i];
        const std::string path = fmt::format("Boundary conditions/Condition {}/Profile", i + 1);
        if (condition.kind == fem::ConditionKind::pressure) // it has no component, whatever is written
          condition.component.clear();
        if (profiles[i].find_first_not_of(' ') == std::string::npos)
          continue;
        if (condition.kind != fem::ConditionKind::displacement)
          binder.reject(path, "is for a displacement; allowed: empty");
        try
          {
            condition.profile = parse_profile(profiles[i]);
          }
        catch (const std::exception &)
          {
            binder.reject(path, "is no function of x, y and z; allowed: such as min(1, (z + 5) / 0.4)");
          }
      }
  }

  void bind_stages(const ParameterFile &file, ParameterBinder &binder, std::vector<fem::Stage> &stages,
                   StageTexts &texts)
  {
    const Range allowed{1., 1000.};
    const unsigned int number = ParameterBinder::read_number(file, "Loading/Number of stages", allowed, 1);
    stages.resize(number);
    for (auto *text : {&texts.targets, &texts.releases, &texts.holds})
      text->resize(number);
    binder.enter("Loading");
    binder.bind_fixed("Number of stages", number, allowed,
                      "Sections 'Stage 1' and so on, one after another. Units: [-].");
    for (std::size_t i = 0; i < stages.size(); ++i)
      {
        stages[i].name = fmt::format("stage {}", i + 1);
        binder.enter(fmt::format("Stage {}", i + 1));
        bind_stage(binder, stages[i], texts, i);
        binder.leave();
      }
    binder.leave();
  }

  void complete_stages(const ParameterBinder &binder, const StageTexts &texts,
                       const std::vector<fem::BoundaryCondition> &conditions, std::vector<fem::Stage> &stages)
  {
    for (std::size_t i = 0; i < stages.size(); ++i)
      {
        const std::string path = fmt::format("Loading/Stage {}/", i + 1);
        std::string part;
        for (std::istringstream stream(texts.targets[i]); std::getline(stream, part, ';');)
          if (part.find_first_not_of(" \t") != std::string::npos)
            stages[i].targets.push_back(parse_target(binder, path + "Targets", part));
        stages[i].releases = parse_conditions(binder, path + "Releases", texts.releases[i]);
        stages[i].holds = parse_conditions(binder, path + "Holds", texts.holds[i]);
        if (stages[i].kind == fem::StageKind::creep && !(stages[i].duration > 0.))
          binder.reject(path + "Duration", "must be > 0 in a creep stage");
        if (stages[i].kind == fem::StageKind::creep && !stages[i].targets.empty())
          binder.reject(path + "Targets", "contradicts the stage's kind: creep holds all conditions");
        try
          {
            fem::resolve_targets(conditions, {stages.begin(), stages.begin() + static_cast<long>(i) + 1});
          }
        catch (const std::invalid_argument &error)
          {
            binder.reject(path + "Targets", fmt::format("is not allowed: {}", std::string(error.what())));
          }
      }
  }
} // namespace apps
