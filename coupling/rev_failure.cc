#include "coupling/rev_failure.h"

#include "coupling/rev_model_text.h"

#include "dem/rev_snapshot.h"

#include <fmt/format.h>

#include <sstream>
#include <stdexcept>

namespace coupling
{
  namespace
  {
    constexpr const char *model_dataset = "/failure/model";
    constexpr const char *question_dataset = "/failure/question";
    constexpr const char *report_dataset = "/failure/report";
    constexpr const char *state_dataset = "/failure/state";

    /** kind, dt, nine entries of the stretch, mode and cap of the ageing. */
    std::string write_question(const RevQuestion &question, const AgeingRule &rule)
    {
      std::string text = fmt::format("{} {:.17g}", static_cast<int>(question.kind), question.dt);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          text += fmt::format(" {:.17g}", question.stretch(i, j));
      return text + fmt::format(" {} {}", static_cast<int>(rule.mode), rule.round_cap);
    }

    void read_question(const std::string &text, RevFailure &failure)
    {
      std::istringstream stream(text);
      int kind = -1, mode = -1;
      stream >> kind >> failure.question.dt;
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          stream >> failure.question.stretch(i, j);
      stream >> mode >> failure.ageing.round_cap;
      if (!stream || kind < 0 || kind > 2 || mode < 0 || mode > 1)
        throw std::runtime_error(fmt::format("'{}' is not a question to a REV", text));
      failure.question.kind = static_cast<QuestionKind>(kind);
      failure.ageing.mode = static_cast<AgeingMode>(mode);
    }
  } // namespace

  AgeingReport ask(dem::Rev &rev, const RevQuestion &question, const AgeingRule &rule)
  {
    switch (question.kind)
      {
      case QuestionKind::age:
        return age(rev, question.dt, rule);
      case QuestionKind::split:
        return split_overstressed(rev);
      case QuestionKind::deform:
        break;
      }
    AgeingReport report;
    report.rest = rev.deform(question.stretch);
    return report;
  }

  std::string describe(const AgeingReport &report)
  {
    return fmt::format("{} ({} cycles, unbalanced ratio {:.3g}, {} grains broken{})", dem::describe(report.rest.status),
                       report.rest.n_cycles, report.rest.unbalanced_ratio, report.n_broken,
                       report.is_capped ? ", still breaking after the cap of batches" : "");
  }

  void write_failure(const std::string &file, const RevFailure &failure)
  {
    const auto contacts = dem::list_contacts(failure.state, dem::make_contact_law(failure.model.material));
    const dem::RevIdentity &identity = failure.model.identity;
    dem::write_snapshot(file, failure.state, contacts, {identity.seed, identity.rev});
    dem::write_bytes(file, state_dataset, dem::serialise(failure.state));
    dem::write_text(file, model_dataset, write_model_text(failure.model));
    dem::write_text(file, question_dataset, write_question(failure.question, failure.ageing));
    dem::write_text(file, report_dataset, failure.what);
  }

  RevFailure read_failure(const std::string &file)
  {
    RevFailure failure;
    const std::string question = dem::read_text(file, question_dataset), model = dem::read_text(file, model_dataset);
    failure.what = dem::read_text(file, report_dataset);
    try
      {
        failure.model = read_model_text(model);
        read_question(question, failure);
        failure.state = dem::deserialise(dem::read_bytes(file, state_dataset));
      }
    catch (const std::runtime_error &error)
      {
        throw std::runtime_error(fmt::format("{}, group /failure: {}", file, std::string(error.what())));
      }
    return failure;
  }
} // namespace coupling
