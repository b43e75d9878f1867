#include "fem/field_output.h"
#include "tests/support/fem_cases.h"
#include "tests/support/scratch_folder.h"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

using namespace fem;
using namespace fem::cases;

namespace
{
  std::string read_text(const std::string &file)
  {
    std::ifstream stream(file);
    std::ostringstream text;
    text << stream.rdbuf();
    return text.str();
  }

  unsigned int count(const std::string &text, const std::string &word)
  {
    unsigned int n = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1))
      ++n;
    return n;
  }
} // namespace

TEST(FieldOutput, WritesASeriesThatIsValidAfterEachOutputAndResumes)
{
  // Law: the .pvd lists every output with its time and its file exists; a resumed series drops what came after, also
  // where time stands still.
  const ScratchFolder scratch;
  const std::string folder = scratch.get_path();
  const bool is_first = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  Oedometer oedometer;
  LoadStepping<2> stepping(oedometer.problem, {get_load_stage(1e6)}, {});
  ASSERT_EQ(stepping.run().status, StepStatus::ok);
  {
    FieldOutput output(folder, "fields");
    output.write(oedometer.problem, 1, 0.1);
    output.write(oedometer.problem, 2, 1. / 3.);
    output.write(oedometer.problem, 3, 1. / 3.);
    output.write(oedometer.problem, 4, 5.);
  }
  FieldOutput resumed(folder, "fields", 2);
  resumed.write(oedometer.problem, 3, 7.);
  if (is_first)
    {
      const std::string series = read_text(folder + "/fields.pvd");
      EXPECT_EQ(count(series, "timestep="), 3u);
      EXPECT_EQ(count(series, "timestep=\"0.3"), 1u);
      EXPECT_EQ(count(series, "timestep=\"5\""), 0u);
      EXPECT_EQ(count(series, "timestep=\"7\""), 1u);
      for (const std::string name : {"0001", "0002", "0003"})
        {
          EXPECT_EQ(count(series, "fields/fields_" + name + ".pvtu"), 1u);
          const std::string part = read_text(folder + "/fields/fields_" + name + ".pvtu");
          EXPECT_EQ(count(part, "\"stress_zz_Pa\""), 1u);
          EXPECT_EQ(count(part, "\"strain_xz\""), 1u);
          EXPECT_EQ(count(part, "displacement_m"), 1u);
        }
    }
}
