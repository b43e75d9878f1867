#include "fem/initial_shapes.h"

#include <deal.II/base/quadrature_lib.h>
#include <deal.II/fe/fe_values.h>

namespace fem
{
  template <int dim>
  InitialShapes<dim>::InitialShapes(const dealii::DoFHandler<dim> &dof_handler, const dealii::Mapping<dim> &mapping,
                                    const dealii::Quadrature<dim> &quadrature)
      : n_points_per_cell_(quadrature.size())
  {
    const auto &element = dof_handler.get_fe();
    n_nodes_ = element.n_dofs_per_cell() / dim;
    std::vector<unsigned int> first_unknowns(n_nodes_); // of each node
    for (unsigned int i = 0; i < element.n_dofs_per_cell(); ++i)
      {
        components_.push_back(element.system_to_component_index(i).first);
        nodes_.push_back(element.system_to_component_index(i).second);
        if (components_.back() == 0)
          first_unknowns[nodes_.back()] = i;
      }
    dealii::FEValues<dim> values(mapping, element, quadrature,
                                 dealii::update_values | dealii::update_gradients | dealii::update_quadrature_points |
                                     dealii::update_JxW_values);
    for (const auto &cell : dof_handler.active_cell_iterators())
      {
        if (!cell->is_locally_owned())
          continue;
        values.reinit(cell);
        const bool is_first = positions_.empty();
        for (const unsigned int q : values.quadrature_point_indices())
          {
            positions_.push_back(values.quadrature_point(q));
            measures_.push_back(values.JxW(q));
            for (const unsigned int i : first_unknowns)
              {
                gradients_.push_back(values.shape_grad(i, q));
                if (is_first)
                  values_.push_back(values.shape_value(i, q));
              }
          }
      }
  }

  namespace
  {
    template <int dim>
    typename FaceShapes<dim>::Point take_point(const dealii::FEFaceValues<dim> &values, const unsigned int q)
    {
      typename FaceShapes<dim>::Point point{values.quadrature_point(q), values.normal_vector(q), values.JxW(q), {}, {}};
      for (unsigned int i = 0; i < values.dofs_per_cell; ++i)
        {
          point.values.push_back(values.shape_value(i, q));
          point.gradients.push_back(values.shape_grad(i, q));
        }
      return point;
    }
  } // namespace

  template <int dim>
  std::vector<FaceShapes<dim>> list_face_shapes(const dealii::DoFHandler<dim> &dof_handler,
                                                const dealii::Mapping<dim> &mapping, const FacePredicate<dim> &is_meant)
  {
    dealii::FEFaceValues<dim> values(
        mapping, dof_handler.get_fe(), dealii::QGauss<dim - 1>(dof_handler.get_fe().degree + 1),
        dealii::update_values | dealii::update_gradients | dealii::update_quadrature_points |
            dealii::update_JxW_values | dealii::update_normal_vectors);
    std::vector<FaceShapes<dim>> faces;
    for (const auto &cell : dof_handler.active_cell_iterators())
      if (cell->is_locally_owned())
        for (const unsigned int f : cell->face_indices())
          if (is_meant(cell->face(f)))
            {
              values.reinit(cell, f);
              FaceShapes<dim> face{cell, std::vector<dealii::types::global_dof_index>(values.dofs_per_cell), {}};
              cell->get_dof_indices(face.dofs);
              for (const unsigned int q : values.quadrature_point_indices())
                face.points.push_back(take_point(values, q));
              faces.push_back(std::move(face));
            }
    return faces;
  }

  template class InitialShapes<2>;
  template class InitialShapes<3>;
  template std::vector<FaceShapes<2>> list_face_shapes(const dealii::DoFHandler<2> &, const dealii::Mapping<2> &,
                                                       const FacePredicate<2> &);
  template std::vector<FaceShapes<3>> list_face_shapes(const dealii::DoFHandler<3> &, const dealii::Mapping<3> &,
                                                       const FacePredicate<3> &);
} // namespace fem
