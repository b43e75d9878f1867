#include "fem/assembly.h"

#include <deal.II/dofs/dof_tools.h>
#include <deal.II/fe/fe.h>
#include <deal.II/grid/cell_id.h>
#include <deal.II/grid/tria.h>

#include <cmath>
#include <numeric>

namespace fem
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    // Followers have equations of their own, scaled so that where absent cells lie never counts among forces: a pile is
    // some thousand times as stiff as ground, and the norm of the residual is one number.
    constexpr double follower_scale = 1e-8;

    /**
     * Change of the internal force density at a velocity gradient L [Pa]:
     *
     *   P = C : sym L + w s - s w + s tr L - s L^T,   w = skew L,
     *
     * so that the tangent of (integral of s : grad v dv) is the integral of grad v : P dv. The second and third terms
     * turn the stress, the fourth changes the volume, the last the gradients of v.
     */
    Tensor<2, 3> compute_finite_change(const SymmetricTensor<2, 3> &stress, const SymmetricTensor<4, 3> &tangent,
                                       const Tensor<2, 3> &velocity_gradient)
    {
      const Tensor<2, 3> full_stress(stress);
      const Tensor<2, 3> spin = 0.5 * (velocity_gradient - dealii::transpose(velocity_gradient));
      const Tensor<2, 3> answer(tangent * dealii::symmetrize(velocity_gradient));
      return answer + spin * full_stress - full_stress * spin + dealii::trace(velocity_gradient) * full_stress -
             full_stress * dealii::transpose(velocity_gradient);
    }
  } // namespace

  template <int dim>
  Assembly<dim>::Assembly(const dealii::DoFHandler<dim> &dof_handler, const dealii::Mapping<dim> &mapping,
                          Geometry geometry, Kinematics kinematics, const unsigned int n_gauss_points,
                          const Dilatation dilatation)
      : dof_handler_(dof_handler), geometry_(geometry), kinematics_(kinematics), dilatation_(dilatation),
        quadrature_(n_gauss_points), shapes_(dof_handler, mapping, quadrature_)
  {
    if (dilatation_ == Dilatation::cell_mean)
      for_each_cell([&](const Cell &, const std::size_t first_point) {
        for (std::size_t p = first_point; p < first_point + quadrature_.size(); ++p)
          initial_volumes_.push_back(compute_initial_volume(p));
      });
  }

  template <int dim>
  template <class Work>
  void Assembly<dim>::for_each_cell(const Work &work) const
  {
    std::size_t first_point = 0;
    for (const auto &cell : dof_handler_.active_cell_iterators())
      if (cell->is_locally_owned())
        {
          work(cell, first_point);
          first_point += quadrature_.size();
        }
  }

  template <int dim>
  Tensor<2, 3> Assembly<dim>::compute_initial_gradient(const std::size_t point, const unsigned int unknown) const
  {
    return embed_gradient<dim>(geometry_, shapes_.get_component(unknown), shapes_.get_value(point, unknown),
                               shapes_.get_gradient(point, unknown), shapes_.get_position(point)[0]);
  }

  template <int dim>
  void Assembly<dim>::compute_shape_gradients(const std::size_t point, const Tensor<2, 3> &deformation,
                                              std::vector<Tensor<2, 3>> &gradients) const
  {
    const bool is_finite = kinematics_ == Kinematics::finite;
    const Tensor<2, 3> pull = is_finite ? dealii::invert(deformation) : Tensor<2, 3>();
    gradients.resize(dof_handler_.get_fe().n_dofs_per_cell());
    for (unsigned int i = 0; i < gradients.size(); ++i)
      {
        gradients[i] = compute_initial_gradient(point, i);
        if (is_finite)
          gradients[i] = gradients[i] * pull;
      }
  }

  template <int dim>
  double Assembly<dim>::compute_initial_volume(const std::size_t point) const
  {
    return shapes_.get_measure(point) * compute_depth(geometry_, shapes_.get_position(point)[0]);
  }

  template <int dim>
  double Assembly<dim>::compute_volume_element(const std::size_t point, const Tensor<2, 3> &deformation) const
  {
    const double initial = compute_initial_volume(point);
    return kinematics_ == Kinematics::finite ? initial * dealii::determinant(deformation) : initial;
  }

  template <int dim>
  template <class Get>
  double Assembly<dim>::compute_cell_mean(std::size_t first_point, const Get &get) const
  {
    double sum = 0., volume = 0.;
    for (std::size_t p = first_point; p < first_point + quadrature_.size(); ++p)
      {
        sum += initial_volumes_[p] * get(p);
        volume += initial_volumes_[p];
      }
    return sum / volume;
  }

  template <int dim>
  double Assembly<dim>::compute_dilatation_factor(const std::vector<Tensor<2, 3>> &deformations,
                                                  std::size_t point) const
  {
    if (dilatation_ == Dilatation::point)
      return 1.;
    const double mean = compute_cell_mean(point - point % quadrature_.size(),
                                          [&](std::size_t p) { return dealii::determinant(deformations[p]); });
    return std::cbrt(mean / dealii::determinant(deformations[point]));
  }

  template <int dim>
  double Assembly<dim>::compute_dilatation_shift(const std::vector<Tensor<2, 3>> &gradients, std::size_t point) const
  {
    if (dilatation_ == Dilatation::point)
      return 0.;
    const double mean = compute_cell_mean(point - point % quadrature_.size(),
                                          [&](std::size_t p) { return dealii::trace(gradients[p]); });
    return (mean - dealii::trace(gradients[point])) / 3.;
  }

  // Mean dilatation (J. C. Nagtegaal, D. M. Parks and J. R. Rice 1974): the material is given F (J mean / J)^(1/3), J
  // mean the cell's volume over its initial one. The virtual work of its stress is then that of grad v whose trace is
  // the cell's mean of div v, over volumes J mean dV.
  template <int dim>
  void Assembly<dim>::average_dilatation(CellShapes &shapes) const
  {
    const Tensor<2, 3> identity(dealii::unit_symmetric_tensor<3>());
    const double volume = std::accumulate(shapes.volumes.begin(), shapes.volumes.end(), 0.);
    for (std::size_t i = 0; i < shapes.gradients[0].size(); ++i)
      {
        double mean = 0.;
        for (std::size_t q = 0; q < shapes.volumes.size(); ++q)
          mean += shapes.volumes[q] * dealii::trace(shapes.gradients[q][i]) / volume;
        for (auto &at_point : shapes.gradients)
          at_point[i] += (mean - dealii::trace(at_point[i])) / 3. * identity;
      }
  }

  template <int dim>
  void Assembly<dim>::compute_cell_shapes(const std::size_t first_point, const std::vector<Tensor<2, 3>> &deformations,
                                          CellShapes &shapes) const
  {
    shapes.gradients.resize(quadrature_.size());
    shapes.volumes.resize(quadrature_.size());
    for (unsigned int q = 0; q < quadrature_.size(); ++q)
      {
        shapes.volumes[q] = compute_volume_element(first_point + q, deformations[first_point + q]);
        compute_shape_gradients(first_point + q, deformations[first_point + q], shapes.gradients[q]);
      }
    if (dilatation_ == Dilatation::point)
      return;
    average_dilatation(shapes);
    const double volume = std::accumulate(shapes.volumes.begin(), shapes.volumes.end(), 0.);
    const auto initial = initial_volumes_.begin() + static_cast<std::ptrdiff_t>(first_point);
    const double initial_volume = std::accumulate(initial, initial + quadrature_.size(), 0.);
    for (std::size_t q = 0; q < quadrature_.size(); ++q)
      shapes.volumes[q] = volume / initial_volume * initial[static_cast<std::ptrdiff_t>(q)];
  }

  // The mesh library numbers cells rank by rank. By what the file lists and halvings make of it a cell has one number,
  // whoever owns it: what is drawn for its points then does not depend on the partition.
  template <int dim>
  unsigned int Assembly<dim>::compute_cell_number(const Cell &cell) const
  {
    Assert(cell->level() + 1 == static_cast<int>(dof_handler_.get_triangulation().n_global_levels()),
           dealii::ExcMessage("cells of several levels would share numbers"));
    const dealii::CellId id = cell->id();
    auto number = static_cast<unsigned int>(id.get_coarse_cell_id());
    for (const unsigned int child : id.get_child_indices())
      number = number * dealii::GeometryInfo<dim>::max_children_per_cell + child;
    return number;
  }

  template <int dim>
  std::vector<PointSite> Assembly<dim>::compute_sites() const
  {
    std::vector<PointSite> sites;
    for_each_cell([&](const Cell &cell, const std::size_t first_point) {
      for (unsigned int q = 0; q < quadrature_.size(); ++q)
        {
          PointSite site;
          site.id = compute_cell_number(cell) * quadrature_.size() + q;
          site.position = dealii::Point<3>(embed<dim>(shapes_.get_position(first_point + q)));
          site.region = cell->material_id();
          sites.push_back(site);
        }
    });
    return sites;
  }

  template <int dim>
  std::vector<Tensor<2, 3>> Assembly<dim>::compute_gradients(const Vector &ghosted) const
  {
    std::vector<Tensor<2, 3>> gradients;
    std::vector<dealii::types::global_dof_index> dofs(dof_handler_.get_fe().n_dofs_per_cell());
    std::vector<double> displacement(dofs.size());
    for_each_cell([&](const Cell &cell, const std::size_t first_point) {
      cell->get_dof_indices(dofs);
      ghosted.extract_subvector_to(dofs.begin(), dofs.end(), displacement.begin());
      for (std::size_t p = first_point; p < first_point + quadrature_.size(); ++p)
        {
          Tensor<2, 3> gradient;
          for (unsigned int i = 0; i < dofs.size(); ++i)
            gradient += displacement[i] * compute_initial_gradient(p, i);
          gradients.push_back(gradient);
        }
    });
    return gradients;
  }

  template <int dim>
  void Assembly<dim>::for_each_force(const std::vector<Tensor<2, 3>> &deformations,
                                     const std::vector<PointResponse> &responses, const VisitForces &visit) const
  {
    CellShapes shapes;
    std::vector<dealii::types::global_dof_index> dofs(dof_handler_.get_fe().n_dofs_per_cell());
    for_each_cell([&](const Cell &cell, const std::size_t first_point) {
      cell->get_dof_indices(dofs);
      compute_cell_shapes(first_point, deformations, shapes);
      std::vector<double> cell_forces(dofs.size(), 0.);
      for (unsigned int q = 0; q < quadrature_.size(); ++q)
        {
          const Tensor<2, 3> stress(responses[first_point + q].stress);
          for (unsigned int i = 0; i < dofs.size(); ++i)
            cell_forces[i] += shapes.volumes[q] * dealii::scalar_product(shapes.gradients[q][i], stress);
        }
      if (is_absent(cell->material_id()))
        for (unsigned int i = 0; i < dofs.size(); ++i)
          cell_forces[i] *= compute_row_share(dofs[i]);
      visit(cell, dofs, cell_forces);
    });
  }

  template <int dim>
  void Assembly<dim>::assemble_forces(const std::vector<Tensor<2, 3>> &deformations,
                                      const std::vector<PointResponse> &responses, Vector &forces) const
  {
    forces = 0.;
    for_each_force(deformations, responses,
                   [&](const Cell &, const auto &dofs, const auto &cell_forces) { forces.add(dofs, cell_forces); });
    forces.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  void Assembly<dim>::assemble_stiffness(const std::vector<Tensor<2, 3>> &deformations,
                                         const std::vector<PointResponse> &responses,
                                         const dealii::AffineConstraints<double> &constraints, Matrix &stiffness,
                                         Matrix &constrained) const
  {
    stiffness = 0.;
    constrained = 0.;
    const bool is_finite = kinematics_ == Kinematics::finite;
    const unsigned int n_dofs = dof_handler_.get_fe().n_dofs_per_cell();
    CellShapes shapes;
    std::vector<dealii::types::global_dof_index> dofs(n_dofs);
    dealii::FullMatrix<double> cell_matrix(n_dofs, n_dofs);
    for_each_cell([&](const Cell &cell, const std::size_t first_point) {
      cell->get_dof_indices(dofs);
      compute_cell_shapes(first_point, deformations, shapes);
      cell_matrix = 0.;
      for (unsigned int q = 0; q < quadrature_.size(); ++q)
        {
          const PointResponse &response = responses[first_point + q];
          const std::vector<Tensor<2, 3>> &gradients = shapes.gradients[q];
          for (unsigned int j = 0; j < n_dofs; ++j)
            {
              const Tensor<2, 3> change =
                  shapes.volumes[q] * (is_finite
                                           ? compute_finite_change(response.stress, response.tangent, gradients[j])
                                           : Tensor<2, 3>(response.tangent * dealii::symmetrize(gradients[j])));
              for (unsigned int i = 0; i < n_dofs; ++i)
                cell_matrix(i, j) += dealii::scalar_product(gradients[i], change);
            }
        }
      if (is_absent(cell->material_id()))
        for (unsigned int i = 0; i < n_dofs; ++i)
          for (unsigned int j = 0; j < n_dofs; ++j)
            cell_matrix(i, j) *= compute_row_share(dofs[i]);
      stiffness.add(dofs, cell_matrix);
      constraints.distribute_local_to_global(cell_matrix, dofs, constrained);
    });
    stiffness.compress(dealii::VectorOperation::add);
    constrained.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  void Assembly<dim>::set_absent(const std::set<dealii::types::material_id> &regions)
  {
    absent_ = regions;
    followers_.clear();
    if (regions.empty())
      return;
    // Counted over all ranks: a neighbour's cell may keep an unknown of this one's absent cell in the problem.
    const dealii::IndexSet &owned = dof_handler_.locally_owned_dofs();
    dealii::IndexSet relevant;
    dealii::DoFTools::extract_locally_relevant_dofs(dof_handler_, relevant);
    Vector n_present(owned, dof_handler_.get_communicator());
    std::vector<dealii::types::global_dof_index> dofs(dof_handler_.get_fe().n_dofs_per_cell());
    for (const auto &cell : dof_handler_.active_cell_iterators())
      if (cell->is_locally_owned() && !is_absent(cell->material_id()))
        {
          cell->get_dof_indices(dofs);
          n_present.add(dofs, std::vector<double>(dofs.size(), 1.));
        }
    n_present.compress(dealii::VectorOperation::add);
    Vector known(owned, relevant, dof_handler_.get_communicator());
    known = n_present;
    followers_.assign(dof_handler_.n_dofs(), false);
    for (const auto dof : relevant)
      followers_[dof] = static_cast<double>(known(dof)) == 0.;
  }

  // An absent cell's rows: none for what it shares with present cells, so that it pulls at nothing; small ones for the
  // rest, which then solves for the motion that the shared unknowns impose.
  template <int dim>
  double Assembly<dim>::compute_row_share(dealii::types::global_dof_index dof) const
  {
    return is_follower(dof) ? follower_scale : 0.;
  }

  template <int dim>
  void Assembly<dim>::for_each_weight(double unit_weight, const VisitForces &visit) const
  {
    std::vector<dealii::types::global_dof_index> dofs(dof_handler_.get_fe().n_dofs_per_cell());
    for_each_cell([&](const Cell &cell, const std::size_t first_point) {
      if (is_absent(cell->material_id()))
        return;
      cell->get_dof_indices(dofs);
      std::vector<double> cell_forces(dofs.size(), 0.);
      for (std::size_t p = first_point; p < first_point + quadrature_.size(); ++p)
        for (unsigned int i = 0; i < dofs.size(); ++i)
          if (get_axis<dim>(shapes_.get_component(i)) == 2)
            cell_forces[i] -= unit_weight * shapes_.get_measure(p) *
                              compute_depth(geometry_, shapes_.get_position(p)[0]) * shapes_.get_value(p, i);
      visit(cell, dofs, cell_forces);
    });
  }

  template <int dim>
  void Assembly<dim>::assemble_weight(double unit_weight, Vector &forces) const
  {
    forces = 0.;
    for_each_weight(unit_weight,
                    [&](const Cell &, const auto &dofs, const auto &cell_forces) { forces.add(dofs, cell_forces); });
    forces.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  std::pair<double, Tensor<1, 3>> Assembly<dim>::compute_volume() const
  {
    double volume = 0.;
    Tensor<1, 3> moment;
    for_each_cell([&](const Cell &, const std::size_t first_point) {
      for (std::size_t p = first_point; p < first_point + quadrature_.size(); ++p)
        {
          const double part = compute_initial_volume(p);
          volume += part;
          moment += part * embed<dim>(shapes_.get_position(p));
        }
    });
    const MPI_Comm communicator = dof_handler_.get_communicator();
    return {dealii::Utilities::MPI::sum(volume, communicator), dealii::Utilities::MPI::sum(moment, communicator)};
  }

  template class Assembly<2>;
  template class Assembly<3>;
} // namespace fem
