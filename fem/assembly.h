#pragma once

#include "fem/constitutive_model.h"
#include "fem/geometry.h"
#include "fem/initial_shapes.h"
#include "fem/kinematics.h"
#include "fem/linear_solver.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/dofs/dof_handler.h>
#include <deal.II/lac/affine_constraints.h>

#include <functional>
#include <set>

namespace fem
{
  /** Whose change of volume a Gauss point is given. */
  enum class Dilatation
  {
    point,    ///< its own
    cell_mean ///< that of its cell, so that bilinear cells do not lock where volume hardly changes; see assembly.cc
  };

  /**
   * Integrals over the cells of this rank: nodal forces of a stress field, and their tangent.
   *
   * Shape gradients are taken in the initial configuration and pulled to the current one by F^-1, so the mesh itself
   * never moves. Everything is three-dimensional; the geometry enters in embed_gradient() and compute_depth() alone.
   * Gauss points count cell by cell, as PointId does.
   *
   * Regions may be absent: their cells pass no force to the others. What belongs to absent cells alone follows the
   * motion of the rest like an elastic body without weight, so that these cells are ready to enter undistorted.
   */
  template <int dim>
  class Assembly
  {
  public:
    /** @param n_gauss_points  along each direction of a cell */
    Assembly(const dealii::DoFHandler<dim> &dof_handler, const dealii::Mapping<dim> &mapping, Geometry geometry,
             Kinematics kinematics, unsigned int n_gauss_points, Dilatation dilatation = Dilatation::point);

    unsigned int get_n_points_per_cell() const { return quadrature_.size(); }

    /** Says which regions are absent from now on. Collective. */
    void set_absent(const std::set<dealii::types::material_id> &regions);

    bool is_absent(dealii::types::material_id region) const { return absent_.contains(region); }

    /** True for an unknown that belongs to absent cells alone. */
    bool is_follower(dealii::types::global_dof_index dof) const { return !followers_.empty() && followers_[dof]; }

    /** Nodal forces [N] of the weight of the cells that are present, downwards along z. A cell's weight is that of its
     *  initial volume: mass stays. @param unit_weight  [N/m^3], of the initial configuration */
    void assemble_weight(double unit_weight, Vector &forces) const;

    /** Sites of this rank's Gauss points, initial stress left zero. */
    std::vector<PointSite> compute_sites() const;

    /** Gradients of a displacement in the initial configuration [-], one a Gauss point. @param ghosted  displacement
     * [m] */
    std::vector<dealii::Tensor<2, 3>> compute_gradients(const Vector &ghosted) const;

    /** What a point's F is multiplied by to become that which its material is given, (J mean / J)^(1/3) [-].
     *  @param deformations  total F a point; finite kinematics */
    double compute_dilatation_factor(const std::vector<dealii::Tensor<2, 3>> &deformations, std::size_t point) const;

    /** What is added to the three diagonal entries of a point's displacement gradient for its material, a third of the
     *  mean trace less its own [-]. @param gradients  one a point; small kinematics */
    double compute_dilatation_shift(const std::vector<dealii::Tensor<2, 3>> &gradients, std::size_t point) const;

    /** Internal nodal forces [N].
     *  @param deformations  total F a point @param responses  Cauchy stress a point */
    void assemble_forces(const std::vector<dealii::Tensor<2, 3>> &deformations,
                         const std::vector<PointResponse> &responses, Vector &forces) const;

    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;
    using VisitForces = std::function<void(const Cell &, const std::vector<dealii::types::global_dof_index> &,
                                           const std::vector<double> &forces)>;

    /** Internal nodal forces [N] of one cell of this rank after the other. */
    void for_each_force(const std::vector<dealii::Tensor<2, 3>> &deformations,
                        const std::vector<PointResponse> &responses, const VisitForces &visit) const;

    /** Weight [N] of one cell of this rank after the other, as nodal forces. */
    void for_each_weight(double unit_weight, const VisitForces &visit) const;

    /** Tangent of the internal forces [N/m], geometric part included: docs in assembly.cc.
     *  @param constrained  the same with the constrained unknowns eliminated */
    void assemble_stiffness(const std::vector<dealii::Tensor<2, 3>> &deformations,
                            const std::vector<PointResponse> &responses,
                            const dealii::AffineConstraints<double> &constraints, Matrix &stiffness,
                            Matrix &constrained) const;

    /** Volume [m^3] and centre of the mesh times volume [m^4], over all ranks. */
    std::pair<double, dealii::Tensor<1, 3>> compute_volume() const;

  private:
    /** What a cell's integrals need at each of its points. */
    struct CellShapes
    {
      std::vector<std::vector<dealii::Tensor<2, 3>>> gradients; ///< of each unknown
      std::vector<double> volumes;                              ///< of the point [m^3]
    };
    void compute_cell_shapes(std::size_t first_point, const std::vector<dealii::Tensor<2, 3>> &deformations,
                             CellShapes &shapes) const;
    void average_dilatation(CellShapes &shapes) const;

    /** Weighted by initial volumes. @param get  of a point */
    template <class Get>
    double compute_cell_mean(std::size_t first_point, const Get &get) const;

    /** Shape gradient of an unknown of a point's cell in the initial configuration [1/m]. */
    dealii::Tensor<2, 3> compute_initial_gradient(std::size_t point, unsigned int unknown) const;

    /** Shape gradients of all unknowns of a cell at a point, pulled to the configuration of F. */
    void compute_shape_gradients(std::size_t point, const dealii::Tensor<2, 3> &deformation,
                                 std::vector<dealii::Tensor<2, 3>> &gradients) const;
    double compute_initial_volume(std::size_t point) const;
    double compute_volume_element(std::size_t point, const dealii::Tensor<2, 3> &deformation) const;

    /** Share of an absent cell's force or stiffness that a row gets: see assembly.cc. */
    double compute_row_share(dealii::types::global_dof_index dof) const;

    template <class Work>
    void for_each_cell(const Work &work) const;

    unsigned int compute_cell_number(const Cell &cell) const;

    const dealii::DoFHandler<dim> &dof_handler_;
    Geometry geometry_;
    Kinematics kinematics_;
    Dilatation dilatation_;
    dealii::QGauss<dim> quadrature_;
    InitialShapes<dim> shapes_;
    std::vector<double> initial_volumes_; ///< of the points [m^3]; empty unless cells' means are asked for
    std::set<dealii::types::material_id> absent_;
    std::vector<bool> followers_; ///< of all unknowns; empty: none
  };
} // namespace fem
