#include "fem/file_seal.h"
#include "fem/hdf5_file.h"
#include "tests/support/scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>

using namespace fem;

namespace
{
  /** A folder and a name of this rank alone. */
  class FileSeal : public ::testing::Test
  {
  protected:
    void write(const std::string &content) const { std::ofstream(file, std::ios::binary) << content; }

    std::string read() const
    {
      std::ifstream stream(file, std::ios::binary);
      return {std::istreambuf_iterator<char>(stream), {}};
    }

    const ScratchFolder folder;
    const std::string file =
        folder.get_file("sealed_" + std::to_string(dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD)));
  };
} // namespace

TEST_F(FileSeal, EachByteThatChangesOrIsLostShows)
{
  // Law: a file is whole if and only if it has the bytes that were sealed; lengths that fill no word count, too.
  for (const std::size_t length : {0u, 1u, 16u, 61u})
    {
      write(std::string(length, 'x'));
      EXPECT_EQ(check_seal(file), SealState::missing);
      seal_file(file);
      EXPECT_EQ(check_seal(file), SealState::whole);
      const std::string sealed = read();
      for (std::size_t i = 0; i < sealed.size(); ++i)
        {
          std::string flipped = sealed;
          flipped[i] ^= 1;
          write(flipped);
          EXPECT_NE(check_seal(file), SealState::whole) << "byte " << i << " of " << sealed.size();
          write(sealed.substr(0, i));
          EXPECT_NE(check_seal(file), SealState::whole) << "truncated to " << i;
        }
      write("x" + sealed);
      EXPECT_EQ(check_seal(file), SealState::damaged);
    }
}

TEST_F(FileSeal, PartsInWhichAFileIsReadAreNoBounds)
{
  // Law: as above, for a file that is longer than what is read at a time (1 MiB).
  const std::size_t part = 1 << 20;
  write(std::string(2 * part + 5, 'x'));
  seal_file(file);
  EXPECT_EQ(check_seal(file), SealState::whole);
  const std::string sealed = read();
  for (const std::size_t at : {part - 1, part, 2 * part - 1, 2 * part, 2 * part + 4})
    {
      std::string flipped = sealed;
      flipped[at] ^= 64;
      write(flipped);
      EXPECT_EQ(check_seal(file), SealState::damaged) << at;
    }
}

TEST_F(FileSeal, AnHdf5FileReadsAsBefore)
{
  // Law: what stands behind the end of an HDF5 file does not disturb it.
  const std::vector<double> numbers = {1., 1. / 3., 1e300};
  {
    Hdf5File archive(file, Hdf5File::Mode::create);
    archive.write("/some/numbers", numbers, "m");
    archive.close();
  }
  seal_file(file);
  EXPECT_EQ(Hdf5File(file, Hdf5File::Mode::read).read("/some/numbers"), numbers);
  EXPECT_EQ(check_seal(file), SealState::whole); // reading leaves it alone
}
