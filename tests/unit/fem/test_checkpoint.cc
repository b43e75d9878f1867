#include "fem/checkpoint.h"
#include "fem/hdf5_file.h"
#include "fem/viscoelastic_material.h"
#include "tests/support/fem_cases.h"
#include "tests/support/scratch_folder.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

using namespace fem;
using namespace fem::cases;

namespace
{
  class Checkpoint : public ::testing::Test
  {
  protected:
    const ScratchFolder scratch;
    const std::string folder = scratch.get_path();
    const std::string file = folder + "/checkpoint.h5";
  };

  /** Finite strains, a creeping material and carried secants: all kinds of state. */
  struct CreepRun
  {
    explicit CreepRun(unsigned int n_cells = 2, MPI_Comm communicator = MPI_COMM_SELF)
        : material(BurgersParameters(), communicator), problem(create_oedometer_mesh(n_cells, n_cells, communicator),
                                                               get_oedometer_conditions(), get_parameters(), material),
          stepping(problem, {get_load_stage(1e7, 3), get_creep_stage(1e3, 2.)}, {}, get_observer())
    {}

    static ProblemParameters get_parameters()
    {
      ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::finite);
      parameters.newton.tolerance = 1e-4;
      return parameters;
    }

    StepObserver get_observer()
    {
      return {[this](const StepReport &report) {
                history.push_back(report.boundaries.back().displacement[2]);
                history.push_back(report.boundaries[1].force[2]);
                history.push_back(report.residual);
                history.push_back(report.evaluations);
              },
              {}};
    }

    std::vector<double> history;
    ViscoelasticMaterial material;
    QuasiStaticProblem<2> problem;
    LoadStepping<2> stepping;
  };
} // namespace

TEST_F(Checkpoint, AResumedRunIsTheUninterruptedOneToTheLastBit)
{
  // Law: a checkpoint holds all that the future depends on, wherever it is taken.
  for (const unsigned int n_before : {2u, 6u})
    for (const MPI_Comm communicator : {MPI_COMM_SELF, MPI_COMM_WORLD})
      {
        CreepRun whole(2, communicator), first(2, communicator), second(2, communicator);
        EXPECT_EQ(whole.stepping.run().status, StepStatus::ok);
        for (unsigned int n = 0; n < n_before; ++n)
          first.stepping.advance();
        write_checkpoint(file, first.problem, first.stepping.get_progress());
        second.stepping.set_progress(read_checkpoint(file, second.problem));
        EXPECT_EQ(second.stepping.run().status, StepStatus::ok);
        first.history.insert(first.history.end(), second.history.begin(), second.history.end());
        EXPECT_EQ(first.history, whole.history);
        EXPECT_EQ(second.problem.get_state().displacement, whole.problem.get_state().displacement);
        EXPECT_EQ(second.problem.get_state().stress, whole.problem.get_state().stress);
      }
}

TEST_F(Checkpoint, ForeignTruncatedAndWrongFilesAreNamed)
{
  // Law: what is no checkpoint of this problem is refused with file and dataset, and nothing is loaded.
  CreepRun run;
  run.stepping.advance();
  write_checkpoint(file, run.problem, run.stepping.get_progress());
  EXPECT_FALSE(std::filesystem::exists(file + ".tmp"));
  EXPECT_NE(get_error([&] { read_checkpoint(folder + "/none.h5", run.problem); }).find("/none.h5: cannot be opened"),
            std::string::npos);

  CreepRun finer(3);
  EXPECT_NE(
      get_error([&] {
        read_checkpoint(file, finer.problem);
      }).find("checkpoint.h5: dataset /macro/mesh: written for another mesh: number of cells 4, this problem has 9"),
      std::string::npos);

  MPI_Barrier(MPI_COMM_WORLD);
  const bool is_first = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  if (is_first)
    {
      Hdf5File foreign(folder + "/foreign.h5", Hdf5File::Mode::create);
      foreign.write("/something", {1.}, "m");
      foreign.close();
      std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
    }
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_NE(get_error([&] {
              read_checkpoint(folder + "/foreign.h5", run.problem);
            }).find("foreign.h5: dataset /macro/format_version: missing"),
            std::string::npos);
  EXPECT_NE(get_error([&] { read_checkpoint(file, run.problem); }).find("checkpoint.h5: cannot be opened"),
            std::string::npos);
}

TEST_F(Checkpoint, AFullDiskIsToldAndTheLastCheckpointStays)
{
  // Law: a checkpoint that cannot be written is an error with path and cause; the file of before is untouched, and it
  // is the only one.
  if (!std::filesystem::exists("/dev/full"))
    GTEST_SKIP();
  CreepRun run;
  run.stepping.advance();
  write_checkpoint(file, run.problem, run.stepping.get_progress());
  MPI_Barrier(MPI_COMM_WORLD);
  if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
    std::filesystem::create_symlink("/dev/full", file + ".tmp");
  MPI_Barrier(MPI_COMM_WORLD);
  run.stepping.advance();
  const std::string error = get_error([&] { write_checkpoint(file, run.problem, run.stepping.get_progress()); });
  EXPECT_NE(error.find("checkpoint.h5.tmp"), std::string::npos) << error;
  MPI_Barrier(MPI_COMM_WORLD);
  EXPECT_FALSE(std::filesystem::is_symlink(file + ".tmp"));
  CreepRun other;
  EXPECT_EQ(read_checkpoint(file, other.problem).step, 1u);
}

namespace
{
  /** Runs something on the first rank while the others wait. */
  template <typename Work>
  void do_on_first_rank(const Work &work)
  {
    MPI_Barrier(MPI_COMM_WORLD);
    if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
      work();
    MPI_Barrier(MPI_COMM_WORLD);
  }

  void flip_byte(const std::string &file)
  {
    std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
    const auto middle = static_cast<std::streamoff>(std::filesystem::file_size(file) / 2);
    stream.seekg(middle);
    const char byte = static_cast<char>(stream.get() ^ 1);
    stream.seekp(middle);
    stream.put(byte);
  }
} // namespace

TEST_F(Checkpoint, TheOneBeforeIsKeptAndChosenWhenTheNewestIsSpoilt)
{
  // Law: the newest whole checkpoint is chosen, whatever has become of a newer one; complaints name what is wrong.
  const std::string previous = folder + "/previous.h5";
  CreepRun run, other;
  for (int step = 1; step <= 3; ++step)
    {
      run.stepping.advance();
      write_checkpoint(file, run.problem, run.stepping.get_progress(), previous);
    }
  EXPECT_EQ(read_checkpoint(file, other.problem).step, 3u);
  EXPECT_EQ(read_checkpoint(previous, other.problem).step, 2u);
  CheckpointChoice choice = choose_checkpoint({file, previous});
  EXPECT_EQ(choice.file, file);
  EXPECT_TRUE(choice.complaints.empty());

  do_on_first_rank([&]() { flip_byte(file); });
  choice = choose_checkpoint({file, previous});
  EXPECT_EQ(choice.file, previous);
  ASSERT_EQ(choice.complaints.size(), 1u);
  EXPECT_EQ(choice.complaints[0], file + ": damaged: its checksum does not fit its content");

  do_on_first_rank([&]() { std::filesystem::resize_file(file, std::filesystem::file_size(file) - 100); });
  EXPECT_EQ(choose_checkpoint({file, previous}).complaints[0].rfind(file + ": ", 0), 0u);
  do_on_first_rank([&]() { std::filesystem::remove(file); });
  EXPECT_EQ(choose_checkpoint({file, previous}).complaints[0], file + ": missing");
  do_on_first_rank([&]() { flip_byte(previous); });
  const std::string error = get_error([&] { choose_checkpoint({file, previous}); });
  EXPECT_EQ(error, file + ": missing; " + previous + ": damaged: its checksum does not fit its content");
}

TEST_F(Checkpoint, OfBeforeThereWereSealsIsTakenByItsFormat)
{
  // Law: a file without a seal is whole only if its format had none: else its end is missing.
  for (const double version : {1., 2.})
    {
      do_on_first_rank([&]() {
        Hdf5File archive(file, Hdf5File::Mode::create);
        archive.write("/macro/format_version", {version}, "1");
        archive.close();
      });
      if (version == 1.)
        EXPECT_EQ(choose_checkpoint({file}).file, file);
      else
        EXPECT_EQ(get_error([&] { choose_checkpoint({file}); }), file + ": damaged: its end is missing");
    }
}
