#pragma once

#include <deal.II/base/quadrature.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/mapping.h>

#include <functional>
#include <vector>

namespace fem
{
  /**
   * Shape functions in the initial configuration at the Gauss points of this rank's cells, which count cell by cell as
   * PointId does. The mesh never moves: they are computed once, and kept, some hundreds of bytes a point.
   */
  template <int dim>
  class InitialShapes
  {
  public:
    InitialShapes(const dealii::DoFHandler<dim> &dof_handler, const dealii::Mapping<dim> &mapping,
                  const dealii::Quadrature<dim> &quadrature);

    /** Of an unknown of the point's cell, counted as the cell does [-]. */
    double get_value(std::size_t point, unsigned int unknown) const
    {
      return values_[point % n_points_per_cell_ * n_nodes_ + nodes_[unknown]];
    }

    /** Of the same function, of the mesh component that the unknown moves [1/m]. */
    const dealii::Tensor<1, dim> &get_gradient(std::size_t point, unsigned int unknown) const
    {
      return gradients_[point * n_nodes_ + nodes_[unknown]];
    }

    /** Mesh component that an unknown moves. */
    unsigned int get_component(unsigned int unknown) const { return components_[unknown]; }

    const dealii::Point<dim> &get_position(std::size_t point) const { return positions_[point]; } ///< [m]

    /** Weight of the point, of the mesh's own dimension [m^2] or [m^3]. */
    double get_measure(std::size_t point) const { return measures_[point]; }

  private:
    std::size_t n_points_per_cell_, n_nodes_;
    std::vector<unsigned int> components_, nodes_; ///< of each unknown of a cell
    std::vector<double> values_;                   ///< the same in all cells
    std::vector<dealii::Tensor<1, dim>> gradients_;
    std::vector<dealii::Point<dim>> positions_;
    std::vector<double> measures_;
  };

  /** A face and its Gauss points in the initial configuration, with the shape functions of the cell it belongs to. */
  template <int dim>
  struct FaceShapes
  {
    struct Point
    {
      dealii::Point<dim> position;                   ///< [m]
      dealii::Tensor<1, dim> normal;                 ///< out of the cell [-]
      double measure;                                ///< weight, of the face's own dimension [m] or [m^2]
      std::vector<double> values;                    ///< of each unknown of the cell [-]
      std::vector<dealii::Tensor<1, dim>> gradients; ///< likewise [1/m]
    };

    typename dealii::DoFHandler<dim>::active_cell_iterator cell;
    std::vector<dealii::types::global_dof_index> dofs; ///< of the cell
    std::vector<Point> points;
  };

  template <int dim>
  using FacePredicate = std::function<bool(const typename dealii::DoFHandler<dim>::face_iterator &)>;

  /** Faces of this rank's cells that are meant, cell by cell; one inside the mesh comes from both sides. */
  template <int dim>
  std::vector<FaceShapes<dim>> list_face_shapes(const dealii::DoFHandler<dim> &dof_handler,
                                                const dealii::Mapping<dim> &mapping,
                                                const FacePredicate<dim> &is_meant);
} // namespace fem
