#pragma once

#include <deal.II/fe/fe_poly.h>

namespace fem
{
  /**
   * Element of second order with nodes at corners and edges alone: 20 in a hexahedron, 8 in a quadrilateral.
   *
   * Shape functions are those of 1, x, y, z, their products, and the square of one coordinate times products of
   * the others. With 2 Gauss points a direction each element has modes without strain, but none that a neighbour could
   * share (Zienkiewicz and Taylor, The Finite Element Method): 8 points a hexahedron are enough, where the full
   * (Lagrange) element of 27 nodes needs 27. Degree 2 of the mapping alone; no hanging nodes.
   */
  template <int dim>
  class SerendipityElement : public dealii::FE_Poly<dim>
  {
  public:
    SerendipityElement();

    std::string get_name() const override;
    std::unique_ptr<dealii::FiniteElement<dim>> clone() const override;
    bool has_support_on_face(unsigned int shape_index, unsigned int face_index) const override;
  };
} // namespace fem
