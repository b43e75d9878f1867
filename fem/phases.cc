#include "fem/quasi_static_problem.h"

// How a problem goes from one phase to the next: piles that enter, displacements that are let go or begin to be held.
namespace fem
{
  using dealii::types::global_dof_index;

  template <int dim>
  void QuasiStaticProblem<dim>::set_phase(const Phase &phase)
  {
    if (phase == phase_)
      return;
    const bool is_first = phase_.is_held.empty();
    if (is_first || phase.is_pile_absent != phase_.is_pile_absent)
      {
        assembly_->set_absent(phase.is_pile_absent ? parameters_.pile_regions : decltype(parameters_.pile_regions)());
        if (parameters_.unit_weight > 0.)
          assembly_->assemble_weight(parameters_.unit_weight, weight_);
      }
    if (!is_first)
      boundary_->set_held(phase.is_held);
    phase_ = phase;
  }

  template <int dim>
  Status QuasiStaticProblem<dim>::begin_phase(const Phase &phase)
  {
    const Phase before = phase_;
    const std::vector<global_dof_index> prescribed = boundary_->get_prescribed_dofs();
    if (before.is_pile_absent && !phase.is_pile_absent)
      enter_pile();
    set_phase(phase);
    has_phases_ = true;
    newton_.set_memory({}); // its pairs count forces where now displacements are missing, or the other way round

    // What begins to be held goes on from where it is; what goes on being held keeps its offset.
    Vector unshifted = create_vector(), offsets = create_vector();
    boundary_->set_prescribed(committed_values_, unshifted);
    for (const global_dof_index dof : boundary_->get_prescribed_dofs())
      offsets(dof) = static_cast<double>(committed_(dof)) - static_cast<double>(unshifted(dof));
    for (const global_dof_index dof : prescribed)
      offsets(dof) = static_cast<double>(offsets_(dof));
    offsets.compress(dealii::VectorOperation::insert);
    offsets_ = offsets;

    carried_share_ = 0.;
    const Status status = ask_material(create_vector(), false);
    Vector residual = create_vector();
    compute_residual(create_vector(), residual);
    carried_ = residual; // also where ground was free: a pile that enters puts its weight on its shaft
    for (const global_dof_index dof : boundary_->get_prescribed_dofs())
      carried_(dof) = 0.;
    carried_.compress(dealii::VectorOperation::insert);
    set_followers_to_zero(carried_);
    carried_share_ = 1.;
    return status;
  }

  template <int dim>
  void QuasiStaticProblem<dim>::enter_pile()
  {
    std::vector<PointId> entering;
    for (std::size_t i = 0; i < requests_.size(); ++i)
      if (parameters_.pile_regions.contains(regions_[i]))
        {
          entering.push_back(requests_[i].id);
          committed_stresses_[i] = 0.;
        }
    material_.restart(entering);
  }

  template <int dim>
  double QuasiStaticProblem<dim>::compute_unbalanced_share()
  {
    if (!(parameters_.unit_weight > 0.) || ask_material(create_vector(), false) != Status::ok)
      return std::numeric_limits<double>::quiet_NaN();
    Vector residual = create_vector();
    compute_residual(create_vector(), residual);
    for (const global_dof_index dof : list_unfree_dofs())
      residual(dof) = 0.;
    residual.compress(dealii::VectorOperation::insert);
    return residual.l2_norm() / weight_.l2_norm();
  }

  /** Owned unknowns without an equation of forces: prescribed ones and followers. */
  template <int dim>
  std::vector<global_dof_index> QuasiStaticProblem<dim>::list_unfree_dofs() const
  {
    std::vector<global_dof_index> dofs = boundary_->get_prescribed_dofs();
    for (const global_dof_index dof : owned_)
      if (assembly_->is_follower(dof))
        dofs.push_back(dof);
    return dofs;
  }

  template <int dim>
  void QuasiStaticProblem<dim>::set_followers_to_zero(Vector &vector) const
  {
    if (!phase_.is_pile_absent)
      return;
    for (const global_dof_index dof : owned_)
      if (assembly_->is_follower(dof))
        vector(dof) = 0.;
    vector.compress(dealii::VectorOperation::insert);
  }

  template class QuasiStaticProblem<2>;
  template class QuasiStaticProblem<3>;
} // namespace fem
