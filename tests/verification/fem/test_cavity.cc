#include "tests/support/pile_cases.h"

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/manifold_lib.h>

#include <gtest/gtest.h>

namespace fem::cases::cavity // names of its own: several tests are one translation unit
{

  // A pile driven as a cavity that is widened in plane strain, then placed: slices of the mesh's layout in one row.
  namespace
  {
    constexpr double a = 0.25, b = 5.;
    constexpr ElasticParameters steel = {210e9, 0.3, Kinematics::small}, sand = {50e6, 0.25, Kinematics::small};

    /** Disc of pile up to a, ring of ground from a to b, named as a file would. */
    Mesh<2> create_disc(unsigned int n_ground)
    {
      Mesh<2> mesh;
      mesh.triangulation = std::make_unique<dealii::parallel::distributed::Triangulation<2>>(MPI_COMM_SELF);
      std::vector<std::vector<double>> steps(2);
      steps[0] = {a};
      double radius = a;
      for (unsigned int i = 1; i <= n_ground; ++i)
        {
          const double next = a * std::pow(b / a, double(i) / n_ground);
          steps[0].push_back(next - radius);
          radius = next;
        }
      steps[1] = {0.5};
      dealii::GridGenerator::subdivided_hyper_rectangle(*mesh.triangulation, steps, dealii::Point<2>(),
                                                        dealii::Point<2>(radius, 0.5), true);
      mesh.boundary_ids = {{"axis", 0}, {"far", 1}, {"bottom", 2}, {"top", 3}};
      mesh.interface_ids = {{"shaft", 10}};
      mesh.region_ids = {{"pile", pile_region}, {"ground", ground_region}};
      for (const auto &cell : mesh.triangulation->active_cell_iterators())
        {
          cell->set_material_id(cell->center()[0] < a ? pile_region : ground_region);
          for (const auto &face : cell->face_iterators())
            if (std::abs(face->center()[0] - a) < 1e-9)
              face->set_manifold_id(10);
        }
      mesh.triangulation->set_manifold(10, dealii::FlatManifold<2>());
      return mesh;
    }

    std::vector<Stage> get_stages(double widening)
    {
      Stage widen, place;
      widen.targets = {{"shaft", ConditionKind::displacement, "x", widening}};
      place.places_pile = true;
      place.releases = {{"shaft", ConditionKind::displacement, "x"}};
      place.n_increments = 2;
      return {widen, place};
    }

    struct Cavity
    {
      explicit Cavity(const ElasticParameters &pile)
          : material(make_elastic_pile(pile, sand)), problem(create_disc(24),
                                                             {{"axis", ConditionKind::displacement, "x"},
                                                              {"far", ConditionKind::displacement, "x"},
                                                              {"bottom", ConditionKind::displacement, "z"},
                                                              {"top", ConditionKind::displacement, "z"},
                                                              make_displacement("shaft", "x", true)},
                                                             get_parameters(), *material),
            stepping(problem, get_stages(widening), {})
      {}

      static ProblemParameters get_parameters()
      {
        ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::small, 2);
        parameters.newton.tolerance = 1e-8; // rounding: steel is 4000 times as stiff as the ground
        parameters.pile_regions = {pile_region};
        parameters.is_pile_absent = true;
        return parameters;
      }

      /** Pressure that the ground feels on the wall [Pa]. */
      double compute_pressure() const
      {
        return find_response(problem, "shaft").force[0] / (2. * dealii::numbers::PI * a * 0.5);
      }

      static constexpr double widening = 1e-3;
      std::unique_ptr<CompositeMaterial> material;
      QuasiStaticProblem<2> problem;
      LoadStepping<2> stepping;
    };

    /** Lame: stiffness p / u(a) of a ring whose outer radius is held, u = A r + B / r with u(b) = 0. */
    double compute_ring_stiffness()
    {
      const double E = sand.youngs_modulus, nu = sand.poissons_ratio;
      const double G = E / (2. * (1. + nu)), lambda = E * nu / ((1. + nu) * (1. - 2. * nu));
      const double B = 1. / (1. / a - a / (b * b)), A = -B / (b * b);
      return -(2. * (lambda + G) * A - 2. * G * B / (a * a));
    }

    /** Pressure over inward displacement of the rim of a disc: plane strain. */
    double compute_disc_stiffness(const ElasticParameters &pile)
    {
      const double E = pile.youngs_modulus, nu = pile.poissons_ratio;
      return E / ((1. + nu) * (1. - 2. * nu)) / a;
    }
  } // namespace

  TEST(Cavity, WideningFollowsLame)
  {
    // Law: the wall's pressure is Lame's for a ring held outside, with the absent pile inside.
    Cavity cavity(steel);
    ASSERT_EQ(cavity.stepping.advance(), StepStatus::ok);
    const double expected = compute_ring_stiffness() * Cavity::widening;
    std::printf("wall pressure %.6g Pa, Lame %.6g Pa\n", cavity.compute_pressure(), expected);
    EXPECT_NEAR(cavity.compute_pressure() / expected, 1., 1e-5); // 24 Q2 cells: see PileSlice
  }

  TEST(Cavity, ThePlacedPileTakesOverWhatTheWallCarried)
  {
    // Law: the pile enters free of stress at the widened radius; ring and disc then share the wall's way back:
    // p = p0 K_disc / (K_disc + K_ring). The disc is as soft as the ground here, so that the sharing shows.
    for (const ElasticParameters &pile : {steel, ElasticParameters{100e6, 0.2, Kinematics::small}})
      {
        Cavity cavity(pile);
        ASSERT_EQ(cavity.stepping.advance(), StepStatus::ok);
        const double held = cavity.compute_pressure();
        ASSERT_EQ(cavity.stepping.run().status, StepStatus::ok);
        const double disc = compute_disc_stiffness(pile), ring = compute_ring_stiffness();
        EXPECT_NEAR(cavity.compute_pressure() / held, disc / (disc + ring), 1e-5); // as above
        const double way = find_response(cavity.problem, "shaft").displacement[0] - Cavity::widening;
        EXPECT_NEAR(way, -held / (disc + ring), 1e-5 * held / ring);
        const PointState inside = cavity.problem.compute_nearest_point_state(dealii::Point<3>(0.1, 0., 0.25));
        EXPECT_NEAR(inside.stress[0][0] / cavity.compute_pressure(), -1., 1e-5); // uniform in the disc
      }
  }
} // namespace fem::cases::cavity
