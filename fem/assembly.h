#pragma once

#include "fem/constitutive_model.h"
#include "fem/geometry.h"
#include "fem/kinematics.h"
#include "fem/linear_solver.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/fe_values.h>
#include <deal.II/lac/affine_constraints.h>

namespace fem
{
  /**
   * Integrals over the cells of this rank: nodal forces of a stress field, and their tangent.
   *
   * Shape gradients are taken in the initial configuration and pulled to the current one by F^-1, so the mesh itself
   * never moves. Everything is three-dimensional; the geometry enters in embed_gradient() and compute_depth() alone.
   * Gauss points count cell by cell, as PointId does.
   */
  template <int dim>
  class Assembly
  {
  public:
    Assembly(const dealii::DoFHandler<dim> &dof_handler, const dealii::Mapping<dim> &mapping, Geometry geometry,
             Kinematics kinematics);

    unsigned int get_n_points_per_cell() const { return quadrature_.size(); }

    /** Sites of this rank's Gauss points, initial stress left zero. */
    std::vector<PointSite> compute_sites() const;

    /** Gradients of a displacement in the initial configuration [-], one a Gauss point. @param ghosted  displacement
     * [m] */
    std::vector<dealii::Tensor<2, 3>> compute_gradients(const Vector &ghosted) const;

    /** Internal nodal forces [N].
     *  @param deformations  total F a point @param responses  Cauchy stress a point */
    void assemble_forces(const std::vector<dealii::Tensor<2, 3>> &deformations,
                         const std::vector<PointResponse> &responses, Vector &forces) const;

    /** Tangent of the internal forces [N/m], geometric part included: docs in assembly.cc.
     *  @param constrained  the same with the constrained unknowns eliminated */
    void assemble_stiffness(const std::vector<dealii::Tensor<2, 3>> &deformations,
                            const std::vector<PointResponse> &responses,
                            const dealii::AffineConstraints<double> &constraints, Matrix &stiffness,
                            Matrix &constrained) const;

    /** Volume [m^3] and centre of the mesh times volume [m^4], over all ranks. */
    std::pair<double, dealii::Tensor<1, 3>> compute_volume() const;

  private:
    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;

    /** Shape gradients of all unknowns of a cell at a point, pulled to the configuration of F. */
    void compute_shape_gradients(const dealii::FEValues<dim> &values, unsigned int point,
                                 const dealii::Tensor<2, 3> &deformation,
                                 std::vector<dealii::Tensor<2, 3>> &gradients) const;
    double compute_volume_element(const dealii::FEValues<dim> &values, unsigned int point,
                                  const dealii::Tensor<2, 3> &deformation) const;

    template <class Work>
    void for_each_cell(const Work &work) const;

    const dealii::DoFHandler<dim> &dof_handler_;
    const dealii::Mapping<dim> &mapping_;
    Geometry geometry_;
    Kinematics kinematics_;
    dealii::QGauss<dim> quadrature_;
  };
} // namespace fem
