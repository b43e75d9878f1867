#include "fem/quasi_static_problem.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

#include <algorithm>
#include <limits>
#include <stdexcept>

// What a problem tells about its committed state, to observers and to checkpoints.
namespace fem
{
  using dealii::SymmetricTensor;

  namespace
  {
    void append_owned(const Vector &vector, std::vector<double> &values)
    {
      values.insert(values.end(), vector.begin(), vector.end());
    }

    Vector take_owned(const Vector &shape, const std::vector<double> &values, std::size_t offset)
    {
      Vector vector(shape);
      std::copy_n(values.begin() + offset, vector.locally_owned_size(), vector.begin());
      return vector;
    }
  } // namespace

  template <int dim>
  std::vector<PointState> QuasiStaticProblem<dim>::compute_point_states() const
  {
    std::vector<PointState> states(requests_.size());
    for (std::size_t i = 0; i < states.size(); ++i)
      states[i] = compute_point_state(i);
    return states;
  }

  template <int dim>
  std::vector<InterfacePoint> QuasiStaticProblem<dim>::compute_interface_points(const std::string &interface) const
  {
    std::vector<InterfacePoint> points;
    const auto found = mesh_.interface_ids.find(interface);
    if (found == mesh_.interface_ids.end())
      return points;
    dealii::FEFaceValues<dim> middle(*mapping_, element_, dealii::QMidpoint<dim - 1>(),
                                     dealii::update_normal_vectors | dealii::update_quadrature_points);
    std::size_t first_point = 0;
    for (const auto &cell : dof_handler_.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        if (!parameters_.pile_regions.contains(cell->material_id()))
          for (const unsigned int f : cell->face_indices())
            if (!cell->face(f)->at_boundary() && cell->face(f)->manifold_id() == found->second)
              {
                middle.reinit(cell, f);
                const dealii::Tensor<1, 3> normal = -embed<dim>(middle.normal_vector(0));
                const dealii::Tensor<1, 3> centre = embed<dim>(middle.quadrature_point(0));
                for (std::size_t i = first_point; i < first_point + get_n_points_per_cell(); ++i)
                  points.push_back({compute_point_state(i), normal, (positions_[i] - centre) * normal});
              }
        first_point += get_n_points_per_cell();
      }
    return points;
  }

  template <int dim>
  PointState QuasiStaticProblem<dim>::compute_point_state(std::size_t index) const
  {
    PointState state;
    state.id = requests_[index].id;
    state.position = positions_[index];
    state.deformation = average_deformation(committed_deformations_, index);
    state.stress = committed_stresses_[index];
    state.strain = compute_strain(state.deformation);
    return state;
  }

  template <int dim>
  dealii::Tensor<2, 3>
  QuasiStaticProblem<dim>::average_deformation(const std::vector<dealii::Tensor<2, 3>> &deformations,
                                               std::size_t index) const
  {
    if (parameters_.kinematics == Kinematics::finite)
      return assembly_->compute_dilatation_factor(deformations, index) * deformations[index];
    return deformations[index] + assembly_->compute_dilatation_shift(deformations, index) *
                                     dealii::Tensor<2, 3>(dealii::unit_symmetric_tensor<3>());
  }

  template <int dim>
  StepEffects QuasiStaticProblem<dim>::compute_step_effects() const
  {
    const MPI_Comm communicator = get_communicator();
    const auto is_ground = [&](const std::size_t i) { return !parameters_.pile_regions.contains(regions_[i]); };
    double sum = 0., n_points = 0.;
    for (std::size_t i = 0; i < requests_.size(); ++i)
      if (is_ground(i))
        {
          sum += committed_stresses_[i].norm();
          n_points += 1.;
        }
    const double mean = dealii::Utilities::MPI::sum(sum, communicator) /
                        std::max(1., dealii::Utilities::MPI::sum(n_points, communicator));
    StepEffects effects;
    for (std::size_t i = 0; i < requests_.size(); ++i)
      if (is_ground(i))
        {
          const auto strain = compute_strain(average_deformation(baseline_deformations_, i)) -
                              compute_strain(average_deformation(committed_deformations_, i));
          const double change = (responses_[i].stress - committed_stresses_[i]).norm();
          const double scale = std::max(mean, committed_stresses_[i].norm());
          effects.strain = std::max(effects.strain, strain.norm());
          effects.stress_change = std::max(effects.stress_change, scale > 0. ? change / scale : 0.);
        }
    effects.strain = dealii::Utilities::MPI::max(effects.strain, communicator);
    effects.stress_change = dealii::Utilities::MPI::max(effects.stress_change, communicator);
    return effects;
  }

  template <int dim>
  SymmetricTensor<2, 3> QuasiStaticProblem<dim>::compute_strain(const dealii::Tensor<2, 3> &deformation) const
  {
    return parameters_.kinematics == Kinematics::finite
               ? compute_log_strain(deformation)
               : dealii::symmetrize(deformation) - dealii::unit_symmetric_tensor<3>();
  }

  template <int dim>
  PointState QuasiStaticProblem<dim>::compute_nearest_point_state(const dealii::Point<3> &position) const
  {
    double distance = std::numeric_limits<double>::max();
    std::size_t nearest = 0;
    for (std::size_t i = 0; i < positions_.size(); ++i)
      if (positions_[i].distance(position) < distance)
        {
          distance = positions_[i].distance(position);
          nearest = i;
        }
    const MPI_Comm communicator = get_communicator();
    const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(communicator);
    const bool is_here = distance == dealii::Utilities::MPI::min(distance, communicator) && !positions_.empty();
    const unsigned int owner =
        dealii::Utilities::MPI::min(is_here ? rank : dealii::numbers::invalid_unsigned_int, communicator);
    PointState state;
    if (owner == rank)
      state = compute_point_state(nearest);
    state.id = dealii::Utilities::MPI::broadcast(communicator, state.id, owner);
    state.position = dealii::Utilities::MPI::broadcast(communicator, state.position, owner);
    state.deformation = dealii::Utilities::MPI::broadcast(communicator, state.deformation, owner);
    state.stress = dealii::Utilities::MPI::broadcast(communicator, state.stress, owner);
    state.strain = dealii::Utilities::MPI::broadcast(communicator, state.strain, owner);
    return state;
  }

  template <int dim>
  std::vector<BoundaryResponse> QuasiStaticProblem<dim>::compute_boundary_responses() const
  {
    const Vector *current = parameters_.kinematics == Kinematics::finite ? &ghosted_ : nullptr;
    auto responses = boundary_->compute_responses(values_, reactions_, ghosted_, current != nullptr);
    using Visit = typename Assembly<dim>::VisitForces;
    const auto internal = [&](const Visit &visit) { assembly_->for_each_force(deformations_, responses_, visit); };
    const auto loads = [&](const Visit &visit) {
      if (parameters_.unit_weight > 0.)
        assembly_->for_each_weight(parameters_.unit_weight, visit);
      boundary_->for_each_external_force(values_, current, visit);
    };
    for (const auto &[name, force] : interface_forces_->compute(internal, loads))
      for (BoundaryResponse &response : responses)
        if (response.name == name)
          response.force = force;
    return responses;
  }

  template <int dim>
  std::vector<double> QuasiStaticProblem<dim>::compute_fingerprint() const
  {
    const auto [volume, moment] = assembly_->compute_volume();
    std::vector<double> fingerprint = {double(dim), double(parameters_.degree),
                                       double(mesh_.triangulation->n_global_active_cells()),
                                       double(dof_handler_.n_dofs()), volume};
    for (unsigned int d = 0; d < 3; ++d)
      fingerprint.push_back(moment[d]);
    return fingerprint;
  }

  template <int dim>
  typename QuasiStaticProblem<dim>::State QuasiStaticProblem<dim>::get_state() const
  {
    State state;
    append_owned(committed_, state.displacement);
    for (const auto &stress : committed_stresses_)
      for (unsigned int i = 0; i < SymmetricTensor<2, 3>::n_independent_components; ++i)
        state.stress.push_back(stress.access_raw_entry(i));
    for (const auto &deformation : committed_deformations_)
      for (unsigned int i = 0; i < 9; ++i)
        state.deformation.push_back(deformation[i / 3][i % 3]);
    for (const SecantPair &pair : newton_.get_memory())
      {
        append_owned(pair.step, state.secants);
        append_owned(pair.change, state.secants);
      }
    state.values = committed_values_;
    if (has_phases_)
      {
        append_owned(carried_, state.carried);
        append_owned(offsets_, state.offsets);
      }
    return state;
  }

  template <int dim>
  void QuasiStaticProblem<dim>::set_state(const State &state)
  {
    committed_ = take_owned(create_vector(), state.displacement, 0);
    for (std::size_t p = 0; p < committed_stresses_.size(); ++p)
      {
        for (unsigned int i = 0; i < 6; ++i)
          committed_stresses_[p].access_raw_entry(i) = state.stress[6 * p + i];
        for (unsigned int i = 0; i < 9; ++i)
          committed_deformations_[p][i / 3][i % 3] = state.deformation[9 * p + i];
      }
    const std::size_t n_owned = owned_.n_elements();
    SecantHistory history;
    for (std::size_t offset = 0; offset < state.secants.size(); offset += 2 * n_owned)
      history.push_back({take_owned(create_vector(), state.secants, offset),
                         take_owned(create_vector(), state.secants, offset + n_owned)});
    newton_.set_memory(history);
    committed_values_ = state.values;
    has_phases_ = dealii::Utilities::MPI::max(state.carried.empty() ? 0 : 1, get_communicator()) > 0;
    carried_ = has_phases_ ? take_owned(create_vector(), state.carried, 0) : create_vector();
    offsets_ = has_phases_ ? take_owned(create_vector(), state.offsets, 0) : create_vector();
    revert();
  }

  template class QuasiStaticProblem<2>;
  template class QuasiStaticProblem<3>;
} // namespace fem
