#pragma once

#include "coupling/macro_clock.h"

#include <string>

namespace coupling
{
  /** What was asked of a REV. */
  enum class QuestionKind
  {
    deform, ///< strain by `stretch`
    age,    ///< move on by `dt`
    split   ///< split one batch of what is overstressed
  };

  struct RevQuestion
  {
    QuestionKind kind = QuestionKind::deform;
    dem::Matrix stretch = dem::Matrix::Identity(); ///< in the REV's axes [-]
    double dt = 0.;                                ///< [s]
  };

  /** All that is needed to see a REV fail again, alone. */
  struct RevFailure
  {
    dem::RevModel model;
    dem::RevState state; ///< baseline before the question
    RevQuestion question;
    AgeingRule ageing;
    std::string what; ///< how it ended
  };

  /** Asks a REV. @post the answer is its trial state (deform) or its baseline */
  AgeingReport ask(dem::Rev &rev, const RevQuestion &question, const AgeingRule &rule);

  /** How a question ended, in words: "still moving after the cap of cycles (200000 cycles, unbalanced ratio 3e-3)". */
  std::string describe(const AgeingReport &report);

  /** Writes a snapshot of the state, with the question beside it. Throws std::runtime_error with path and cause. */
  void write_failure(const std::string &file, const RevFailure &failure);

  /** Reads it back, the same bits. Throws std::runtime_error naming file and dataset. */
  RevFailure read_failure(const std::string &file);
} // namespace coupling
