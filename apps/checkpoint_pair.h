#pragma once

#include "apps/run_folder.h"

#include "fem/checkpoint.h"

namespace apps
{
  /**
   * checkpoint.h5 of a run folder, and checkpoint_previous.h5, the one before it: if the disk has spoilt the newest, a
   * run goes on from the other one. All members are collective unless they say otherwise.
   */
  class CheckpointPair
  {
  public:
    explicit CheckpointPair(const RunFolder &folder);

    /** Makes the state the newest checkpoint. Throws std::runtime_error; what was there stays. */
    template <int dim>
    void write(const fem::QuasiStaticProblem<dim> &problem, const fem::Progress &progress);

    /** Brings problem and material to the newest checkpoint that is whole; says on standard error which one is not.
     * Throws BadInput if none can be read. */
    template <int dim>
    fem::Progress read(fem::QuasiStaticProblem<dim> &problem);

    /** The one that was read last, or the newest. Not collective. */
    const std::string &get_file() const { return file_; }

    /** What reading and writing have taken so far. Not collective. */
    void add_figures(Summary &summary) const;
    std::string describe() const;

  private:
    std::string newest_, previous_, file_;
    bool is_newest_whole_ = true; ///< a damaged one must not take the older one's place
    unsigned int n_written_ = 0;
    std::uint64_t n_bytes_ = 0;              ///< of the last one written
    double writing_s_ = 0., reading_s_ = 0.; ///< wall time
  };
} // namespace apps
