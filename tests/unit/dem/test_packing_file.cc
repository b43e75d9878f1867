#include "dem/packing_file.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  /** A file of this test alone, gone with it. */
  class PackingFile : public testing::Test
  {
  protected:
    PackingFile() : folder_(std::filesystem::temp_directory_path() / ("slowsand_packing_" + std::to_string(getpid())))
    {
      std::filesystem::create_directories(folder_);
    }
    ~PackingFile() override { std::filesystem::remove_all(folder_); }

    std::string path() const { return folder_ / "packing.txt"; }

    void write(const std::string &text) const { std::ofstream(path()) << text; }

    /** What reading the text complains about; empty: nothing. */
    std::string complain(const std::string &text) const
    {
      write(text);
      try
        {
          read_packing(path());
        }
      catch (const std::runtime_error &error)
        {
          return error.what();
        }
      return "";
    }

  private:
    std::filesystem::path folder_;
  };

  TEST_F(PackingFile, WhatIsWrittenIsReadBack)
  {
    // Law: the same grains in the same cell. Tolerance: a place is multiplied by its edge and divided again.
    const RevState &state = get_packing().state;
    write_packing(path(), state);
    const RevState copy = read_packing(path());
    ASSERT_EQ(copy.grains.size(), n_grains);
    EXPECT_EQ(copy.cell.edges, Matrix(state.cell.edges.diagonal().asDiagonal()));
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        EXPECT_EQ(copy.grains.place[i].w, state.grains.place[i].w);
        EXPECT_LT((to_vector(copy.grains.place[i]) - to_vector(state.grains.place[i])).norm(), 5e-16);
        EXPECT_EQ(copy.grains.id[i], i);
      }
    EXPECT_EQ(copy.counters.next_id, n_grains);
    EXPECT_EQ(copy.initial_solid_volume, compute_solid_volume(copy.grains));
  }

  TEST_F(PackingFile, PassesOverCommentsAndEmptyLines)
  {
    // Law: only "# cell" and the grains count; a unit after the edges is a remark.
    EXPECT_EQ(complain("# made by hand\n\n# cell 1 2 3 [m]\n0.1 0.2 0.3 0.01\n  \n# end\n0.9 1.9 2.9 0.02\n"), "");
    const RevState state = read_packing(path());
    ASSERT_EQ(state.grains.size(), 2u);
    EXPECT_DOUBLE_EQ(state.grains.place[1].y, 0.95);
  }

  TEST_F(PackingFile, EveryComplaintNamesFileAndLine)
  {
    // Law: one message that says what is wrong where.
    const std::string cell = "# cell 1 1 1\n", grain = "0.5 0.5 0.5 0.05\n";
    const auto expect = [&](const std::string &text, const std::string &where, const std::string &what) {
      const std::string message = complain(text);
      EXPECT_EQ(message.rfind(path() + where, 0), 0u) << message;
      EXPECT_NE(message.find(what), std::string::npos) << message;
    };
    expect(grain, ":1: ", "before the first grain");
    expect("# cell 1 1\n" + grain, ":1: ", "three lengths");
    expect("# cell 1 0 1\n" + grain, ":1: ", "edges of the cell must be positive");
    expect(cell + grain + "0.1 0.1 0.1\n", ":3: ", "four numbers");
    expect(cell + grain + "0.1 0.1 abc 0.05\n", ":3: ", "0.1 0.1 abc 0.05");
    expect(cell + grain + "0.1 0.1 nan 0.05\n", ":3: ", "four numbers");
    expect(cell + grain + "0.1 0.1 0.1 0.05 7\n", ":3: ", "four numbers");
    expect(cell + grain + "\n0.1 0.1 0.1 0\n", ":4: ", "must be positive");
    expect(cell + grain + "0.1 0.1 0.1 -0.05\n", ":3: ", "must be positive");
    expect(cell + grain + "0.1 0.1 0.1 0.05\n0.52 0.5 0.5 0.05\n", ":4: ", "overlaps the one of line 2 by 0.08 m");
    expect(cell, ": ", "no grains");
    expect("# cell 1 1 1\n0.5 0.5 0.5 0.3\n", ": ", "narrower than two largest diameters");
  }

  TEST_F(PackingFile, OverlapsAcrossTheCellsFacesCount)
  {
    // Law: images overlap like grains; half the smaller radius is still allowed.
    const std::string first = "# cell 1 1 1\n0.01 0.5 0.5 0.05\n";
    EXPECT_NE(complain(first + "0.99 0.5 0.5 0.05\n").find(":3: grain overlaps the one of line 2"), std::string::npos);
    EXPECT_EQ(complain(first + "0.934 0.5 0.5 0.05\n"), "");
  }

  TEST_F(PackingFile, SaysWhichFileCannotBeReadOrWritten)
  {
    // Law: path and cause.
    const std::string nowhere = path() + ".d/none.txt";
    try
      {
        read_packing(nowhere);
        FAIL();
      }
    catch (const std::runtime_error &error)
      {
        EXPECT_EQ(error.what(), nowhere + ": No such file or directory");
      }
    EXPECT_THROW(write_packing(nowhere, get_packing().state), std::runtime_error);
  }
} // namespace
