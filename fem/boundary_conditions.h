#pragma once

#include "fem/geometry.h"
#include "fem/initial_shapes.h"
#include "fem/linear_solver.h"
#include "fem/mesh_input.h"

#include <deal.II/dofs/dof_handler.h>
#include <deal.II/fe/mapping.h>
#include <deal.II/lac/affine_constraints.h>

#include <functional>
#include <string>
#include <vector>

namespace fem
{
  enum class ConditionKind
  {
    displacement, ///< total displacement of one component since the start [m]
    traction,     ///< one component of force per area [Pa], positive along the axis, of fixed direction
    pressure      ///< normal force per area [Pa], positive pushes on the body; the normal follows the boundary
  };

  /** Which area a traction or pressure is measured on. Laboratory and field stresses are per current area. */
  enum class AreaMeasure
  {
    current,
    initial
  };

  /** A condition on a named boundary; its value changes with the stages. It holds for the whole run unless a stage lets
   * it go or begins to hold it. A displacement may also be that of named faces inside the mesh. */
  struct BoundaryCondition
  {
    std::string boundary;
    ConditionKind kind = ConditionKind::displacement;
    std::string component;                   ///< "x", "y", "z" ("r" for x in axisymmetry); unused by pressure
    double initial_value = 0.;               ///< before the first stage [m] or [Pa]
    AreaMeasure area = AreaMeasure::current; ///< of tractions and pressures

    /** Displacement [m] at an initial position [m] for a value of the condition; empty: the value itself. */
    std::function<double(const dealii::Point<3> &position, double value)> profile = {};

    bool is_held = true; ///< a displacement: before the first stage
  };

  /** What boundaries are called, and faces inside the mesh. */
  struct BoundaryNames
  {
    std::map<std::string, dealii::types::boundary_id> boundaries;
    std::map<std::string, dealii::types::manifold_id> interfaces;
  };

  /** What a named boundary feels: force on the body [N] (over 2 pi in axisymmetry; per metre in plane strain), in space
   *  axes, and the average displacement [m] over its initial area. */
  struct BoundaryResponse
  {
    std::string name;
    dealii::Tensor<1, 3> force;
    dealii::Tensor<1, 3> displacement;
  };

  /** The conditions of a problem, tied to its unknowns. */
  template <int dim>
  class BoundaryConditions
  {
  public:
    /** Throws std::invalid_argument naming boundary or component and the known ones, or when a rigid
     *  motion of the body is left free. Where two conditions prescribe the
     *  same unknown, the first one listed holds. */
    BoundaryConditions(const dealii::DoFHandler<dim> &dof_handler, const dealii::Mapping<dim> &mapping,
                       Geometry geometry, const BoundaryNames &names, std::vector<BoundaryCondition> conditions);

    /** Says which displacements are prescribed from now on, one a condition. Throws as the constructor. */
    void set_held(const std::vector<bool> &is_held);

    const std::vector<bool> &get_held() const { return is_held_; }

    /** Zero displacement of all prescribed unknowns: the constraints on corrections. */
    const dealii::AffineConstraints<double> &get_constraints() const { return constraints_; }

    const std::vector<BoundaryCondition> &get_conditions() const { return conditions_; }

    /** Prescribed unknowns that this rank owns. */
    const std::vector<dealii::types::global_dof_index> &get_prescribed_dofs() const { return prescribed_dofs_; }

    /** Keeps the prescribed entries of an owned vector alone. */
    void set_free_to_zero(Vector &vector) const;

    /** Writes the prescribed displacements [m] into the owned entries of the vector, one value a condition. */
    void set_prescribed(const std::vector<double> &values, Vector &displacement) const;

    /** Nodal forces [N] of tractions and pressures on the configuration of a total displacement.
     *  @param ghosted_displacement [m]; null: areas and normals are the initial ones (small kinematics) */
    void assemble_external_forces(const std::vector<double> &values, const Vector *ghosted_displacement,
                                  Vector &forces) const;

    using VisitForces =
        std::function<void(const typename dealii::DoFHandler<dim>::active_cell_iterator &,
                           const std::vector<dealii::types::global_dof_index> &, const std::vector<double> &forces)>;

    /** The same one Gauss point of a face after the other, on the unknowns of its cell. */
    void for_each_external_force(const std::vector<double> &values, const Vector *ghosted_displacement,
                                 const VisitForces &visit) const;

    /** Forces and displacements of all named boundaries, then of all interfaces, whose forces are left NaN; collective.
     *  @param values     of the conditions, for their tractions
     *  @param reactions  internal minus external nodal forces [N]; of an unknown that several boundaries prescribe each
     *                    gets an equal share
     *  @param finite     false: small kinematics */
    std::vector<BoundaryResponse> compute_responses(const std::vector<double> &values, const Vector &reactions,
                                                    const Vector &ghosted_displacement, bool finite) const;

  private:
    struct PrescribedUnknown
    {
      dealii::types::global_dof_index dof;
      unsigned int condition; ///< the one that gives its value
      dealii::Point<3> position;
      unsigned int axis;
      std::vector<unsigned int> conditions; ///< all that prescribe it, for the sharing of its reaction
    };

    void check_conditions();
    void take_face_shapes();
    void collect_prescribed();
    dealii::IndexSet extract_dofs(unsigned int condition) const;
    void check_rigid_motions() const;
    unsigned int find_component(const BoundaryCondition &condition) const;

    void visit_condition_forces(unsigned int condition, double value, const Vector *ghosted_displacement,
                                const VisitForces &visit) const;
    dealii::Tensor<1, 3> compute_average_displacement(const std::string &boundary,
                                                      const Vector &ghosted_displacement) const;

    const dealii::DoFHandler<dim> &dof_handler_;
    const dealii::Mapping<dim> &mapping_;
    Geometry geometry_;
    BoundaryNames names_;
    std::map<std::string, std::vector<FaceShapes<dim>>> faces_; ///< of each boundary and interface, on this rank
    std::vector<bool> is_held_;                                 ///< one a condition
    std::vector<BoundaryCondition> conditions_;
    std::vector<unsigned int> components_;      ///< mesh component of each condition
    std::vector<PrescribedUnknown> prescribed_; ///< owned ones
    std::vector<dealii::types::global_dof_index> prescribed_dofs_;
    dealii::AffineConstraints<double> constraints_;
  };
} // namespace fem
