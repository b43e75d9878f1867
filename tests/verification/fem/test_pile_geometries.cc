#include "tests/support/pile_cases.h"

#include <gtest/gtest.h>

namespace fem::cases::geometries // names of its own: several tests are one translation unit
{

  // The same pile, from untouched ground to a load test, as half a wall in plane strain and as a quarter of a square
  // pile in space.
  namespace
  {
    constexpr double weight = 16e3, surcharge = 50e3, ratio = 0.5, length = 5.; // of the ground, of the pile
    constexpr double widening = 0.01;                                           // [m]
    constexpr ElasticParameters concrete = {30e9, 0.2, Kinematics::finite}, sand = {50e6, 0.25, Kinematics::finite};

    dealii::SymmetricTensor<2, 3> get_stress(const dealii::Point<3> &place)
    {
      dealii::SymmetricTensor<2, 3> stress;
      stress[2][2] = -surcharge + weight * place[2];
      stress[0][0] = stress[1][1] = ratio * stress[2][2];
      return stress;
    }

    /** What a geometry's mesh is called, its walls with the direction they look in, and the pile's section in it [m2,
     *  m2/m]. */
    template <int dim>
    struct Setting;

    template <>
    struct Setting<2>
    {
      static constexpr Geometry geometry = Geometry::plane_strain;
      static constexpr const char *mesh = "pile_coarse.msh";
      static constexpr double section = 0.125, wall_width = 1.;
      static std::vector<std::pair<std::string, std::string>> get_walls() { return {{"shaft", "x"}}; }
      static std::vector<std::pair<std::string, std::string>> get_sides() { return {{"axis", "x"}, {"far", "x"}}; }
    };

    template <>
    struct Setting<3>
    {
      static constexpr Geometry geometry = Geometry::three_dimensional;
      static constexpr const char *mesh = "pile_3d.msh";
      static constexpr double section = 0.1 * 0.1, wall_width = 0.1;
      static std::vector<std::pair<std::string, std::string>> get_walls()
      {
        return {{"shaft_x", "x"}, {"shaft_y", "y"}};
      }
      static std::vector<std::pair<std::string, std::string>> get_sides()
      {
        return {{"symmetry_x", "x"}, {"symmetry_y", "y"}, {"far_x", "x"}, {"far_y", "y"}};
      }
    };

    template <int dim>
    std::vector<BoundaryCondition> get_conditions(bool is_absent)
    {
      std::vector<BoundaryCondition> conditions;
      for (const auto &[name, component] : Setting<dim>::get_sides())
        conditions.push_back({name, ConditionKind::displacement, component});
      conditions.push_back({"bottom", ConditionKind::displacement, "z"});
      conditions.push_back({"surface", ConditionKind::pressure, "", surcharge});
      if (!is_absent)
        conditions.push_back({"head", ConditionKind::pressure, "", surcharge});
      if (is_absent)
        for (const auto &[name, component] : Setting<dim>::get_walls())
          conditions.push_back(make_displacement(name, component, true));
      if (is_absent)
        conditions.push_back(make_displacement("base", "z", true));
      conditions.push_back(make_displacement("head", "z", false));
      return conditions;
    }

    /** Widen the hole, place the pile, push its head; the last alone where the pile is wished in place. */
    template <int dim>
    std::vector<Stage> get_stages(bool is_absent)
    {
      Stage widen, place, push;
      for (const auto &[name, component] : Setting<dim>::get_walls())
        {
          widen.targets.push_back({name, ConditionKind::displacement, component, widening});
          place.releases.push_back({name, ConditionKind::displacement, component});
        }
      widen.n_increments = place.n_increments = push.n_increments = 2;
      place.places_pile = true;
      place.releases.push_back({"base", ConditionKind::displacement, "z"});
      push.holds = {{"head", ConditionKind::displacement, "z"}};
      push.targets = {{"head", ConditionKind::displacement, "z", -0.002}};
      return is_absent ? std::vector<Stage>{widen, place, push} : std::vector<Stage>{push};
    }

    template <int dim>
    struct PileRun
    {
      explicit PileRun(bool is_absent)
          : material(make_elastic_pile(concrete, sand)),
            problem(read_mesh(), get_conditions<dim>(is_absent), get_parameters(is_absent), *material, get_stress),
            stepping(problem, get_stages<dim>(is_absent), {})
      {}

      static Mesh<dim> read_mesh()
      {
        MeshParameters parameters;
        parameters.kind = MeshKind::file;
        parameters.file = std::string(SLOWSAND_SOURCE_DIR) + "/meshes/" + Setting<dim>::mesh;
        return create_mesh<dim>(parameters, Setting<dim>::geometry, MPI_COMM_SELF);
      }

      static ProblemParameters get_parameters(bool is_absent)
      {
        ProblemParameters parameters = get_exact_parameters(Setting<dim>::geometry, Kinematics::finite);
        parameters.newton.tolerance = 1e-8;
        parameters.unit_weight = weight;
        parameters.pile_regions = {pile_region};
        parameters.is_pile_absent = is_absent;
        return parameters;
      }

      void advance(unsigned int n_steps)
      {
        for (unsigned int i = 0; i < n_steps; ++i)
          ASSERT_EQ(stepping.advance(), StepStatus::ok);
      }

      double get_shaft_force() const
      {
        double force = 0.;
        for (const auto &[name, component] : Setting<dim>::get_walls())
          force -= find_response(problem, name).force[2];
        return force;
      }

      std::unique_ptr<CompositeMaterial> material;
      QuasiStaticProblem<dim> problem;
      LoadStepping<dim> stepping;
    };

    template <int dim>
    void check_untouched_ground()
    {
      PileRun<dim> run(true);
      EXPECT_LT(run.problem.compute_unbalanced_share(), 1e-12); // rounding
      // Nodes of the hole share in the layer beside it and in the cells beneath its floor, as shape functions decline
      // there: along a wall over its width and half a layer, in depth over its length and, linearly, the first cell
      // below.
      constexpr double layer = 0.05, below = 1.25; // of both meshes [m]
      const double width = dim == 3 ? Setting<dim>::wall_width + 0.5 * layer : Setting<dim>::wall_width;
      const double tip = surcharge + weight * length;
      const double wall =
          width * ratio *
          (surcharge * length + 0.5 * weight * length * length + 0.5 * tip * below + weight * below * below / 6.);
      const double floor = Setting<dim>::section * (surcharge + weight * length);
      for (const auto &[name, component] : Setting<dim>::get_walls())
        {
          const unsigned int axis = component == "x" ? 0 : 1;
          double force = find_response(run.problem, name).force[axis] + find_response(run.problem, "base").force[axis];
          for (const auto &[other, direction] : Setting<dim>::get_walls())
            force += other == name ? 0. : find_response(run.problem, other).force[axis];
          EXPECT_NEAR(force, wall, 1e-7 * wall) << name; // gmsh places nodes to some 1e-9 of a metre
        }
      EXPECT_NEAR(run.get_shaft_force() - find_response(run.problem, "base").force[2], floor, 1e-7 * floor);
    }

    template <int dim>
    void check_load_test(bool is_absent)
    {
      PileRun<dim> run(is_absent);
      if (is_absent)
        {
          run.advance(2);
          const auto [name, component] = Setting<dim>::get_walls().front();
          const double held = find_response(run.problem, name).force[0];
          run.advance(2);
          // The pile is 600 times as stiff as ground; what changes is at the tip, whose floor is let go too.
          EXPECT_NEAR(find_response(run.problem, name).force[0], held, 0.05 * held);
        }
      run.advance(2);
      const double head = -find_response(run.problem, "head").force[2];
      const double pile_weight = weight * Setting<dim>::section * length;
      EXPECT_GT(head, 1e3);
      EXPECT_GT(run.get_shaft_force(), 0.1 * head); // pile and ground are bonded
      EXPECT_NEAR(run.get_shaft_force() - find_response(run.problem, "base").force[2], head + pile_weight, 1e-6 * head);
    }
  } // namespace

  TEST(PileGeometries, UntouchedGroundIsInEquilibrium)
  {
    // Law: what holds the hole carries K0 (q + gamma depth) beside it and q + gamma L on its floor: linear in depth,
    // exact.
    check_untouched_ground<2>();
    check_untouched_ground<3>();
  }

  TEST(PileGeometries, AnInstalledPileBearsWhatItsHeadAndItsWeightPressWith)
  {
    // Law: widened, placed and pushed, a pile passes on head load and weight through shaft and base; its walls bear
    // what held the hole.
    check_load_test<2>(true);
    check_load_test<3>(true);
  }

  TEST(PileGeometries, APileWishedInPlaceDoesToo)
  {
    // Law: the same, without installation.
    check_load_test<2>(false);
    check_load_test<3>(false);
  }

  TEST(PileGeometries, TheWallsOfASquarePileAreAlike)
  {
    // Law: symmetry of space: what one wall feels along x the other feels along y.
    PileRun<3> run(true);
    run.advance(6);
    const BoundaryResponse x = find_response(run.problem, "shaft_x"), y = find_response(run.problem, "shaft_y");
    EXPECT_NEAR(x.force[0], y.force[1], 1e-6 * x.force[0]); // Newton's tolerance of 1e-8 times the number of nodes
    EXPECT_NEAR(x.force[2], y.force[2], 1e-6 * x.force[0]);
    const auto points = run.problem.compute_interface_points("shaft_x");
    EXPECT_EQ(points.size(), 24u); // three cells of eight points
    for (const InterfacePoint &point : points)
      EXPECT_NEAR(point.distance, point.state.position[0] - 0.1, 1e-12); // rounding
  }
} // namespace fem::cases::geometries
