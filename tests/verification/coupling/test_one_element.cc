// Law: one element strained along a path gives the stress of its REV strained alone along the same path.
//
// In two parts, because grains that touch or slide turn a difference in the sixteenth digit of strain into one in the
// fifth digit of stress within a few increments (70 grains, rest to 1e-9): the element's stretch is the path's to
// rounding, and the REV alone, given that stretch, answers with the same bits.

#include "coupling/rev_material.h"
#include "coupling/tensor_conversion.h"

#include "fem/load_stepping.h"

#include <gtest/gtest.h>

namespace
{
  constexpr double height = 1., settlement = 4.13e-3; // [m]
  constexpr unsigned int n_increments = 4;

  coupling::RevMaterialParameters make_parameters()
  {
    coupling::RevMaterialParameters parameters;
    parameters.model.fracture.is_active = false;
    parameters.model.equilibrium.unbalanced_ratio = 1e-9;
    parameters.packing.rule.n_grains = 70;
    parameters.packing.rule.friction = 0.1;
    parameters.packing.rule.tolerance = 1.; // whatever void ratio that friction gives
    parameters.packing.rule.pressure = 1e6;
    return parameters;
  }

  /** A cube whose six sides are displaced along their normals: only the top moves. */
  std::vector<fem::BoundaryCondition> make_conditions()
  {
    const auto displacement = fem::ConditionKind::displacement;
    return {{"left", displacement, "x"}, {"right", displacement, "x"},  {"front", displacement, "y"},
            {"back", displacement, "y"}, {"bottom", displacement, "z"}, {"top", displacement, "z"}};
  }

  /** Remembers what point 0 was asked last. */
  class RecordingMaterial : public coupling::RevMaterial
  {
  public:
    using RevMaterial::RevMaterial;

    void evaluate(std::span<const fem::PointRequest> requests, std::span<fem::PointResponse> responses,
                  const bool with_tangent) override
    {
      increment = requests[0].deformation_increment;
      RevMaterial::evaluate(requests, responses, with_tangent);
    }

    fem::Settlement settle(const bool accept_excess) override
    {
      settled.push_back(increment);
      return RevMaterial::settle(accept_excess);
    }

    dealii::Tensor<2, 3> increment;
    std::vector<dealii::Tensor<2, 3>> settled;
  };

  fem::Stage make_stage()
  {
    fem::Stage stage;
    stage.n_increments = n_increments;
    stage.targets = {{"top", fem::ConditionKind::displacement, "z", -settlement}};
    return stage;
  }
} // namespace

TEST(OneElement, StressOnAStrainPathIsThatOfTheRevAlone)
{
  const auto pressure = -1e6 * dealii::unit_symmetric_tensor<3>();
  RecordingMaterial material(make_parameters(), coupling::RevPool(MPI_COMM_WORLD, true, 1));
  fem::ProblemParameters parameters;
  parameters.geometry = fem::Geometry::three_dimensional;
  fem::QuasiStaticProblem<3> problem(fem::create_mesh<3>({}, parameters.geometry, MPI_COMM_SELF), make_conditions(),
                                     parameters, material, [&](const dealii::Point<3> &) { return pressure; });
  const dem::RevState start = material.get_local_rev(0).get_committed();

  std::vector<dealii::SymmetricTensor<2, 3>> stresses;
  fem::StepObserver observer;
  observer.on_commit = [&](const fem::StepReport &) { stresses.push_back(material.collect_stresses().at(0)); };
  fem::LoadStepping<3> stepping(problem, {make_stage()}, {}, observer);
  ASSERT_EQ(stepping.run().status, fem::StepStatus::ok);
  ASSERT_EQ(stresses.size(), n_increments);
  ASSERT_EQ(material.settled.size(), n_increments); // nothing was cut, nothing broke

  dem::Rev alone(make_parameters().model, start);
  for (unsigned int i = 0; i < n_increments; ++i)
    {
      dealii::Tensor<2, 3> expected(dealii::unit_symmetric_tensor<3>());
      const double before = height - settlement * i / n_increments, after = before - settlement / n_increments;
      expected[2][2] = after / before;
      EXPECT_LT((material.settled[i] - expected).norm(), 1e-14)
          << i; // rounding of displacements near 1e-3 and sizes of 1

      const auto answer = coupling::evaluate(alone, material.settled[i], false, {});
      ASSERT_EQ(answer.response.status, fem::Status::ok);
      alone.accept();
      EXPECT_TRUE(stresses[i] == answer.response.stress) << i; // the same grains, the same question: the same bits
    }
}
