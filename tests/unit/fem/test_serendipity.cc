#include "fem/serendipity.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/tria.h>
#include <deal.II/lac/lapack_full_matrix.h>

#include <gtest/gtest.h>

using dealii::Point;

namespace
{
  constexpr double rounding = 1e-13; // of sums of twenty terms of size one

  /** A polynomial with one square a term, and its slope along x. */
  template <int dim>
  double compute_field(const Point<dim> &p)
  {
    const double x = p[0], y = p[1], z = p[dim - 1];
    return 1. + x * x * z - 2. * z * z + 3. * x * y * y;
  }

  template <int dim>
  double compute_slope(const Point<dim> &p)
  {
    return 2. * p[0] * p[dim - 1] + 3. * p[1] * p[1];
  }

  template <int dim>
  void expect_interpolation()
  {
    const fem::SerendipityElement<dim> element;
    const auto &nodes = element.get_unit_support_points();
    ASSERT_EQ(nodes.size(), dim == 2 ? 8u : 20u);
    for (const double t : {0.21, 0.74})
      {
        Point<dim> p;
        for (unsigned int d = 0; d < dim; ++d)
          p[d] = t / (d + 1.);
        double value = 0., slope = 0.;
        for (unsigned int i = 0; i < nodes.size(); ++i)
          {
            value += compute_field(nodes[i]) * element.shape_value(i, p);
            slope += compute_field(nodes[i]) * element.shape_grad(i, p)[0];
          }
        EXPECT_NEAR(value, compute_field(p), rounding);
        EXPECT_NEAR(slope, compute_slope(p), 10. * rounding); // coefficients up to 8
      }
  }

  template <int dim>
  void expect_own_nodes()
  {
    const fem::SerendipityElement<dim> element;
    const auto &nodes = element.get_unit_support_points();
    for (unsigned int i = 0; i < nodes.size(); ++i)
      {
        for (unsigned int j = 0; j < nodes.size(); ++j)
          EXPECT_NEAR(element.shape_value(i, nodes[j]), i == j ? 1. : 0., rounding);
        for (unsigned int face = 0; face < 2 * dim; ++face)
          {
            Point<dim> p;
            for (unsigned int d = 0; d < dim; ++d)
              p[d] = 0.3 + 0.1 * d;
            p[face / 2] = face % 2;
            if (!element.has_support_on_face(i, face))
              {
                EXPECT_NEAR(element.shape_value(i, p), 0., rounding);
              }
          }
      }
  }

  /** Of 2 x 2 x 2 elements that nothing holds, as their points see them. @param n  points along each direction */
  unsigned int count_motions_without_strain(const dealii::FiniteElement<3> &element, const unsigned int n)
  {
    dealii::Triangulation<3> mesh;
    dealii::GridGenerator::subdivided_hyper_rectangle(mesh, {2, 2, 2}, Point<3>(), Point<3>(1., 1.3, 1.7));
    dealii::DoFHandler<3> dofs(mesh);
    dofs.distribute_dofs(dealii::FESystem<3>(element, 3));
    dealii::FEValues<3> values(dofs.get_fe(), dealii::QGauss<3>(n), dealii::update_gradients);
    dealii::LAPACKFullMatrix<double> stiffness(dofs.n_dofs(), dofs.n_dofs());
    std::vector<dealii::types::global_dof_index> at(dofs.get_fe().n_dofs_per_cell());
    const dealii::FEValuesExtractors::Vector displacement(0);
    for (const auto &cell : dofs.active_cell_iterators())
      {
        values.reinit(cell);
        cell->get_dof_indices(at);
        for (const unsigned int q : values.quadrature_point_indices())
          for (unsigned int i = 0; i < at.size(); ++i)
            for (unsigned int j = 0; j < at.size(); ++j)
              stiffness(at[i], at[j]) +=
                  values[displacement].symmetric_gradient(i, q) * values[displacement].symmetric_gradient(j, q);
      }
    stiffness.compute_svd();
    unsigned int n_motions = 0;
    for (unsigned int i = 0; i < dofs.n_dofs(); ++i)
      n_motions += stiffness.singular_value(i) < 1e-10 * stiffness.singular_value(0); // far above rounding
    return n_motions;
  }
} // namespace

TEST(Serendipity, ReproducesTermsWithOneSquare)
{
  // Law: nodal values of a polynomial whose terms square one coordinate at most give it back everywhere.
  expect_interpolation<2>();
  expect_interpolation<3>();
}

TEST(Serendipity, ShapeFunctionsBelongToTheirNodes)
{
  // Law: each is one at its own node, zero at all others and on every face without that node.
  expect_own_nodes<2>();
  expect_own_nodes<3>();
}

TEST(Serendipity, EightPointsLeaveRigidMotionsAlone)
{
  // Law: of 2 x 2 x 2 elements with two Gauss points a direction nothing but the six rigid motions is free of strain;
  // with nodes inside faces and cells more is.
  EXPECT_EQ(count_motions_without_strain(fem::SerendipityElement<3>(), 2), 6u);
  EXPECT_GT(count_motions_without_strain(dealii::FE_Q<3>(2), 2), 6u);
}
