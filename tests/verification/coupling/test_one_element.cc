// Law: one element strained along a path gives the stress of its REV strained alone along the same path.
//
// The two compute the same stretch with other roundings, which a REV answers with the same bits. Grains slide.

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
  coupling::RevMaterial material(make_parameters(), coupling::RevPool(MPI_COMM_WORLD, true, 1));
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

  dem::Rev alone(make_parameters().model, start);
  for (unsigned int i = 0; i < n_increments; ++i)
    {
      dem::Matrix stretch = dem::Matrix::Identity();
      stretch(2, 2) = (height - settlement * (i + 1) / n_increments) / (height - settlement * i / n_increments);
      ASSERT_EQ(alone.deform(stretch).status, dem::RestStatus::at_rest);
      alone.accept();
      const auto stress = coupling::to_symmetric_tensor(alone.get_baseline().stress);
      EXPECT_LT((stresses[i] - stress).norm(), 1e-14 * stress.norm()) << i; // the same bits, symmetrised elsewhere
    }
}
