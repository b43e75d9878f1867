#pragma once

#include <deal.II/base/numbers.h>
#include <deal.II/base/point.h>
#include <deal.II/base/tensor.h>

#include <array>
#include <string>
#include <vector>

namespace fem
{
  /** How a mesh stands in space. Gauss points are always three-dimensional: a 2-D mesh lies in the plane of x and z,
   * its second coordinate is z (axial, vertical); y is the hoop direction, or the direction out of the plane. */
  enum class Geometry
  {
    axisymmetric,
    plane_strain,
    three_dimensional
  };

  /** Space axis (0 x, 1 y, 2 z) of a mesh component. */
  template <int dim>
  constexpr unsigned int get_axis(unsigned int component)
  {
    return dim == 2 && component == 1 ? 2 : component;
  }

  /** Names of the mesh components: "x", "z" in two dimensions, "x", "y", "z" in three. */
  template <int dim>
  std::vector<std::string> get_component_names()
  {
    if constexpr (dim == 2)
      return {"x", "z"};
    else
      return {"x", "y", "z"};
  }

  /** Mesh vector or point in space axes. */
  template <int dim>
  dealii::Tensor<1, 3> embed(const dealii::Tensor<1, dim> &vector)
  {
    dealii::Tensor<1, 3> embedded;
    for (unsigned int c = 0; c < dim; ++c)
      embedded[get_axis<dim>(c)] = vector[c];
    return embedded;
  }

  /** Gradient in the initial configuration of a shape function that moves one component [1/m]; in axisymmetry with the
   *  hoop stretch N/r. On the axis, where no Gauss point of a cell lies, the hoop part is left out. */
  template <int dim>
  dealii::Tensor<2, 3> embed_gradient(Geometry geometry, unsigned int component, double value,
                                      const dealii::Tensor<1, dim> &gradient, double radius)
  {
    dealii::Tensor<2, 3> embedded;
    embedded[get_axis<dim>(component)] = embed<dim>(gradient);
    if (geometry == Geometry::axisymmetric && component == 0 && radius > 0.)
      embedded[1][1] = value / radius;
    return embedded;
  }

  /** Length of the circle that a point of the mesh stands for [m]; 1 unless axisymmetric. */
  inline double compute_depth(Geometry geometry, double radius)
  {
    return geometry == Geometry::axisymmetric ? 2. * dealii::numbers::PI * radius : 1.;
  }
} // namespace fem
