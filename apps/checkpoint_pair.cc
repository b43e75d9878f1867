#include "apps/checkpoint_pair.h"

#include "dem/stopwatch.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

#include <filesystem>
#include <iostream>

namespace apps
{
  CheckpointPair::CheckpointPair(const RunFolder &folder)
      : newest_(folder.get_file("checkpoint.h5")), previous_(folder.get_file("checkpoint_previous.h5")), file_(newest_)
  {}

  template <int dim>
  void CheckpointPair::write(const fem::QuasiStaticProblem<dim> &problem, const fem::Progress &progress)
  {
    const dem::Stopwatch watch(writing_s_);
    fem::write_checkpoint(newest_, problem, progress, is_newest_whole_ ? previous_ : "");
    is_newest_whole_ = true;
    file_ = newest_;
    ++n_written_;
    std::error_code ignored; // a size is worth no failure
    n_bytes_ = std::filesystem::file_size(newest_, ignored);
  }

  template <int dim>
  fem::Progress CheckpointPair::read(fem::QuasiStaticProblem<dim> &problem)
  {
    const dem::Stopwatch watch(reading_s_);
    const auto choice = as_bad_input([&]() { return fem::choose_checkpoint({newest_, previous_}); });
    file_ = choice.file;
    is_newest_whole_ = file_ == newest_;
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      for (const std::string &complaint : choice.complaints)
        std::cerr << fmt::format("slowsand-bvp: {}; going on from {}\n", complaint, file_) << std::flush;
    return as_bad_input([&]() { return fem::read_checkpoint(file_, problem); });
  }

  void CheckpointPair::add_figures(Summary &summary) const
  {
    summary.figures["checkpoints written"] = n_written_;
    summary.figures["size of the last checkpoint [B]"] = static_cast<double>(n_bytes_);
    summary.wall_s["writing checkpoints"] = writing_s_;
    summary.wall_s["reading the checkpoint"] = reading_s_;
  }

  std::string CheckpointPair::describe() const
  {
    return fmt::format("checkpoints: {} written in {:.2f} s, the last of {:.3g} MB", n_written_, writing_s_,
                       1e-6 * static_cast<double>(n_bytes_));
  }

  template void CheckpointPair::write(const fem::QuasiStaticProblem<2> &, const fem::Progress &);
  template void CheckpointPair::write(const fem::QuasiStaticProblem<3> &, const fem::Progress &);
  template fem::Progress CheckpointPair::read(fem::QuasiStaticProblem<2> &);
  template fem::Progress CheckpointPair::read(fem::QuasiStaticProblem<3> &);
} // namespace apps
