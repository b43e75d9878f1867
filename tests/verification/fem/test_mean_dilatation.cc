#include "tests/support/fem_cases.h"

#include "fem/assembly.h"

#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/numerics/vector_tools.h>

#include <gtest/gtest.h>

namespace fem::cases::mean_dilatation // names of its own: several tests are one translation unit
{
  // A hole that is widened in ground of hardly any change of volume: what bilinear cells make of it.
  namespace
  {
    constexpr double a = 0.125, b = 0.25, widening = 1e-3;
    constexpr ElasticParameters rubber = {1e6, 0.4999, Kinematics::small};

    MeshParameters get_ring(unsigned int n_cells)
    {
      MeshParameters ring;
      ring.kind = MeshKind::cylinder;
      ring.inner_radius = a;
      ring.outer_radius = b;
      ring.height = 0.1;
      ring.n_cells = {{n_cells, 1, 1}};
      return ring;
    }

    /** u = A r + B / r with u(a) as given and no stress on b (Lame, plane strain). */
    double compute_radial_stress(double r)
    {
      const double E = rubber.youngs_modulus, nu = rubber.poissons_ratio;
      const double G = E / (2. * (1. + nu)), lambda = E * nu / ((1. + nu) * (1. - 2. * nu));
      const double ratio = G / ((lambda + G) * b * b); // A = ratio B
      const double B = widening / (ratio * a + 1. / a);
      return 2. * (lambda + G) * ratio * B - 2. * G * B / (r * r);
    }

    ProblemParameters get_parameters(Dilatation dilatation)
    {
      ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::small, 1);
      parameters.dilatation = dilatation;
      parameters.newton.tolerance = 1e-8; // bulk over shear modulus is 5000: rounding
      return parameters;
    }

    /** The ring, not yet widened. */
    struct Hole
    {
      Hole(Dilatation dilatation, unsigned int n_cells)
          : problem(create_mesh<2>(get_ring(n_cells), Geometry::axisymmetric, MPI_COMM_SELF),
                    {{"inner", ConditionKind::displacement, "x"},
                     {"bottom", ConditionKind::displacement, "z"},
                     {"top", ConditionKind::displacement, "z"}},
                    get_parameters(dilatation), material)
      {}

      void widen()
      {
        const NewtonResult result = problem.equilibrate({widening, 0., 0.}, true);
        EXPECT_EQ(result.status, EquilibriumStatus::converged);
        EXPECT_LE(result.evaluations, 3u); // a linear problem: the stiffness is that of the forces
        problem.move_baseline();
      }

      ElasticMaterial material{rubber, MPI_COMM_SELF};
      QuasiStaticProblem<2> problem;
    };

    /** Largest error of the radial stress at a Gauss point over that of the wall [-]. */
    double compute_worst_error(Dilatation dilatation, unsigned int n_cells)
    {
      Hole hole(dilatation, n_cells);
      hole.widen();
      hole.problem.commit();
      double worst = 0.;
      for (const PointState &point : hole.problem.compute_point_states())
        worst = std::max(worst, std::abs(point.stress[0][0] - compute_radial_stress(point.position[0])));
      return worst / std::abs(compute_radial_stress(a));
    }

    struct Distortion : dealii::Function<2>
    {
      Distortion() : dealii::Function<2>(2) {}
      double value(const dealii::Point<2> &p, unsigned int component) const override
      {
        return component == 0 ? 0.3 * p[0] * p[1] + 0.05 : -0.2 * p[1] * p[1] + 0.1 * p[0];
      }
    };

    /** An assembly over a ring, with cells' means, and what it is built on. */
    struct Ring
    {
      Ring() : mesh(create_mesh<2>(get_ring(3), Geometry::axisymmetric, MPI_COMM_SELF)), dofs(*mesh.triangulation)
      {
        dofs.distribute_dofs(element);
        assembly = std::make_unique<Assembly<2>>(dofs, mapping, Geometry::axisymmetric, Kinematics::finite, 2,
                                                 Dilatation::cell_mean);
      }

      Vector create_vector() const { return Vector(dofs.locally_owned_dofs(), MPI_COMM_SELF); }

      std::vector<dealii::Tensor<2, 3>> compute_deformations(const Vector &displacement) const
      {
        auto deformations = assembly->compute_gradients(displacement);
        for (auto &deformation : deformations)
          deformation += dealii::Tensor<2, 3>(dealii::unit_symmetric_tensor<3>());
        return deformations;
      }

      /** Volume of the deformed ring [m^3], of the deformations that the material is given. */
      double compute_volume(const Vector &displacement) const
      {
        const auto deformations = compute_deformations(displacement);
        const auto initial = compute_initial_volumes();
        double volume = 0.;
        for (std::size_t p = 0; p < deformations.size(); ++p)
          volume +=
              initial[p] * dealii::determinant(assembly->compute_dilatation_factor(deformations, p) * deformations[p]);
        return volume;
      }

      std::vector<double> compute_initial_volumes() const
      {
        dealii::FEValues<2> values(mapping, element, dealii::QGauss<2>(2),
                                   dealii::update_JxW_values | dealii::update_quadrature_points);
        std::vector<double> volumes;
        for (const auto &cell : dofs.active_cell_iterators())
          {
            values.reinit(cell);
            for (const unsigned int q : values.quadrature_point_indices())
              volumes.push_back(values.JxW(q) * 2. * dealii::numbers::PI * values.quadrature_point(q)[0]);
          }
        return volumes;
      }

      Mesh<2> mesh;
      dealii::FESystem<2> element{dealii::FE_Q<2>(1), 2};
      dealii::MappingQ<2> mapping{1};
      dealii::DoFHandler<2> dofs;
      std::unique_ptr<Assembly<2>> assembly;
    };
  } // namespace

  TEST(MeanDilatation, AWidenedHoleFollowsLameAtEachGaussPoint)
  {
    // Law: radial stress is Lame's at every Gauss point. With each point's own change of volume bilinear cells lock:
    // stress swings about the law by many times itself.
    const double coarse = compute_worst_error(Dilatation::cell_mean, 4),
                 fine = compute_worst_error(Dilatation::cell_mean, 8);
    const double own = compute_worst_error(Dilatation::point, 4);
    std::printf("worst error over the wall's stress: cell mean %.3f with 4 cells, %.3f with 8; point %.3f with 4\n",
                coarse, fine, own);
    EXPECT_LT(fine, 0.6 * coarse); // first order in the cell's size: pressure is one number a cell
    EXPECT_LT(coarse, 0.2);        // a cell spans a fifth of the wall's radius, stress falls with its square
    EXPECT_GT(own, 5. * coarse);   // what the option is for
  }

  TEST(MeanDilatation, AStepHasTheStrainThatMaterialsAreGiven)
  {
    // Law: the strain that a step is judged by is the change of what its points report.
    Hole hole(Dilatation::cell_mean, 4);
    hole.widen();
    const double of_step = hole.problem.compute_step_effects().strain;
    hole.problem.commit();
    double largest = 0.;
    for (const PointState &point : hole.problem.compute_point_states())
      largest = std::max(largest, point.strain.norm());
    EXPECT_DOUBLE_EQ(of_step, largest);
  }

  TEST(MeanDilatation, ForcesOfAPressureAreTheGradientOfTheVolume)
  {
    // Law: where stress is -p everywhere, the work of the internal forces is -p times the change of the volume that the
    // material is given, however large the deformation.
    Ring ring;
    Vector displacement = ring.create_vector(), forces = ring.create_vector();
    dealii::VectorTools::interpolate(ring.mapping, ring.dofs, Distortion(), displacement);
    const auto deformations = ring.compute_deformations(displacement);
    std::vector<PointResponse> responses(deformations.size());
    const double pressure = 7.;
    for (PointResponse &response : responses)
      response.stress = -pressure * dealii::unit_symmetric_tensor<3>();
    ring.assembly->assemble_forces(deformations, responses, forces);
    constexpr double step = 1e-5;
    for (unsigned int dof = 0; dof < ring.dofs.n_dofs(); ++dof)
      {
        Vector more = displacement, less = displacement;
        more(dof) += step;
        less(dof) -= step;
        more.compress(dealii::VectorOperation::add);
        less.compress(dealii::VectorOperation::add);
        const double slope = (ring.compute_volume(more) - ring.compute_volume(less)) / (2. * step);
        EXPECT_NEAR(static_cast<double>(forces(dof)), -pressure * slope,
                    1e-8 * forces.linfty_norm()); // rounding over the step: 1e-16 / 1e-5, some hundred terms
      }
  }
} // namespace fem::cases::mean_dilatation
