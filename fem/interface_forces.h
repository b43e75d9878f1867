#pragma once

#include "fem/assembly.h"

#include <map>
#include <string>
#include <vector>

namespace fem
{
  /**
   * Forces that pass through named faces inside a mesh, as those on its outer boundaries do: force on the body [N],
   * over 2 pi in axisymmetry, in space axes. The body is what lies outside the pile.
   *
   * A node's force is that of the body's cells there, internal less their weight and loads: what the pile's side, or
   * whoever holds the face, must exert. A cell with a face on an interface gives its part to that one; one that only
   * touches a node which several interfaces share gives equal parts to those that lie level, or to all where none does.
   * So at the tip of a pile the cells beside the shaft count as shaft, all below the tip as base.
   */
  template <int dim>
  class InterfaceForces
  {
  public:
    using Regions = std::set<dealii::types::material_id>;

    /** @param inner  regions of the pile: their cells do not count */
    InterfaceForces(const dealii::DoFHandler<dim> &dof_handler,
                    const std::map<std::string, dealii::types::manifold_id> &interface_ids, const Regions &inner);

    /** Calls its argument with the nodal forces of one cell after the other. */
    using ForEachForce = std::function<void(const typename Assembly<dim>::VisitForces &)>;

    /** One force a name: internal forces less loads. Collective. */
    std::map<std::string, dealii::Tensor<1, 3>> compute(const ForEachForce &internal, const ForEachForce &loads) const;

  private:
    using Cell = typename dealii::DoFHandler<dim>::active_cell_iterator;
    using Forces = std::map<dealii::types::manifold_id, dealii::Tensor<1, 3>>;

    /** Which interfaces are wider than high. */
    std::set<dealii::types::manifold_id> find_level_interfaces() const;

    /** Shares a cell's nodal forces out, times a factor. */
    void share_out(const Cell &cell, const std::vector<dealii::types::global_dof_index> &dofs,
                   const std::vector<double> &forces, double factor, Forces &sums) const;

    const dealii::DoFHandler<dim> &dof_handler_;
    std::map<std::string, dealii::types::manifold_id> interface_ids_;
    Regions inner_;
    std::map<dealii::types::global_dof_index, std::set<dealii::types::manifold_id>> interfaces_of_dof_;
    std::set<dealii::types::manifold_id> level_;
  };

  /** Unknowns on the faces of an interface, of this rank's cells and its ghosts. @param components  of them alone */
  template <int dim>
  std::set<dealii::types::global_dof_index> collect_interface_dofs(const dealii::DoFHandler<dim> &dof_handler,
                                                                   dealii::types::manifold_id id,
                                                                   const dealii::ComponentMask &components = {});
} // namespace fem
