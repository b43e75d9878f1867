#pragma once

#include "apps/history_file.h"

#include "coupling/rev_material.h"

#include <memory>
#include <string>

namespace apps
{
  /**
   * costs.csv of a run folder: what each REV cost in each committed step, where it lived, and how many bytes moving it
   * would have sent. A measurement: other bytes in each run.
   */
  class CostFile
  {
  public:
    /** @param is_first_rank  the one that writes; the others only help to collect
     *  @param resume_step  rows up to this step of an existing file are kept; below 0: the file begins */
    CostFile(const std::string &file, bool is_first_rank, int resume_step);

    /** A committed step. Collective. @param time [s] */
    void write(unsigned int step, unsigned int stage, double time, const coupling::RevMaterial &material);

  private:
    std::unique_ptr<HistoryFile> table_;
  };
} // namespace apps
