#include "fem/interface_forces.h"

#include <algorithm>
#include <iterator>

namespace fem
{
  using dealii::Tensor;
  using dealii::types::global_dof_index;
  using dealii::types::manifold_id;

  template <int dim>
  std::set<global_dof_index> collect_interface_dofs(const dealii::DoFHandler<dim> &dof_handler, const manifold_id id,
                                                    const dealii::ComponentMask &components)
  {
    std::set<global_dof_index> dofs;
    std::vector<global_dof_index> on_face(dof_handler.get_fe().n_dofs_per_face());
    for (const auto &cell : dof_handler.active_cell_iterators())
      if (!cell->is_artificial())
        for (const auto &face : cell->face_iterators())
          if (!face->at_boundary() && face->manifold_id() == id)
            {
              face->get_dof_indices(on_face);
              for (std::size_t i = 0; i < on_face.size(); ++i)
                if (components[dof_handler.get_fe().face_system_to_component_index(i).first])
                  dofs.insert(on_face[i]);
            }
    return dofs;
  }

  template <int dim>
  InterfaceForces<dim>::InterfaceForces(const dealii::DoFHandler<dim> &dof_handler,
                                        const std::map<std::string, manifold_id> &interface_ids, const Regions &inner)
      : dof_handler_(dof_handler), interface_ids_(interface_ids), inner_(inner)
  {
    for (const auto &[name, id] : interface_ids_)
      for (const global_dof_index dof : collect_interface_dofs(dof_handler_, id))
        interfaces_of_dof_[dof].insert(id);
    level_ = find_level_interfaces();
  }

  template <int dim>
  std::set<manifold_id> InterfaceForces<dim>::find_level_interfaces() const
  {
    std::map<manifold_id, double> excess; // of widths over heights, summed up over the faces [m]
    for (const auto &[name, id] : interface_ids_)
      excess[id] = 0.;
    for (const auto &cell : dof_handler_.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const auto &face : cell->face_iterators())
          if (!face->at_boundary() && excess.contains(face->manifold_id()))
            {
              const auto [low, high] = face->bounding_box().get_boundary_points();
              const dealii::Tensor<1, dim> extent = high - low;
              double width = 0.;
              for (unsigned int c = 0; c + 1 < dim; ++c)
                width = std::max(width, extent[c]);
              excess[face->manifold_id()] += width - extent[dim - 1];
            }
    std::set<manifold_id> level;
    for (const auto &[name, id] : interface_ids_)
      if (dealii::Utilities::MPI::sum(excess[id], dof_handler_.get_communicator()) > 0.)
        level.insert(id);
    return level;
  }

  template <int dim>
  void InterfaceForces<dim>::share_out(const Cell &cell, const std::vector<global_dof_index> &dofs,
                                       const std::vector<double> &forces, const double factor, Forces &sums) const
  {
    std::set<manifold_id> own;
    for (const auto &face : cell->face_iterators())
      if (!face->at_boundary())
        own.insert(face->manifold_id());
    for (std::size_t i = 0; i < dofs.size(); ++i)
      {
        const auto found = interfaces_of_dof_.find(dofs[i]);
        if (found == interfaces_of_dof_.end())
          continue;
        std::vector<manifold_id> receivers;
        std::set_intersection(own.begin(), own.end(), found->second.begin(), found->second.end(),
                              std::back_inserter(receivers));
        if (receivers.empty())
          std::set_intersection(level_.begin(), level_.end(), found->second.begin(), found->second.end(),
                                std::back_inserter(receivers));
        if (receivers.empty())
          receivers.assign(found->second.begin(), found->second.end());
        const unsigned int component = dof_handler_.get_fe().system_to_component_index(i).first;
        for (const manifold_id id : receivers)
          sums[id][get_axis<dim>(component)] += factor * forces[i] / static_cast<double>(receivers.size());
      }
  }

  template <int dim>
  std::map<std::string, Tensor<1, 3>> InterfaceForces<dim>::compute(const ForEachForce &internal,
                                                                    const ForEachForce &loads) const
  {
    std::map<std::string, Tensor<1, 3>> named;
    if (interface_ids_.empty())
      return named;
    Forces sums;
    const auto make_visitor = [&](const double factor) {
      return [this, factor, &sums](const Cell &cell, const auto &dofs, const auto &forces) {
        if (!inner_.contains(cell->material_id()))
          share_out(cell, dofs, forces, factor, sums);
      };
    };
    internal(make_visitor(1.));
    loads(make_visitor(-1.));
    for (const auto &[name, id] : interface_ids_)
      named[name] = dealii::Utilities::MPI::sum(sums[id], dof_handler_.get_communicator());
    return named;
  }

  template class InterfaceForces<2>;
  template class InterfaceForces<3>;
  template std::set<global_dof_index> collect_interface_dofs(const dealii::DoFHandler<2> &, manifold_id,
                                                             const dealii::ComponentMask &);
  template std::set<global_dof_index> collect_interface_dofs(const dealii::DoFHandler<3> &, manifold_id,
                                                             const dealii::ComponentMask &);
} // namespace fem
