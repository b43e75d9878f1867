#include "fem/boundary_conditions.h"

#include "fem/interface_forces.h"
#include "fem/rigid_motions.h"

#include <deal.II/dofs/dof_tools.h>

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numeric>
#include <stdexcept>

namespace fem
{
  using dealii::Tensor;

  namespace
  {
    std::string join(const std::vector<std::string> &words)
    {
      std::string text;
      for (const std::string &word : words)
        text += (text.empty() ? "" : ", ") + word;
      return text;
    }

    template <int dim>
    Tensor<2, 3> compute_deformation(Geometry geometry, const FaceShapes<dim> &face,
                                     const typename FaceShapes<dim>::Point &point,
                                     const dealii::FiniteElement<dim> &element, const std::vector<double> &displacement)
    {
      Tensor<2, 3> deformation(dealii::unit_symmetric_tensor<3>());
      for (unsigned int i = 0; i < face.dofs.size(); ++i)
        deformation += displacement[i] * embed_gradient<dim>(geometry, element.system_to_component_index(i).first,
                                                             point.values[i], point.gradients[i], point.position[0]);
      return deformation;
    }

    /** Entries of a face's unknowns. */
    template <int dim>
    void extract(const Vector &ghosted, const FaceShapes<dim> &face, std::vector<double> &entries)
    {
      entries.resize(face.dofs.size());
      ghosted.extract_subvector_to(face.dofs.begin(), face.dofs.end(), entries.begin());
    }
  } // namespace

  template <int dim>
  BoundaryConditions<dim>::BoundaryConditions(const dealii::DoFHandler<dim> &dof_handler,
                                              const dealii::Mapping<dim> &mapping, Geometry geometry,
                                              const BoundaryNames &names, std::vector<BoundaryCondition> conditions)
      : dof_handler_(dof_handler), mapping_(mapping), geometry_(geometry), names_(names),
        conditions_(std::move(conditions))
  {
    check_conditions();
    take_face_shapes();
    std::vector<bool> is_held;
    for (const BoundaryCondition &condition : conditions_)
      is_held.push_back(condition.is_held);
    set_held(is_held);
  }

  template <int dim>
  void BoundaryConditions<dim>::set_held(const std::vector<bool> &is_held)
  {
    is_held_ = is_held;
    collect_prescribed();
    check_rigid_motions();
  }

  template <int dim>
  void BoundaryConditions<dim>::check_rigid_motions() const
  {
    std::vector<PrescribedComponent> components;
    for (const PrescribedUnknown &entry : prescribed_)
      components.push_back({entry.position, entry.axis});
    const unsigned int n_free = count_free_rigid_motions(geometry_, components, dof_handler_.get_communicator());
    if (n_free > 0)
      throw std::invalid_argument(
          fmt::format("boundary conditions: {} of the body left free: prescribe more "
                      "displacement components",
                      n_free == 1 ? "1 rigid motion" : fmt::format("{} rigid motions", n_free)));
  }

  template <int dim>
  void BoundaryConditions<dim>::check_conditions()
  {
    std::vector<std::string> known;
    for (const auto &[name, id] : names_.boundaries)
      known.push_back(name);
    for (const auto &[name, id] : names_.interfaces)
      known.push_back(name);
    for (const BoundaryCondition &condition : conditions_)
      {
        if (names_.interfaces.contains(condition.boundary) && condition.kind != ConditionKind::displacement)
          throw std::invalid_argument(fmt::format("boundary condition on '{}': it lies inside the mesh: allowed: a "
                                                  "displacement",
                                                  condition.boundary));
        if (!names_.boundaries.contains(condition.boundary) && !names_.interfaces.contains(condition.boundary))
          throw std::invalid_argument(
              fmt::format("boundary condition: no boundary '{}'; known: {}", condition.boundary, join(known)));
        components_.push_back(condition.kind == ConditionKind::pressure ? 0 : find_component(condition));
      }
  }

  template <int dim>
  void BoundaryConditions<dim>::take_face_shapes()
  {
    using Face = typename dealii::DoFHandler<dim>::face_iterator;
    for (const auto &[name, id] : names_.boundaries)
      faces_[name] = list_face_shapes<dim>(dof_handler_, mapping_, [id = id](const Face &face) {
        return face->at_boundary() && face->boundary_id() == id;
      });
    for (const auto &[name, id] : names_.interfaces)
      faces_[name] = list_face_shapes<dim>(dof_handler_, mapping_, [id = id](const Face &face) {
        return !face->at_boundary() && face->manifold_id() == id;
      });
  }

  template <int dim>
  unsigned int BoundaryConditions<dim>::find_component(const BoundaryCondition &condition) const
  {
    const auto names = get_component_names<dim>();
    const bool is_r = geometry_ == Geometry::axisymmetric && condition.component == "r";
    const std::string wanted = is_r ? "x" : condition.component;
    const auto found = std::find(names.begin(), names.end(), wanted);
    if (found == names.end())
      throw std::invalid_argument(fmt::format("boundary condition on '{}': no component '{}'; known: {}",
                                              condition.boundary, condition.component, join(names)));
    return found - names.begin();
  }

  // The unknowns of this rank's cells that a displacement condition prescribes.
  template <int dim>
  dealii::IndexSet BoundaryConditions<dim>::extract_dofs(unsigned int index) const
  {
    const std::string &name = conditions_[index].boundary;
    dealii::ComponentMask mask(dim, false);
    mask.set(components_[index], true);
    const auto inside = names_.interfaces.find(name);
    if (inside == names_.interfaces.end())
      return dealii::DoFTools::extract_boundary_dofs(dof_handler_, mask, {names_.boundaries.at(name)});
    dealii::IndexSet dofs(dof_handler_.n_dofs());
    for (const auto dof : collect_interface_dofs(dof_handler_, inside->second, mask))
      dofs.add_index(dof);
    return dofs;
  }

  template <int dim>
  void BoundaryConditions<dim>::collect_prescribed()
  {
    const dealii::IndexSet &owned = dof_handler_.locally_owned_dofs();
    dealii::IndexSet relevant;
    dealii::DoFTools::extract_locally_relevant_dofs(dof_handler_, relevant);
    constraints_.clear();
    constraints_.reinit(relevant);
    prescribed_.clear();
    prescribed_dofs_.clear();

    std::map<dealii::types::global_dof_index, dealii::Point<dim>> positions;
    dealii::DoFTools::map_dofs_to_support_points(mapping_, dof_handler_, positions);
    std::map<dealii::types::global_dof_index, PrescribedUnknown> prescribed;
    for (unsigned int i = 0; i < conditions_.size(); ++i)
      if (conditions_[i].kind == ConditionKind::displacement && is_held_[i])
        {
          const dealii::IndexSet dofs = extract_dofs(i);
          for (const auto dof : dofs)
            {
              if (!relevant.is_element(dof))
                continue;
              constraints_.add_line(dof);
              if (!owned.is_element(dof))
                continue;
              const dealii::Point<3> position(embed<dim>(positions.at(dof)));
              auto &entry =
                  prescribed.try_emplace(dof, PrescribedUnknown{dof, i, position, get_axis<dim>(components_[i]), {}})
                      .first->second;
              entry.conditions.push_back(i);
            }
        }
    constraints_.close();
    for (auto &[dof, entry] : prescribed)
      {
        prescribed_dofs_.push_back(dof);
        prescribed_.push_back(std::move(entry));
      }
  }

  template <int dim>
  void BoundaryConditions<dim>::set_free_to_zero(Vector &vector) const
  {
    std::vector<double> kept;
    for (const auto dof : prescribed_dofs_)
      kept.push_back(vector(dof));
    vector = 0.;
    for (std::size_t i = 0; i < kept.size(); ++i)
      vector(prescribed_dofs_[i]) = kept[i];
    vector.compress(dealii::VectorOperation::insert);
  }

  template <int dim>
  void BoundaryConditions<dim>::set_prescribed(const std::vector<double> &values, Vector &displacement) const
  {
    for (const PrescribedUnknown &entry : prescribed_)
      {
        const auto &profile = conditions_[entry.condition].profile;
        const double value = values[entry.condition];
        displacement(entry.dof) = profile ? profile(entry.position, value) : value;
      }
    displacement.compress(dealii::VectorOperation::insert);
  }

  // A traction keeps its direction, a pressure follows the normal. Nanson: n da = det F F^-T N dA.
  template <int dim>
  void BoundaryConditions<dim>::visit_condition_forces(unsigned int index, double value,
                                                       const Vector *ghosted_displacement,
                                                       const VisitForces &visit) const
  {
    const BoundaryCondition &condition = conditions_[index];
    const bool is_current = ghosted_displacement != nullptr && condition.area == AreaMeasure::current;
    std::vector<double> displacement;
    for (const FaceShapes<dim> &face : faces_.at(condition.boundary))
      {
        if (is_current)
          extract(*ghosted_displacement, face, displacement);
        for (const auto &point : face.points)
          {
            Tensor<1, 3> area = point.measure * compute_depth(geometry_, point.position[0]) * embed<dim>(point.normal);
            if (is_current)
              {
                const auto deformation =
                    compute_deformation<dim>(geometry_, face, point, dof_handler_.get_fe(), displacement);
                area = dealii::determinant(deformation) * dealii::transpose(dealii::invert(deformation)) * area;
              }
            Tensor<1, 3> force = -value * area;
            if (condition.kind == ConditionKind::traction)
              {
                force = 0.;
                force[get_axis<dim>(components_[index])] = value * area.norm();
              }
            std::vector<double> forces;
            for (unsigned int i = 0; i < face.dofs.size(); ++i)
              forces.push_back(point.values[i] *
                               force[get_axis<dim>(dof_handler_.get_fe().system_to_component_index(i).first)]);
            visit(face.cell, face.dofs, forces);
          }
      }
  }

  template <int dim>
  void BoundaryConditions<dim>::assemble_external_forces(const std::vector<double> &values,
                                                         const Vector *ghosted_displacement, Vector &forces) const
  {
    forces = 0.;
    for_each_external_force(
        values, ghosted_displacement,
        [&](const auto &, const auto &dofs, const auto &nodal_forces) { forces.add(dofs, nodal_forces); });
    forces.compress(dealii::VectorOperation::add);
  }

  template <int dim>
  void BoundaryConditions<dim>::for_each_external_force(const std::vector<double> &values,
                                                        const Vector *ghosted_displacement,
                                                        const VisitForces &visit) const
  {
    for (unsigned int i = 0; i < conditions_.size(); ++i)
      if (conditions_[i].kind != ConditionKind::displacement)
        visit_condition_forces(i, values[i], ghosted_displacement, visit);
  }

  template <int dim>
  Tensor<1, 3> BoundaryConditions<dim>::compute_average_displacement(const std::string &boundary,
                                                                     const Vector &ghosted_displacement) const
  {
    double area = 0.;
    Tensor<1, 3> moment;
    std::vector<double> displacement;
    for (const FaceShapes<dim> &face : faces_.at(boundary))
      {
        extract(ghosted_displacement, face, displacement);
        for (const auto &point : face.points)
          {
            const double part = point.measure * compute_depth(geometry_, point.position[0]);
            area += part;
            for (unsigned int i = 0; i < face.dofs.size(); ++i)
              moment[get_axis<dim>(dof_handler_.get_fe().system_to_component_index(i).first)] +=
                  part * point.values[i] * displacement[i];
          }
      }
    const MPI_Comm communicator = dof_handler_.get_communicator();
    area = dealii::Utilities::MPI::sum(area, communicator);
    moment = dealii::Utilities::MPI::sum(moment, communicator);
    // The axis has no area: it does not move either.
    return area > 0. ? moment / area : Tensor<1, 3>();
  }

  template <int dim>
  std::vector<BoundaryResponse>
  BoundaryConditions<dim>::compute_responses(const std::vector<double> &values, const Vector &reactions,
                                             const Vector &ghosted_displacement, bool finite) const
  {
    std::map<std::string, Tensor<1, 3>> forces;
    for (unsigned int i = 0; i < conditions_.size(); ++i)
      if (conditions_[i].kind != ConditionKind::displacement)
        visit_condition_forces(i, values[i], finite ? &ghosted_displacement : nullptr,
                               [&](const auto &, const auto &dofs, const auto &nodal_forces) {
                                 for (std::size_t j = 0; j < dofs.size(); ++j)
                                   forces[conditions_[i].boundary]
                                         [get_axis<dim>(dof_handler_.get_fe().system_to_component_index(j).first)] +=
                                       nodal_forces[j];
                               });
    for (const PrescribedUnknown &entry : prescribed_)
      for (const unsigned int i : entry.conditions)
        forces[conditions_[i].boundary][entry.axis] += reactions(entry.dof) / entry.conditions.size();

    std::vector<BoundaryResponse> responses;
    for (const auto &[name, id] : names_.boundaries)
      responses.push_back({name, dealii::Utilities::MPI::sum(forces[name], dof_handler_.get_communicator()),
                           compute_average_displacement(name, ghosted_displacement)});
    Tensor<1, 3> unknown;
    for (int axis = 0; axis < 3; ++axis)
      unknown[axis] = std::numeric_limits<double>::quiet_NaN();
    for (const auto &[name, id] : names_.interfaces)
      responses.push_back({name, unknown, compute_average_displacement(name, ghosted_displacement)});
    return responses;
  }

  template class BoundaryConditions<2>;
  template class BoundaryConditions<3>;
} // namespace fem
