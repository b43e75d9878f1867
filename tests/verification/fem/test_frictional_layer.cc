#include "fem/checkpoint.h"
#include "fem/frictional_layer.h"
#include "tests/support/pile_cases.h"
#include "tests/support/scratch_folder.h"

#include <deal.II/grid/grid_tools.h>

#include <gtest/gtest.h>

namespace fem::cases::friction // names of its own: several tests are one translation unit
{

  // Bodies with a thin layer between them that slips by Coulomb's law.
  namespace
  {
    using dealii::SymmetricTensor;
    using dealii::Tensor;

    constexpr double friction = 0.4, pressure = 100e3; // [-], [Pa]
    constexpr double thickness = 0.01, height = 1.;    // of the layer, of the block with it [m]
    constexpr FrictionalLayerParameters slippery = {1e9, 20e6, friction, LayerNormal::z, Kinematics::finite};

    FrictionalLayerParameters make_layer(LayerNormal normal, Kinematics kinematics)
    {
      FrictionalLayerParameters parameters = slippery;
      parameters.normal = normal;
      parameters.kinematics = kinematics;
      return parameters;
    }

    SymmetricTensor<2, 3> get_stress(const dealii::Point<3> &)
    {
      SymmetricTensor<2, 3> stress;
      stress[2][2] = -pressure;
      return stress;
    }

    /** Plane strain, 1 m wide: a block on a block, the layer between them; faces at the sides keep their height. */
    struct Blocks
    {
      explicit Blocks(Kinematics kinematics) : material(MPI_COMM_SELF), problem(make_problem(kinematics)) {}

      std::unique_ptr<QuasiStaticProblem<2>> make_problem(Kinematics kinematics)
      {
        material.add(std::make_unique<ElasticMaterial>(get_elastic_parameters(kinematics), MPI_COMM_SELF),
                     {pile_region, ground_region});
        material.add(std::make_unique<FrictionalLayer>(make_layer(LayerNormal::z, kinematics), MPI_COMM_SELF),
                     {interface_region});
        std::vector<BoundaryCondition> conditions = {{"bottom", ConditionKind::displacement, "x"},
                                                     {"bottom", ConditionKind::displacement, "z"},
                                                     {"left", ConditionKind::displacement, "z"},
                                                     {"right", ConditionKind::displacement, "z"},
                                                     {"top", ConditionKind::displacement, "x"}};
        return std::make_unique<QuasiStaticProblem<2>>(create_blocks(), conditions,
                                                       get_exact_parameters(Geometry::plane_strain, kinematics),
                                                       material, get_stress);
      }

      static Mesh<2> create_blocks()
      {
        MeshParameters parameters;
        parameters.n_cells = {{1, 1, 3}};
        Mesh<2> mesh = create_mesh<2>(parameters, Geometry::plane_strain, MPI_COMM_SELF);
        dealii::GridTools::transform(
            [&](const dealii::Point<2> &x) {
              const double z = x[1] < 0.1 ? 0. : x[1] < 0.5 ? 0.6 : x[1] < 0.9 ? 0.6 + thickness : height;
              return dealii::Point<2>(x[0], z);
            },
            *mesh.triangulation);
        for (const auto &cell : mesh.triangulation->active_cell_iterators())
          {
            const double z = cell->center()[1];
            cell->set_material_id(z < 0.6 ? ground_region : z < 0.6 + thickness ? interface_region : pile_region);
          }
        return mesh;
      }

      /** Pushes the top to a displacement [m] and returns the force that it takes [N/m]. */
      double push(double displacement)
      {
        EXPECT_EQ(problem->equilibrate({0., 0., 0., 0., displacement}, true).status, EquilibriumStatus::converged);
        problem->move_baseline();
        material.settle(true);
        problem->commit();
        material.commit();
        return find_response(*problem, "top").force[0];
      }

      CompositeMaterial material;
      std::unique_ptr<QuasiStaticProblem<2>> problem;
    };

    /** Displacement [m] of the top at a shear stress [Pa] that the layer bears. */
    double compute_elastic_displacement(double shear)
    {
      const double modulus = youngs_modulus / (2. * (1. + poissons_ratio));
      return shear * ((height - thickness) / modulus + thickness / slippery.shear_modulus);
    }
  } // namespace

  TEST(FrictionalLayer, ABlockSlidesAtFrictionTimesItsPressure)
  {
    // Law: the force is that of springs in a row below mu sigma_n and stays mu sigma_n beyond, however far it slides.
    for (const Kinematics kinematics : {Kinematics::small, Kinematics::finite})
      {
        Blocks blocks(kinematics);
        // Small: linear to rounding. Finite: shear strains of 2e-3 in the layer count squared.
        const double tolerance = kinematics == Kinematics::small ? 1e-8 : 1e-3;
        const double limit = friction * pressure;
        for (const double share : {0.4, 0.95})
          EXPECT_NEAR(blocks.push(compute_elastic_displacement(share * limit)), share * limit, tolerance * limit);
        for (const double slide : {0.2, 1., 2., 3.}) // times the layer's thickness
          EXPECT_NEAR(blocks.push(slide * thickness), limit, tolerance * limit) << slide;
        EXPECT_NEAR(blocks.push(3. * thickness - compute_elastic_displacement(limit)), 0., 2. * tolerance * limit);
      }
  }

  TEST(FrictionalLayer, AFaceThatIsPulledOffBearsNothing)
  {
    // Law: no tension and no shear where the faces part; back together they bear what they did.
    FrictionalLayer layer(slippery, MPI_COMM_SELF);
    layer.initialise(std::vector<PointSite>{{0, dealii::Point<3>(), get_stress({})}});
    const auto ask = [&](double opening, double slide) {
      PointRequest request{0, Tensor<2, 3>(dealii::unit_symmetric_tensor<3>())};
      request.deformation_increment[2][2] += opening;
      request.deformation_increment[0][2] += slide;
      PointResponse response;
      layer.evaluate(std::span(&request, 1), std::span(&response, 1), true);
      return response.stress;
    };
    EXPECT_NEAR(ask(0., 1.)[2][0], friction * pressure, 1e-9 * pressure); // rounding, here and below
    EXPECT_EQ(ask(0.01, 0.).norm(), 0.);
    EXPECT_EQ(ask(0.01, 0.1).norm(), 0.);
    EXPECT_NEAR(ask(std::exp(-pressure / slippery.normal_modulus) - 1., 1.)[2][0], 2. * friction * pressure,
                1e-9 * pressure);
    layer.settle(true);
    EXPECT_NEAR(ask(0., 0.)[2][2], -2. * pressure, 1e-9 * pressure);
  }

  TEST(FrictionalLayer, ARotationTurnsItsStressAndChangesNothingElse)
  {
    // Law: evaluate(R dF) = R evaluate(dF) R^T, sticking or slipping, for every rotation and stretch.
    Tensor<2, 3> axis; // skew
    axis[0][1] = 0.7;
    axis[1][0] = -0.7;
    axis[1][2] = -1.1;
    axis[2][1] = 1.1;
    axis[0][2] = 0.4;
    axis[2][0] = -0.4;
    const Tensor<2, 3> identity(dealii::unit_symmetric_tensor<3>());
    const Tensor<2, 3> rotation = dealii::invert(identity - axis) * (identity + axis); // Cayley
    for (const double slide : {0.001, 0.3})
      {
        PointRequest request{0, identity};
        request.deformation_increment[0][2] = slide;
        request.deformation_increment[2][0] = 0.1;
        request.deformation_increment[1][2] = -0.5 * slide;
        request.deformation_increment[0][0] = 1.1;
        request.deformation_increment[2][2] = 0.9998;
        PointRequest turned = request;
        turned.deformation_increment = rotation * request.deformation_increment;
        FrictionalLayer layer(slippery, MPI_COMM_SELF);
        SymmetricTensor<2, 3> stress = get_stress({});
        stress[0][0] = -30e3;
        stress[0][2] = 20e3;
        layer.initialise(std::vector<PointSite>{{0, dealii::Point<3>(), stress}});
        PointResponse plain, other;
        layer.evaluate(std::span(&request, 1), std::span(&plain, 1), true);
        layer.evaluate(std::span(&turned, 1), std::span(&other, 1), true);
        const auto expected = rotate(plain.stress, rotation);
        EXPECT_LT((other.stress - expected).norm(), 1e-12 * expected.norm()) << slide; // rounding
      }
  }

  TEST(FrictionalLayer, ItsTangentIsTheChangeOfItsStress)
  {
    // Law: for slide along the faces and approach, d stress = C : D + w s - s w, sticking or slipping.
    const Tensor<2, 3> identity(dealii::unit_symmetric_tensor<3>());
    for (const double slide : {1e-4, 0.3})
      for (const unsigned int along : {0u, 1u, 2u}) // of the motion: 2 is approach
        {
          FrictionalLayer layer(slippery, MPI_COMM_SELF);
          layer.initialise(std::vector<PointSite>{{0, dealii::Point<3>(), get_stress({})}});
          constexpr double step = 1e-6;
          std::array<PointRequest, 3> requests;
          for (int i = 0; i < 3; ++i)
            {
              Tensor<2, 3> motion = identity;
              motion[along][2] += (i - 1) * step;
              requests[i] = {0, identity};
              requests[i].deformation_increment[0][2] = slide;
              requests[i].deformation_increment[1][2] = 0.5 * slide;
              requests[i].deformation_increment = motion * requests[i].deformation_increment;
            }
          std::array<PointResponse, 3> responses;
          for (int i = 0; i < 3; ++i)
            layer.evaluate(std::span(&requests[i], 1), std::span(&responses[i], 1), true);
          Tensor<2, 3> velocity_gradient;
          velocity_gradient[along][2] = 1.;
          const Tensor<2, 3> stress(responses[1].stress),
              spin = 0.5 * (velocity_gradient - dealii::transpose(velocity_gradient));
          const SymmetricTensor<2, 3> predicted = responses[1].tangent * dealii::symmetrize(velocity_gradient) +
                                                  dealii::symmetrize(spin * stress - stress * spin);
          const auto seen = (responses[2].stress - responses[0].stress) / (2. * step);
          // The second difference: stress is a logarithm of the approach, step^2 of a modulus of 1e9.
          EXPECT_LT((seen - predicted).norm(), 1e-6 * slippery.normal_modulus) << slide << ' ' << along;
        }
  }

  TEST(FrictionalLayer, ACheckpointHoldsIt)
  {
    // Law: what has slipped goes on from a file as it would have gone on without one.
    const ScratchFolder folder;
    const std::string file = folder.get_file("friction.h5");
    Blocks first(Kinematics::finite), second(Kinematics::finite);
    first.push(0.5 * thickness);
    Progress progress;
    progress.stage_values = first.problem->get_values();
    write_checkpoint(file, *first.problem, progress);
    read_checkpoint(file, *second.problem);
    EXPECT_EQ(first.push(0.49 * thickness), second.push(0.49 * thickness));
  }

  TEST(FrictionalLayer, APileSlipsAtFrictionTimesTheGroundsPressure)
  {
    // Law: where the shaft slips, its force is friction times the integral of the radial stress over its wall.
    constexpr double weight = 16e3, surcharge = 50e3, ratio = 0.5, radius = 0.15; // of the layer's middle [m]
    CompositeMaterial material(MPI_COMM_SELF);
    material.add(std::make_unique<ElasticMaterial>(ElasticParameters{30e9, 0., Kinematics::small}, MPI_COMM_SELF),
                 {pile_region});
    material.add(std::make_unique<FrictionalLayer>(make_layer(LayerNormal::radial, Kinematics::small), MPI_COMM_SELF),
                 {interface_region});
    material.add(std::make_unique<ElasticMaterial>(ElasticParameters{50e6, 0.2, Kinematics::small}, MPI_COMM_SELF),
                 {ground_region});
    auto conditions = get_ground_conditions();
    conditions.push_back({"surface", ConditionKind::pressure, "", surcharge});
    conditions.push_back({"head", ConditionKind::displacement, "z"});
    ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::small);
    parameters.newton.tolerance = 1e-8; // the pile is 600 times as stiff
    parameters.unit_weight = weight;
    parameters.pile_regions = {pile_region};
    QuasiStaticProblem<2> problem(read_pile_mesh("pile_coarse.msh"), conditions, parameters, material,
                                  [&](const dealii::Point<3> &place) {
                                    SymmetricTensor<2, 3> stress;
                                    stress[2][2] = -surcharge + weight * place[2];
                                    stress[0][0] = stress[1][1] = ratio * stress[2][2];
                                    return stress;
                                  });
    Stage push;
    push.n_increments = 10;
    push.targets = {{"head", ConditionKind::displacement, "z", -0.005}};
    LoadStepping<2> stepping(problem, {push}, {});
    ASSERT_EQ(stepping.run().status, StepStatus::ok);
    const auto points = problem.compute_interface_points("shaft");
    ASSERT_EQ(points.size(), 16u); // four cells along the shaft
    double force = 0.;
    for (const InterfacePoint &point : points)
      {
        const double pressure = -point.state.stress[0][0];
        EXPECT_NEAR(std::abs(point.state.stress[0][2]), friction * pressure, 1e-6 * surcharge); // all of it slips
        // Heights of the cells from the tip up: 1, 1.8, 1.8^2, 1.8^3 in 5 m; four points each.
        const double unit = 5. / (1. + 1.8 + 1.8 * 1.8 + 1.8 * 1.8 * 1.8);
        double top = -5., height = unit;
        for (; top + height < point.state.position[2]; height *= 1.8)
          top += height;
        force += friction * pressure * 2. * dealii::numbers::PI * radius * height / 4.;
      }
    const double shaft = -find_response(problem, "shaft").force[2];
    std::printf("the shaft bears %.4g kN, friction times radial stress over the wall is %.4g kN\n", 1e-3 * shaft,
                1e-3 * force);
    // Wall and layer's middle differ by a sixth in radius, and the layer's own vertical stress ends at its lower end.
    EXPECT_NEAR(shaft, force, 0.1 * force);
  }
} // namespace fem::cases::friction
