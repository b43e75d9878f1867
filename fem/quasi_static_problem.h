#pragma once

#include "fem/assembly.h"
#include "fem/boundary_conditions.h"
#include "fem/constitutive_model.h"
#include "fem/interface_forces.h"
#include "fem/kinematics.h"
#include "fem/loading_programme.h"
#include "fem/mesh_input.h"
#include "fem/newton_solver.h"
#include "fem/step_control.h"

#include <deal.II/fe/fe_system.h>
#include <deal.II/fe/mapping_q.h>

#include <functional>
#include <memory>

namespace fem
{
  enum class ElementKind
  {
    lagrange,   ///< nodes inside too: 4 or 9 in two dimensions, 8 or 27 in three
    serendipity ///< of degree 2, nodes at corners and edges: 8 or 20
  };

  struct ProblemParameters
  {
    Geometry geometry = Geometry::axisymmetric;
    Kinematics kinematics = Kinematics::finite;
    unsigned int degree = 1; ///< of the elements, 1 or 2
    ElementKind element = ElementKind::lagrange;
    unsigned int n_gauss_points = 0; ///< along each direction of an element; 0: degree + 1
    Dilatation dilatation = Dilatation::point;
    double unit_weight = 0.; ///< of all cells that are present, per initial volume, downwards along z [N/m^3], >= 0
    std::set<dealii::types::material_id> pile_regions; ///< the mesh's numbers of what is pile and not ground
    bool is_pile_absent = false;                       ///< before a stage places it
    LinearSolverParameters linear_solver;
    NewtonParameters newton;
  };

  /** A Gauss point as it stands after the last committed step; deformation is total, since the start. */
  struct PointState
  {
    PointId id = dealii::numbers::invalid_unsigned_int;
    dealii::Point<3> position;            ///< initial [m], in space axes
    dealii::Tensor<2, 3> deformation;     ///< gradient F as the material was given it [-]
    dealii::SymmetricTensor<2, 3> stress; ///< Cauchy [Pa], tension-positive
    dealii::SymmetricTensor<2, 3> strain; ///< logarithmic (small kinematics: linear) [-], tension-positive
  };

  /** A Gauss point of a cell that has a face on an interface, on the side that is not pile. */
  struct InterfacePoint
  {
    PointState state;
    dealii::Tensor<1, 3> normal; ///< initial one of the face, out of the pile [-]
    double distance = 0.;        ///< initial, from the face along the normal [m]
  };

  /**
   * One boundary value problem: mesh, unknowns, conditions and the material at the Gauss points.
   *
   * Unknowns are total displacements since the start; committed, baseline and trial ones follow the material's three
   * states. With finite kinematics the baseline is the reference configuration (updated Lagrangian): the material is
   * asked with dF = I + grad(u - u_baseline) F_baseline^-1, residual and tangent live in the trial configuration.
   *
   * All members are collective over the communicator of the mesh. On MPI_COMM_SELF every rank computes the same bits.
   */
  template <int dim>
  class QuasiStaticProblem : private NonlinearSystem
  {
  public:
    using StressField = std::function<dealii::SymmetricTensor<2, 3>(const dealii::Point<3> &)>;

    /** Numbers the unknowns and introduces the Gauss points to the material.
     *  @param initial_stress [Pa], tension-positive; empty: none. Throws std::invalid_argument for impossible input. */
    QuasiStaticProblem(Mesh<dim> mesh, const std::vector<BoundaryCondition> &conditions,
                       const ProblemParameters &parameters, ConstitutiveModel &material,
                       const StressField &initial_stress = {});

    /** Finds the equilibrium under the given values, one a condition ([m] or [Pa]), from the baseline.
     *  @param is_step_start  first equilibrium since commit or revert */
    NewtonResult equilibrate(const std::vector<double> &values, bool is_step_start);

    /** The trial configuration becomes the baseline: the material has settled. */
    void move_baseline();

    /** The baseline becomes history. @pre move_baseline() was called last */
    void commit();

    /** Back to the committed configuration. */
    void revert();

    /**
     * Begins another phase at the committed state, which stays in equilibrium: what is out of balance
     * because a displacement is let go or a pile enters is kept in place by nodal forces, the carried ones, until
     * set_carried_share() takes them away. A pile that enters
     * is stress-free in its present position. Displacements that begin to be held count from their present values.
     * Carried forces of an earlier phase are dropped. Returns what the material answers.
     */
    Status begin_phase(const Phase &phase);

    /** Takes part in a phase that has begun before, with carried forces and offsets from set_state(). */
    void set_phase(const Phase &phase);
    const Phase &get_phase() const { return phase_; }

    /** Share of the carried forces that acts in the next equilibrium [-]: from 1 to 0. */
    void set_carried_share(double share) { carried_share_ = share; }

    /** How far the committed state is from equilibrium under its own weight: norm of the free residual over the norm of
     *  all nodal weights [-]; NaN without weight. Asks the material at no increment. */
    double compute_unbalanced_share();

    /** Of the material's points at their last answers, which tell how far they were from rest [-]; NaN where none does.
     */
    double compute_largest_unbalanced_ratio() const;

    /** Tangents that were factorised because an iterative solver failed on several ranks. */
    unsigned int count_rescued_tangents() const { return linear_solver_.count_rescues(); }

    /** Forces and displacements of the named boundaries and interfaces at the last equilibrium. */
    std::vector<BoundaryResponse> compute_boundary_responses() const;

    /** Largest strain and stress change of the ground's points since the last commit; no fractures. */
    StepEffects compute_step_effects() const;

    /** The Gauss point nearest to an initial position, as committed. */
    PointState compute_nearest_point_state(const dealii::Point<3> &position) const;

    /** Committed states of this rank's Gauss points, cell by cell. */
    std::vector<PointState> compute_point_states() const;

    /** Committed states of this rank's Gauss points in the ground's cells beside an interface, cell by cell; none where
     *  the mesh has no interface of that name. */
    std::vector<InterfacePoint> compute_interface_points(const std::string &interface) const;

    /** What a checkpoint must hold of this rank's part beside the material: see checkpoint.h. */
    struct State
    {
      std::vector<double> displacement; ///< committed, owned entries [m]
      std::vector<double> deformation;  ///< total F, nine a point, row by row [-]
      std::vector<double> stress;       ///< six a point in deal.II's order [Pa]
      std::vector<double> secants;      ///< step and change of each carried pair, owned entries
      std::vector<double> values;       ///< of the conditions at the last commit
      std::vector<double> carried;      ///< forces of the present phase, owned entries [N]; empty: none
      std::vector<double> offsets;      ///< of displacements that a stage holds, owned entries [m]; empty: none
    };
    State get_state() const;
    void set_state(const State &state);
    std::vector<double> compute_fingerprint() const; ///< dim, degree, cells, unknowns, volume and centre of the mesh

    const std::vector<BoundaryCondition> &get_conditions() const { return boundary_->get_conditions(); }
    const std::vector<double> &get_values() const { return committed_values_; } ///< of the conditions, as committed
    const dealii::DoFHandler<dim> &get_dof_handler() const { return dof_handler_; }
    const dealii::Mapping<dim> &get_mapping() const { return *mapping_; }
    const Vector &get_displacement() const { return ghosted_; } ///< total, trial, ghosted [m]
    ConstitutiveModel &get_material() const { return material_; }
    const NewtonParameters &get_newton_parameters() const { return newton_.get_parameters(); }

    /** @param tolerance  in (0, 1) @param max_evaluations  >= 1 */
    void set_newton_effort(double tolerance, unsigned int max_evaluations)
    {
      newton_.set_effort(tolerance, max_evaluations);
    }
    MPI_Comm get_communicator() const { return mesh_.triangulation->get_communicator(); }
    unsigned int get_n_points_per_cell() const { return assembly_->get_n_points_per_cell(); }
    Geometry get_geometry() const { return parameters_.geometry; }

  private:
    Status linearise(bool refresh_tangent, Vector &residual) override;
    Status evaluate(const Vector &increment, Vector &residual) override;
    void solve_linearised(const Vector &residual, Vector &solution) override;
    void impose_boundary(Vector &increment) const override;
    double compute_condensed_norm(const Vector &residual) override;
    double compute_norm(const Vector &residual) const override;
    double compute_force_scale() const override { return force_scale_; }
    Vector create_vector() const override { return Vector(owned_, get_communicator()); }

    void number_unknowns();
    void allocate();
    void introduce_points(const StressField &initial_stress);
    Status ask_material(const Vector &increment, bool with_tangent);
    void average_dilatation(const std::vector<dealii::Tensor<2, 3>> &gradients);
    Status reduce_status(bool with_tangent) const;
    void compute_residual(const Vector &increment, Vector &residual);
    Vector condense(const Vector &residual) const;
    PointState compute_point_state(std::size_t index) const;
    dealii::Tensor<2, 3> average_deformation(const std::vector<dealii::Tensor<2, 3>> &deformations,
                                             std::size_t index) const; // as the point's material is given it
    dealii::SymmetricTensor<2, 3> compute_strain(const dealii::Tensor<2, 3> &deformation) const;
    void set_followers_to_zero(Vector &vector) const;
    void enter_pile();
    std::vector<dealii::types::global_dof_index> list_unfree_dofs() const;

    ProblemParameters parameters_;
    ConstitutiveModel &material_;
    Mesh<dim> mesh_;
    dealii::FESystem<dim> element_;
    std::unique_ptr<dealii::MappingQ<dim>> mapping_;
    dealii::DoFHandler<dim> dof_handler_;
    dealii::IndexSet owned_, relevant_;
    std::unique_ptr<Assembly<dim>> assembly_;
    std::unique_ptr<BoundaryConditions<dim>> boundary_;
    std::unique_ptr<InterfaceForces<dim>> interface_forces_;

    NewtonSolver newton_;
    LinearSolver linear_solver_;
    Matrix stiffness_;   ///< of all unknowns: K_fc carries missing boundary displacements
    Matrix constrained_; ///< with prescribed unknowns eliminated: what is factorised

    Vector committed_, baseline_, trial_; ///< total displacements [m], owned entries
    Vector ghosted_;                      ///< trial, with the entries that this rank's cells need
    Vector reactions_;                    ///< internal minus external forces [N]
    Vector external_;                     ///< forces of tractions, pressures, weight and carried ones [N]
    Vector weight_;                       ///< of the cells that are present [N]
    Vector carried_;                      ///< that keep the present phase's beginning in equilibrium [N]
    Vector offsets_;                      ///< from which the values of displacements count [m]
    bool has_phases_ = false;             ///< carried_ or offsets_ may be other than zero
    double carried_share_ = 0.;
    Phase phase_;
    std::vector<std::vector<bool>> constant_modes_; ///< rigid translations, for the multigrid
    std::vector<double> values_, committed_values_;
    double force_scale_ = 0.;

    std::vector<PointRequest> requests_;
    std::vector<PointResponse> responses_;
    std::vector<dealii::Point<3>> positions_;
    std::vector<dealii::Tensor<2, 3>> deformations_, baseline_deformations_, committed_deformations_; ///< total F
    std::vector<dealii::SymmetricTensor<2, 3>> committed_stresses_;
    std::vector<dealii::types::material_id> regions_; ///< of the points
  };
} // namespace fem
