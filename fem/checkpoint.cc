#include "fem/checkpoint.h"

#include "fem/file_seal.h"
#include "fem/hdf5_file.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <exception>
#include <filesystem>
#include <functional>
#include <numeric>
#include <stdexcept>

namespace fem
{
  namespace
  {
    constexpr double format_version = 2., version_without_seal = 1.;
    const std::string group = "/macro/";

    /** The parts of all ranks one after the other, on rank 0 of the communicator, with their lengths. */
    struct Gathered
    {
      std::vector<double> values;
      std::vector<double> lengths;
    };

    Gathered gather(MPI_Comm communicator, const std::vector<double> &part)
    {
      Gathered gathered;
      for (const auto &values : dealii::Utilities::MPI::gather(communicator, part))
        {
          gathered.values.insert(gathered.values.end(), values.begin(), values.end());
          gathered.lengths.push_back(values.size());
        }
      return gathered;
    }

    /** Runs work on rank 0 of MPI_COMM_WORLD; if it throws, every rank does. */
    void do_on_first_rank(const std::function<void()> &work)
    {
      std::string error;
      if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
        try
          {
            work();
          }
        catch (const std::exception &exception)
          {
            error = exception.what();
          }
      error = dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, error, 0);
      if (!error.empty())
        throw std::runtime_error(error);
    }

    std::vector<double> pack(const Progress &progress)
    {
      return {progress.time,
              double(progress.stage),
              progress.stage_start,
              progress.position,
              progress.increment_start,
              double(progress.step),
              progress.step_share,
              double(progress.n_event_cuts),
              double(progress.n_cuts),
              double(progress.n_idle_steps),
              double(progress.n_successes)};
    }

    Progress unpack(const std::vector<double> &numbers, std::vector<double> stage_values)
    {
      Progress progress;
      progress.time = numbers[0];
      progress.stage = numbers[1];
      progress.stage_start = numbers[2];
      progress.position = numbers[3];
      progress.increment_start = numbers[4];
      progress.step = numbers[5];
      progress.step_share = numbers[6];
      progress.n_event_cuts = numbers[7];
      progress.n_cuts = numbers[8];
      progress.n_idle_steps = numbers[9];
      progress.n_successes = numbers[10];
      progress.stage_values = std::move(stage_values);
      return progress;
    }

    /** This rank's part of a gathered dataset. */
    std::vector<double> read_part(const Hdf5File &archive, const std::string &name, MPI_Comm communicator)
    {
      const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(communicator);
      const auto lengths =
          archive.read(group + name + "_lengths", dealii::Utilities::MPI::n_mpi_processes(communicator));
      const std::size_t total = std::accumulate(lengths.begin(), lengths.end(), 0.);
      const std::size_t begin = std::accumulate(lengths.begin(), lengths.begin() + rank, 0.);
      const auto values = archive.read(group + name, total);
      return {values.begin() + begin, values.begin() + begin + static_cast<std::size_t>(lengths[rank])};
    }

    void check_fingerprint(const std::string &file, const std::vector<double> &found,
                           const std::vector<double> &expected)
    {
      const char *names[] = {"dimension",          "degree",           "number of cells",
                             "number of unknowns", "volume",           "first moment in x",
                             "first moment in y",  "first moment in z"};
      for (std::size_t i = 0; i < expected.size(); ++i)
        if (!(std::abs(found[i] - expected[i]) <= 1e-9 * std::abs(expected[i])))
          throw std::runtime_error(
              fmt::format("{}: dataset {}mesh: written for another mesh: {} {}, this problem has {}", file, group,
                          names[i], found[i], expected[i]));
    }

    template <int dim>
    void check_lengths(const std::string &file, const typename QuasiStaticProblem<dim>::State &found,
                       const typename QuasiStaticProblem<dim>::State &expected)
    {
      const std::size_t n_owned = expected.displacement.size();
      if (found.displacement.size() != n_owned || found.stress.size() != expected.stress.size() ||
          found.deformation.size() != expected.deformation.size() ||
          (n_owned > 0 && found.secants.size() % (2 * n_owned) != 0) ||
          (!found.carried.empty() && found.carried.size() != n_owned) || found.offsets.size() != found.carried.size())
        throw std::runtime_error(
            fmt::format("{}: dataset {}displacement: parts of the ranks differ from this run's", file, group));
    }

    double read_version(const Hdf5File &archive)
    {
      return archive.read(group + "format_version", 1)[0];
    }

    /** What is wrong with a file; empty: nothing. */
    std::string find_fault(const std::string &file)
    {
      try
        {
          if (!std::filesystem::exists(file))
            return file + ": missing";
          switch (check_seal(file))
            {
            case SealState::whole:
              return "";
            case SealState::damaged:
              return file + ": damaged: its checksum does not fit its content";
            case SealState::missing:
              if (read_version(Hdf5File(file, Hdf5File::Mode::read)) != version_without_seal)
                return file + ": damaged: its end is missing";
            }
          return "";
        }
      catch (const std::exception &error)
        {
          return error.what();
        }
    }

    template <int dim>
    void write_archive(const std::string &file, const QuasiStaticProblem<dim> &problem, const Progress &progress)
    {
      const MPI_Comm communicator = problem.get_communicator();
      const auto state = problem.get_state();
      const auto fingerprint = problem.compute_fingerprint();
      const std::vector<std::tuple<std::string, Gathered, std::string>> parts = {
          {"displacement", gather(communicator, state.displacement), "m"},
          {"deformation", gather(communicator, state.deformation), "1"},
          {"stress", gather(communicator, state.stress), "Pa"},
          {"secants", gather(communicator, state.secants), "m, N"},
          {"carried", gather(communicator, state.carried), "N"},
          {"offsets", gather(communicator, state.offsets), "m"}};
      do_on_first_rank([&]() {
        Hdf5File archive(file, Hdf5File::Mode::create);
        archive.write(group + "format_version", {format_version}, "1");
        archive.write(group + "mesh", fingerprint, "1, m^3, m^4");
        archive.write(group + "progress", pack(progress), "s, 1");
        archive.write(group + "stage_values", progress.stage_values, "m or Pa");
        archive.write(group + "values", state.values, "m or Pa");
        for (const auto &[name, gathered, unit] : parts)
          {
            archive.write(group + name, gathered.values, unit);
            archive.write(group + name + "_lengths", gathered.lengths, "1");
          }
        archive.close();
      });
      problem.get_material().save(file);
      MPI_Barrier(MPI_COMM_WORLD); // the material may write from several ranks
      do_on_first_rank([&]() { seal_file(file); });
    }
  } // namespace

  template <int dim>
  void write_checkpoint(const std::string &file, const QuasiStaticProblem<dim> &problem, const Progress &progress,
                        const std::string &previous)
  {
    const std::string temporary = file + ".tmp";
    try
      {
        write_archive(temporary, problem, progress);
        do_on_first_rank([&]() { publish_file(file, previous); });
      }
    catch (...)
      {
        std::error_code ignored; // what went wrong first is what counts
        if (dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0)
          std::filesystem::remove(temporary, ignored); // half a file helps nobody, and the disk may be full
        throw;
      }
  }

  CheckpointChoice choose_checkpoint(const std::vector<std::string> &files)
  {
    CheckpointChoice choice;
    do_on_first_rank([&]() {
      for (const std::string &file : files)
        {
          const std::string fault = find_fault(file);
          if (fault.empty())
            {
              choice.file = file;
              return;
            }
          choice.complaints.push_back(fault);
        }
      throw std::runtime_error(fmt::format("{}", fmt::join(choice.complaints, "; ")));
    });
    choice.file = dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, choice.file, 0);
    choice.complaints = dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, choice.complaints, 0);
    return choice;
  }

  template <int dim>
  Progress read_checkpoint(const std::string &file, QuasiStaticProblem<dim> &problem)
  {
    const MPI_Comm communicator = problem.get_communicator();
    Progress progress;
    {
      const Hdf5File archive(file, Hdf5File::Mode::read);
      const double version = read_version(archive);
      if (version != format_version && version != version_without_seal)
        throw std::runtime_error(fmt::format("{}: dataset {}format_version: {}, this program reads {}", file, group,
                                             version, format_version));
      const auto expected = problem.compute_fingerprint();
      check_fingerprint(file, archive.read(group + "mesh", expected.size()), expected);

      const std::size_t n_conditions = problem.get_conditions().size();
      progress = unpack(archive.read(group + "progress", pack(progress).size()),
                        archive.read(group + "stage_values", n_conditions));
      typename QuasiStaticProblem<dim>::State state;
      state.displacement = read_part(archive, "displacement", communicator);
      state.deformation = read_part(archive, "deformation", communicator);
      state.stress = read_part(archive, "stress", communicator);
      state.secants = read_part(archive, "secants", communicator);
      if (archive.has(group + "carried")) // files of before there were phases have none
        {
          state.carried = read_part(archive, "carried", communicator);
          state.offsets = read_part(archive, "offsets", communicator);
        }
      state.values = archive.read(group + "values", n_conditions);
      check_lengths<dim>(file, state, problem.get_state());
      problem.set_state(state);
    }
    problem.get_material().load(file);
    return progress;
  }

  template void write_checkpoint(const std::string &, const QuasiStaticProblem<2> &, const Progress &,
                                 const std::string &);
  template void write_checkpoint(const std::string &, const QuasiStaticProblem<3> &, const Progress &,
                                 const std::string &);
  template Progress read_checkpoint(const std::string &, QuasiStaticProblem<2> &);
  template Progress read_checkpoint(const std::string &, QuasiStaticProblem<3> &);
} // namespace fem
