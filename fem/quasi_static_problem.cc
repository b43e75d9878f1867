#include "fem/quasi_static_problem.h"

#include "fem/serendipity.h"

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe_q.h>
#include <deal.II/lac/dynamic_sparsity_pattern.h>
#include <deal.II/lac/sparsity_tools.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace fem
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    const Tensor<2, 3> identity(dealii::unit_symmetric_tensor<3>());

    void check_parameters(const ProblemParameters &parameters)
    {
      if (parameters.degree < 1 || parameters.degree > 2)
        throw std::invalid_argument(fmt::format("problem: degree = {} must be 1 or 2", parameters.degree));
      const bool is_serendipity = parameters.element == ElementKind::serendipity;
      if (is_serendipity && parameters.degree != 2)
        throw std::invalid_argument(
            fmt::format("problem: degree = {} must be 2 for a serendipity element", parameters.degree));
      // Fewer points leave the Lagrange element modes without strain that its neighbours share.
      const unsigned int fewest = is_serendipity ? 2 : parameters.degree + 1;
      if (parameters.n_gauss_points != 0 &&
          (parameters.n_gauss_points < fewest || parameters.n_gauss_points > parameters.degree + 1))
        throw std::invalid_argument(
            fmt::format("problem: Gauss points = {} must be 0 or from {} to {} for this element",
                        parameters.n_gauss_points, fewest, parameters.degree + 1));
      if (!(parameters.newton.tolerance > 0. && parameters.newton.tolerance < 1.))
        throw std::invalid_argument(
            fmt::format("problem: Newton tolerance = {} must lie in (0, 1)", parameters.newton.tolerance));
      if (!(parameters.unit_weight >= 0.))
        throw std::invalid_argument(fmt::format("problem: unit weight = {} must be >= 0", parameters.unit_weight));
    }

    template <int dim>
    std::unique_ptr<dealii::FiniteElement<dim>> make_element(const ProblemParameters &parameters)
    {
      check_parameters(parameters);
      if (parameters.element == ElementKind::serendipity)
        return std::make_unique<SerendipityElement<dim>>();
      return std::make_unique<dealii::FE_Q<dim>>(parameters.degree);
    }
  } // namespace

  template <int dim>
  QuasiStaticProblem<dim>::QuasiStaticProblem(Mesh<dim> mesh, const std::vector<BoundaryCondition> &conditions,
                                              const ProblemParameters &parameters, ConstitutiveModel &material,
                                              const StressField &initial_stress)
      : parameters_(parameters), material_(material), mesh_(std::move(mesh)),
        element_(*make_element<dim>(parameters), dim),
        mapping_(std::make_unique<dealii::MappingQ<dim>>(parameters.degree)), dof_handler_(*mesh_.triangulation),
        newton_(parameters.newton), linear_solver_(parameters.linear_solver)
  {
    number_unknowns();
    assembly_ = std::make_unique<Assembly<dim>>(
        dof_handler_, *mapping_, parameters_.geometry, parameters_.kinematics,
        parameters_.n_gauss_points > 0 ? parameters_.n_gauss_points : parameters_.degree + 1, parameters_.dilatation);
    boundary_ =
        std::make_unique<BoundaryConditions<dim>>(dof_handler_, *mapping_, parameters_.geometry,
                                                  BoundaryNames{mesh_.boundary_ids, mesh_.interface_ids}, conditions);
    interface_forces_ =
        std::make_unique<InterfaceForces<dim>>(dof_handler_, mesh_.interface_ids, parameters_.pile_regions);
    allocate();
    set_phase({boundary_->get_held(), parameters_.is_pile_absent});
    introduce_points(initial_stress);
    for (const BoundaryCondition &condition : boundary_->get_conditions())
      values_.push_back(condition.initial_value);
    committed_values_ = values_;
  }

  template <int dim>
  void QuasiStaticProblem<dim>::number_unknowns()
  {
    dof_handler_.distribute_dofs(element_);
    owned_ = dof_handler_.locally_owned_dofs();
    dealii::DoFTools::extract_locally_relevant_dofs(dof_handler_, relevant_);
  }

  template <int dim>
  void QuasiStaticProblem<dim>::allocate()
  {
    for (Vector *vector : {&committed_, &baseline_, &trial_, &reactions_, &external_, &weight_, &carried_, &offsets_})
      vector->reinit(owned_, get_communicator());
    ghosted_.reinit(owned_, relevant_, get_communicator());

    dealii::DynamicSparsityPattern pattern(relevant_);
    dealii::DoFTools::make_sparsity_pattern(dof_handler_, pattern);
    dealii::SparsityTools::distribute_sparsity_pattern(pattern, owned_, get_communicator(), relevant_);
    stiffness_.reinit(owned_, owned_, pattern, get_communicator());
    constrained_.reinit(owned_, owned_, pattern, get_communicator());
    dealii::DoFTools::extract_constant_modes(dof_handler_, dealii::ComponentMask(), constant_modes_);
  }

  template <int dim>
  void QuasiStaticProblem<dim>::introduce_points(const StressField &initial_stress)
  {
    std::vector<PointSite> sites = assembly_->compute_sites();
    for (PointSite &site : sites)
      {
        if (initial_stress && !assembly_->is_absent(site.region))
          site.initial_stress = initial_stress(site.position);
        requests_.push_back({site.id, identity});
        positions_.push_back(site.position);
        regions_.push_back(site.region);
        committed_stresses_.push_back(site.initial_stress);
      }
    responses_.resize(sites.size());
    deformations_.assign(sites.size(), identity);
    baseline_deformations_ = committed_deformations_ = deformations_;
    material_.initialise(sites);
  }

  template <int dim>
  NewtonResult QuasiStaticProblem<dim>::equilibrate(const std::vector<double> &values, bool is_step_start)
  {
    values_ = values;
    Vector increment = create_vector();
    return newton_.solve(*this, increment, is_step_start);
  }

  template <int dim>
  void QuasiStaticProblem<dim>::move_baseline()
  {
    baseline_ = trial_;
    baseline_deformations_ = deformations_;
  }

  template <int dim>
  void QuasiStaticProblem<dim>::commit()
  {
    committed_ = baseline_;
    committed_values_ = values_;
    committed_deformations_ = baseline_deformations_;
    for (std::size_t i = 0; i < responses_.size(); ++i)
      committed_stresses_[i] = responses_[i].stress;
    newton_.commit();
  }

  template <int dim>
  void QuasiStaticProblem<dim>::revert()
  {
    baseline_ = trial_ = committed_;
    ghosted_ = committed_;
    baseline_deformations_ = deformations_ = committed_deformations_;
    values_ = committed_values_;
    newton_.revert();
  }

  template <int dim>
  Status QuasiStaticProblem<dim>::linearise(bool refresh_tangent, Vector &residual)
  {
    const Status status = ask_material(create_vector(), refresh_tangent);
    if (status != Status::ok)
      return status;
    if (refresh_tangent)
      {
        assembly_->assemble_stiffness(deformations_, responses_, boundary_->get_constraints(), stiffness_,
                                      constrained_);
        linear_solver_.initialise(constrained_, constant_modes_, parameters_.degree);
      }
    compute_residual(create_vector(), residual);
    return Status::ok;
  }

  template <int dim>
  Status QuasiStaticProblem<dim>::evaluate(const Vector &increment, Vector &residual)
  {
    const Status status = ask_material(increment, false);
    if (status == Status::ok)
      compute_residual(increment, residual);
    return status;
  }

  // dF = I + grad(du) F_baseline^-1, so that no increment gives I to the last bit.
  template <int dim>
  Status QuasiStaticProblem<dim>::ask_material(const Vector &increment, bool with_tangent)
  {
    trial_ = baseline_;
    trial_ += increment;
    ghosted_ = increment;
    const bool is_finite = parameters_.kinematics == Kinematics::finite;
    const auto gradients = assembly_->compute_gradients(ghosted_);
    ghosted_ = trial_;
    bool is_inverted = false;
    for (std::size_t i = 0; i < requests_.size(); ++i)
      {
        deformations_[i] = baseline_deformations_[i] + gradients[i];
        requests_[i].deformation_increment =
            identity + (is_finite ? gradients[i] * dealii::invert(baseline_deformations_[i]) : gradients[i]);
        is_inverted |= is_finite && !(dealii::determinant(requests_[i].deformation_increment) > 0.);
      }
    if (parameters_.dilatation == Dilatation::cell_mean && !is_inverted)
      average_dilatation(gradients);
    if (dealii::Utilities::MPI::max(is_inverted ? 1 : 0, get_communicator()) > 0)
      return Status::step_too_large;
    material_.evaluate(requests_, responses_, with_tangent);
    return reduce_status(with_tangent);
  }

  template <int dim>
  void QuasiStaticProblem<dim>::average_dilatation(const std::vector<Tensor<2, 3>> &gradients)
  {
    for (std::size_t i = 0; i < requests_.size(); ++i)
      if (parameters_.kinematics == Kinematics::finite)
        requests_[i].deformation_increment *= assembly_->compute_dilatation_factor(deformations_, i) /
                                              assembly_->compute_dilatation_factor(baseline_deformations_, i);
      else
        requests_[i].deformation_increment += assembly_->compute_dilatation_shift(gradients, i) * identity;
  }

  // The worst answer over all points and ranks; a stress or tangent that is no number counts as failed.
  template <int dim>
  Status QuasiStaticProblem<dim>::reduce_status(bool with_tangent) const
  {
    int worst = static_cast<int>(Status::ok);
    for (const PointResponse &response : responses_)
      {
        worst = std::max(worst, static_cast<int>(response.status));
        if (response.status == Status::ok &&
            !(std::isfinite(response.stress.norm()) && (!with_tangent || std::isfinite(response.tangent.norm()))))
          worst = static_cast<int>(Status::failed);
      }
    return static_cast<Status>(dealii::Utilities::MPI::max(worst, get_communicator()));
  }

  template <int dim>
  double QuasiStaticProblem<dim>::compute_largest_unbalanced_ratio() const
  {
    double largest = -1.;
    for (const PointResponse &response : responses_)
      largest = std::max(largest, std::isnan(response.unbalanced_ratio) ? -1. : response.unbalanced_ratio);
    largest = dealii::Utilities::MPI::max(largest, get_communicator());
    return largest < 0. ? std::numeric_limits<double>::quiet_NaN() : largest;
  }

  template <int dim>
  void QuasiStaticProblem<dim>::compute_residual(const Vector &increment, Vector &residual)
  {
    const bool is_finite = parameters_.kinematics == Kinematics::finite;
    assembly_->assemble_forces(deformations_, responses_, reactions_);
    boundary_->assemble_external_forces(values_, is_finite ? &ghosted_ : nullptr, external_);

    if (parameters_.unit_weight > 0.)
      external_ += weight_;
    if (carried_share_ != 0.)
      external_.add(carried_share_, carried_);
    set_followers_to_zero(external_); // nothing loads what is absent

    Vector support = reactions_; // internal forces on prescribed unknowns
    boundary_->set_free_to_zero(support);
    set_followers_to_zero(support);
    force_scale_ = support.l2_norm() + external_.l2_norm();

    reactions_ -= external_;
    residual = reactions_;
    set_followers_to_zero(reactions_);
    Vector wanted = increment;
    impose_boundary(wanted);
    for (const auto dof : boundary_->get_prescribed_dofs())
      residual(dof) = increment(dof) - wanted(dof);
    residual.compress(dealii::VectorOperation::insert);
  }

  template <int dim>
  void QuasiStaticProblem<dim>::impose_boundary(Vector &increment) const
  {
    Vector target = baseline_;
    boundary_->set_prescribed(values_, target);
    if (has_phases_)
      for (const auto dof : boundary_->get_prescribed_dofs())
        target(dof) = static_cast<double>(target(dof)) + static_cast<double>(offsets_(dof));
    target.compress(dealii::VectorOperation::insert);
    for (const auto dof : boundary_->get_prescribed_dofs())
      increment(dof) = target(dof) - baseline_(dof);
    increment.compress(dealii::VectorOperation::insert);
  }

  // Free residual once the missing boundary displacement -r_c is made: r_f - K_fc r_c; prescribed entries zero.
  template <int dim>
  Vector QuasiStaticProblem<dim>::condense(const Vector &residual) const
  {
    Vector missing = residual;
    boundary_->set_free_to_zero(missing);
    Vector condensed = create_vector();
    stiffness_.vmult(condensed, missing);
    condensed.sadd(-1., 1., residual);
    for (const auto dof : boundary_->get_prescribed_dofs())
      condensed(dof) = 0.;
    condensed.compress(dealii::VectorOperation::insert);
    return condensed;
  }

  template <int dim>
  void QuasiStaticProblem<dim>::solve_linearised(const Vector &residual, Vector &solution)
  {
    linear_solver_.solve(solution, condense(residual));
    for (const auto dof : boundary_->get_prescribed_dofs())
      solution(dof) = residual(dof);
    solution.compress(dealii::VectorOperation::insert);
  }

  template <int dim>
  double QuasiStaticProblem<dim>::compute_condensed_norm(const Vector &residual)
  {
    return condense(residual).l2_norm();
  }

  template <int dim>
  double QuasiStaticProblem<dim>::compute_norm(const Vector &residual) const
  {
    Vector missing = residual, free = residual;
    boundary_->set_free_to_zero(missing);
    free -= missing;
    return missing.linfty_norm() == 0. ? free.l2_norm() : std::numeric_limits<double>::infinity();
  }

  template class QuasiStaticProblem<2>;
  template class QuasiStaticProblem<3>;
} // namespace fem
