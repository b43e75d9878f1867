#pragma once

#include <deal.II/base/mpi.h>

#include <cstdlib>
#include <filesystem>
#include <stdexcept>
#include <string>

/**
 * A new, empty folder for a test: the same one on all ranks of MPI_COMM_WORLD, and nobody else's, so that several runs
 * of a test program disturb each other as little as several ranks of one do. Making and ending it are collective; it is
 * removed at its end.
 */
class ScratchFolder
{
public:
  ScratchFolder()
  {
    std::string name;
    if (is_first_rank())
      {
        name = (std::filesystem::temp_directory_path() / "slowsand_test_XXXXXX").string();
        if (mkdtemp(name.data()) == nullptr)
          name.clear();
      }
    path_ = dealii::Utilities::MPI::broadcast(MPI_COMM_WORLD, name, 0);
    if (path_.empty())
      throw std::runtime_error("no folder for a test can be made in " +
                               std::filesystem::temp_directory_path().string());
  }

  ~ScratchFolder()
  {
    MPI_Barrier(MPI_COMM_WORLD); // nobody removes what another rank still reads
    std::error_code ignored;
    if (is_first_rank())
      std::filesystem::remove_all(path_, ignored);
  }

  ScratchFolder(const ScratchFolder &) = delete;
  ScratchFolder &operator=(const ScratchFolder &) = delete;

  const std::string &get_path() const { return path_; }
  std::string get_file(const std::string &name) const { return path_ + "/" + name; }

private:
  static bool is_first_rank() { return dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0; }

  std::string path_;
};
