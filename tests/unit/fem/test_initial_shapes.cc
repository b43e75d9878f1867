#include "fem/initial_shapes.h"

#include "fem/mesh_input.h"
#include "fem/serendipity.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/fe/mapping_q.h>

#include <gtest/gtest.h>

namespace
{
  /** A ring of cells that differ in size and direction, on all ranks. */
  template <int dim>
  fem::Mesh<dim> create_ring()
  {
    fem::MeshParameters parameters;
    parameters.kind = fem::MeshKind::cylinder;
    parameters.inner_radius = 0.5;
    parameters.n_cells = {{2, 6, 3}};
    return fem::create_mesh<dim>(parameters, dim == 2 ? fem::Geometry::axisymmetric : fem::Geometry::three_dimensional,
                                 MPI_COMM_WORLD);
  }

  // Law: what is kept of each point of a cell is what deal.II computes for it anew, to the last bit.
  template <int dim>
  void expect_own_values(const dealii::FiniteElement<dim> &of_a_component)
  {
    const auto mesh = create_ring<dim>();
    const dealii::FESystem<dim> element(of_a_component, dim);
    const dealii::MappingQ<dim> mapping(2);
    dealii::DoFHandler<dim> dofs(*mesh.triangulation);
    dofs.distribute_dofs(element);
    const dealii::QGauss<dim> quadrature(2);
    const fem::InitialShapes<dim> shapes(dofs, mapping, quadrature);
    dealii::FEValues<dim> values(mapping, element, quadrature,
                                 dealii::update_values | dealii::update_gradients | dealii::update_quadrature_points |
                                     dealii::update_JxW_values);
    std::size_t point = 0;
    for (const auto &cell : dofs.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          values.reinit(cell);
          for (const unsigned int q : values.quadrature_point_indices())
            {
              EXPECT_EQ(shapes.get_measure(point), values.JxW(q));
              EXPECT_EQ(shapes.get_position(point), values.quadrature_point(q));
              for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i)
                {
                  EXPECT_EQ(shapes.get_component(i), element.system_to_component_index(i).first);
                  EXPECT_EQ(shapes.get_value(point, i), values.shape_value(i, q));
                  EXPECT_EQ(shapes.get_gradient(point, i), values.shape_grad(i, q));
                }
              ++point;
            }
        }
  }
} // namespace

TEST(InitialShapes, OfCellsAreThoseOfDealII)
{
  expect_own_values<2>(dealii::FE_Q<2>(1));
  expect_own_values<3>(dealii::FE_Q<3>(2));
  expect_own_values<3>(fem::SerendipityElement<3>());
}

TEST(InitialShapes, OfFacesSpanTheBoundary)
{
  // Laws: normals point away from the axis and areas add up to the cylinder's 2 pi r h; shape functions add up to one,
  // their gradients to none.
  const auto mesh = create_ring<3>();
  const dealii::FESystem<3> element(dealii::FE_Q<3>(2), 3);
  const dealii::MappingQ<3> mapping(2);
  dealii::DoFHandler<3> dofs(*mesh.triangulation);
  dofs.distribute_dofs(element);
  const auto id = mesh.boundary_ids.at("outer");
  const auto faces = fem::list_face_shapes<3>(
      dofs, mapping, [&](const auto &face) { return face->at_boundary() && face->boundary_id() == id; });
  double area = 0.;
  for (const auto &face : faces)
    for (const auto &point : face.points)
      {
        area += point.measure;
        const dealii::Tensor<1, 3> outwards({point.position[0], point.position[1], 0.});
        EXPECT_NEAR(point.normal * outwards / outwards.norm(), 1., 1e-3); // parabolas of 60 degrees for a circle
        double sum = 0.;
        dealii::Tensor<1, 3> slope;
        for (unsigned int i = 0; i < face.dofs.size(); ++i)
          if (element.system_to_component_index(i).first == 0)
            {
              sum += point.values[i];
              slope += point.gradients[i];
            }
        EXPECT_NEAR(sum, 1., 1e-13);          // rounding of 27 terms of size one
        EXPECT_NEAR(slope.norm(), 0., 1e-11); // the same, over cells of a tenth of a metre or more
      }
  EXPECT_NEAR(dealii::Utilities::MPI::sum(area, MPI_COMM_WORLD), 2. * dealii::numbers::PI,
              2e-3 * 2. * dealii::numbers::PI);
}
