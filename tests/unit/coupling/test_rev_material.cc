// Law: committed states return bit by bit after revert, and after save and load; a failure is a status and a file.

#include "coupling/rev_material.h"
#include "coupling/tensor_conversion.h"

#include "tests/support/scratch_folder.h"
#include "tests/unit/coupling/rev_sample.h"

#include "dem/rev_snapshot.h"

#include <gtest/gtest.h>

#include <algorithm>

namespace
{
  using coupling::RevMaterial;
  using fem::Status;

  /** A checksum of each committed state, wherever it lives: REVs may have moved meanwhile. */
  std::vector<double> sum_up_states(const RevMaterial &material)
  {
    return material.get_pool().collect(1, [&](const fem::PointId id, std::span<double> row) {
      std::uint64_t sum = 14695981039346656037u; // FNV-1a
      for (const std::byte byte : dem::serialise(material.get_local_rev(id).get_committed()))
        sum = (sum ^ static_cast<std::uint64_t>(byte)) * 1099511628211u;
      row[0] = static_cast<double>(sum >> 11); // as many bits as a double holds
    });
  }

  /** All fields but what the point cost. */
  std::vector<double> compute_fields_without_cost(const RevMaterial &material, const fem::PointId id)
  {
    EXPECT_EQ(material.get_field_names().back(), "REV cost [s]");
    std::vector<double> fields = material.compute_fields(id);
    fields.pop_back();
    return fields;
  }

  void write_checkpoint(const RevMaterial &material, const std::string &file)
  {
    if (material.get_pool().get_rank() == 0)
      dem::create_file(file);
    material.save(file);
  }

  std::unique_ptr<RevMaterial> resume(coupling::RevMaterialParameters parameters, const std::string &file)
  {
    parameters.is_resumed = true;
    auto material = std::make_unique<RevMaterial>(parameters, rev_sample::make_pool());
    material->initialise(rev_sample::make_sites());
    material->load(file);
    return material;
  }

  std::vector<fem::PointResponse> strain(RevMaterial &material, const double axial)
  {
    dealii::Tensor<2, 3> increment(dealii::unit_symmetric_tensor<3>());
    increment[2][2] += axial;
    const std::vector<fem::PointRequest> requests = {{3, increment}, {8, increment}};
    std::vector<fem::PointResponse> responses(2);
    material.evaluate(requests, responses, false);
    return responses;
  }
} // namespace

TEST(RevMaterial, PointsStartAtTheirStressWithStrengthsOfTheirOwn)
{
  RevMaterial material(rev_sample::make_parameters(), rev_sample::make_pool());
  material.initialise(rev_sample::make_sites());
  std::vector<double> strengths;
  for (const auto &[id, stress] : material.collect_stresses())
    // The servo holds each component within 2e-3 of the largest target.
    EXPECT_LT((stress - rev_sample::make_pressure(1e6)).norm(), 3. * 2e-3 * 1e6) << id;
  const auto rows = material.get_pool().collect(1, [&](const fem::PointId id, std::span<double> row) {
    row[0] = material.get_local_rev(id).get_committed().grains.strength[0];
  });
  EXPECT_NE(rows[0], rows[1]);
}

TEST(RevMaterial, RevertReturnsEveryBit)
{
  RevMaterial material(rev_sample::make_parameters(), rev_sample::make_pool());
  material.initialise(rev_sample::make_sites());
  const auto before = sum_up_states(material);
  const auto first = strain(material, -1e-3);
  EXPECT_EQ(strain(material, -5e-3)[0].status, Status::ok);
  material.settle(true);
  EXPECT_EQ(material.begin_step(1e3), Status::ok);
  const auto between = strain(material, -1e-3);
  EXPECT_FALSE(first[0].stress == between[0].stress); // the baseline had moved on
  material.revert();
  EXPECT_EQ(sum_up_states(material), before);
  const auto second = strain(material, -1e-3);
  for (int i = 0; i < 2; ++i)
    EXPECT_TRUE(first[i].stress == second[i].stress);
}

TEST(RevMaterial, SaveAndLoadReturnEveryBit)
{
  const ScratchFolder folder;
  const std::string file = folder.get_file("checkpoint.h5");
  RevMaterial material(rev_sample::make_parameters(), rev_sample::make_pool());
  material.initialise(rev_sample::make_sites());
  strain(material, -3e-3);
  material.settle(true);
  material.commit();
  write_checkpoint(material, file);

  const auto resumed = resume(rev_sample::make_parameters(), file);
  RevMaterial &other = *resumed;
  EXPECT_EQ(sum_up_states(other), sum_up_states(material));
  EXPECT_EQ(compute_fields_without_cost(other, 8), compute_fields_without_cost(material, 8));
  const auto here = strain(material, -1e-3), there = strain(other, -1e-3);
  for (int i = 0; i < 2; ++i)
    EXPECT_TRUE(here[i].stress == there[i].stress);
}

TEST(RevMaterial, SaveAndLoadReturnWhatIsPending)
{
  const ScratchFolder folder;
  const std::string file = folder.get_file("checkpoint.h5");
  auto parameters = rev_sample::make_parameters();
  parameters.point.lazy_tolerance = 1e-2;
  RevMaterial material(parameters, rev_sample::make_pool());
  material.initialise(rev_sample::make_sites());
  strain(material, -1e-6); // some 3e-4 of the stress
  material.settle(true);
  material.commit();
  ASSERT_EQ(material.compute_totals().n_lazy, 2u);
  write_checkpoint(material, file);

  const auto resumed = resume(parameters, file);
  RevMaterial &other = *resumed;
  EXPECT_EQ(sum_up_states(other), sum_up_states(material));
  EXPECT_EQ(compute_fields_without_cost(other, 8), compute_fields_without_cost(material, 8));
  for (const double axial : {-1e-6, -1e-3}) // from the tangents, then from the grains
    {
      const auto here = strain(material, axial), there = strain(other, axial);
      for (int i = 0; i < 2; ++i)
        EXPECT_TRUE(here[i].stress == there[i].stress);
    }
}

TEST(RevMaterial, BreakageOfAPointIsThatOfItsGrains)
{
  RevMaterial material(rev_sample::make_parameters(), rev_sample::make_pool());
  material.initialise(rev_sample::make_sites());
  const auto names = material.get_field_names();
  const auto einav = std::find(names.begin(), names.end(), "relative breakage [-]") - names.begin();
  const auto d50 = std::find(names.begin(), names.end(), "d50 [m]") - names.begin();
  const auto broken = std::find(names.begin(), names.end(), "broken at once [-]") - names.begin(); // then: delayed
  double n_broken = 0.;
  // What is measured of the grains and of the packing that they were, on the rank where they live.
  const auto expect_measures = [&](const RevMaterial &which) {
    n_broken = 0.;
    const auto expected = which.get_pool().collect(2, [&](const fem::PointId id, std::span<double> row) {
      const dem::RevState &state = which.get_local_rev(id).get_committed();
      const auto rule = rev_sample::make_packing_rule();
      const auto packing = dem::generate_packing(rule, dem::GrainMaterial{}, dem::DynamicsRule{}).state;
      const auto measures = dem::measure_breakage(state, dem::list_diameters(packing.grains), dem::FractureRule{}, {});
      row[0] = measures.with_fines.einav;
      row[1] = measures.with_fines.d50;
    });
    for (std::size_t i = 0; i < 2; ++i)
      {
        const auto fields = which.compute_fields(i == 0 ? 3 : 8);
        EXPECT_NEAR(fields[einav], expected[2 * i], 1e-13); // the sum is taken in another order of grains
        EXPECT_EQ(fields[d50], expected[2 * i + 1]);
        EXPECT_EQ(fields[einav] > 1e-6, fields[broken] + fields[broken + 1] > 0.) << fields[einav];
        n_broken += fields[broken] + fields[broken + 1];
      }
  };
  expect_measures(material);
  for (int i = 0; i < 10; ++i)
    {
      strain(material, -4e-3);
      material.settle(true);
      material.commit();
    }
  expect_measures(material);
  EXPECT_GT(n_broken, 0.); // at 4 % of strain, some tens of MPa

  const ScratchFolder folder;
  const std::string file = folder.get_file("checkpoint.h5");
  write_checkpoint(material, file);
  const auto resumed = resume(rev_sample::make_parameters(), file);
  RevMaterial &other = *resumed;
  expect_measures(other);
}

TEST(RevMaterial, LoadNamesFileAndDatasetOfWhatIsMissing)
{
  const ScratchFolder folder;
  const std::string file = folder.get_file("empty.h5");
  RevMaterial material(rev_sample::make_parameters(), rev_sample::make_pool());
  material.initialise(rev_sample::make_sites());
  if (material.get_pool().get_rank() == 0)
    dem::create_file(file);
  MPI_Barrier(MPI_COMM_WORLD);
  try
    {
      material.load(file);
      FAIL() << "nothing was thrown";
    }
  catch (const std::runtime_error &error)
    {
      EXPECT_NE(std::string(error.what()).find(file), std::string::npos) << error.what();
      // Either point's: both are missing, REVs may have moved, and the first rank that misses one is heard.
      const std::string message = error.what();
      EXPECT_TRUE(message.find("/material/points/3: missing") != std::string::npos ||
                  message.find("/material/points/8: missing") != std::string::npos)
          << message;
    }
}

TEST(RevMaterial, FailureIsAStatusAndAFileThatFailsAgain)
{
  auto parameters = rev_sample::make_parameters();
  const ScratchFolder folder;
  parameters.failure_folder = folder.get_file("failures");
  RevMaterial sound(parameters, rev_sample::make_pool());
  sound.initialise(rev_sample::make_sites());
  const std::string checkpoint = folder.get_file("state.h5");
  if (sound.get_pool().get_rank() == 0)
    dem::create_file(checkpoint);
  sound.save(checkpoint);

  parameters.is_resumed = true;
  parameters.model.equilibrium.cycle_cap = 20; // too few to come to rest
  RevMaterial hasty(parameters, rev_sample::make_pool());
  hasty.initialise(rev_sample::make_sites());
  hasty.load(checkpoint);
  for (const auto &response : strain(hasty, -2e-3))
    EXPECT_EQ(response.status, Status::failed);
  MPI_Barrier(MPI_COMM_WORLD);

  const auto failure = coupling::read_failure(parameters.failure_folder + "/point_8_1.h5");
  EXPECT_EQ(failure.model.identity.rev, 8u);
  dem::Matrix asked = dem::Matrix::Identity();
  asked(2, 2) -= 2e-3;
  EXPECT_TRUE(failure.question.stretch ==
              coupling::split_increment(coupling::to_tensor(asked), dem::Matrix::Identity(), fem::Kinematics::finite)
                  .stretch); // the same bits
  dem::Rev rev(failure.model, failure.state);
  const auto report = coupling::ask(rev, failure.question, failure.ageing);
  EXPECT_TRUE(report.has_failed());
  EXPECT_EQ(coupling::describe(report), failure.what);
}

TEST(RevMaterial, TensionAtTheStartIsRefused)
{
  RevMaterial material(rev_sample::make_parameters(), rev_sample::make_pool());
  const std::vector<fem::PointSite> sites = {{0, {}, rev_sample::make_pressure(-1e3)}};
  EXPECT_THROW(material.initialise(sites), std::invalid_argument);
}
