#pragma once

#include "fem/composite_material.h"
#include "tests/support/fem_cases.h"

/** A pile in the ground of meshes/pile_*.msh, or of a block of the same layout, with materials of known answers. */
namespace fem::cases
{
  constexpr dealii::types::material_id pile_region = 1, interface_region = 2, ground_region = 3; // of the meshes

  inline Mesh<2> read_pile_mesh(const std::string &name, unsigned int n_refinements = 0)
  {
    MeshParameters parameters;
    parameters.kind = MeshKind::file;
    parameters.file = std::string(SLOWSAND_SOURCE_DIR) + "/meshes/" + name;
    parameters.n_refinements = n_refinements;
    return create_mesh<2>(parameters, Geometry::axisymmetric, MPI_COMM_SELF);
  }

  /** Pile and ground, both elastic. */
  inline std::unique_ptr<CompositeMaterial> make_elastic_pile(const ElasticParameters &pile,
                                                              const ElasticParameters &ground)
  {
    auto material = std::make_unique<CompositeMaterial>(MPI_COMM_SELF);
    auto body = std::make_unique<ElasticMaterial>(pile, MPI_COMM_SELF);
    body->set_archive_group("/material/pile");
    material->add(std::move(body), {pile_region});
    material->add(std::make_unique<ElasticMaterial>(ground, MPI_COMM_SELF), {interface_region, ground_region});
    return material;
  }

  /** Far and bottom fixed across themselves, symmetry on the axis. */
  inline std::vector<BoundaryCondition> get_ground_conditions()
  {
    return {{"axis", ConditionKind::displacement, "x"},
            {"far", ConditionKind::displacement, "x"},
            {"bottom", ConditionKind::displacement, "z"}};
  }

  inline BoundaryCondition make_displacement(const std::string &boundary, const std::string &component, bool is_held)
  {
    BoundaryCondition condition{boundary, ConditionKind::displacement, component};
    condition.is_held = is_held;
    return condition;
  }

  template <int dim>
  BoundaryResponse find_response(const QuasiStaticProblem<dim> &problem, const std::string &name)
  {
    for (const BoundaryResponse &response : problem.compute_boundary_responses())
      if (response.name == name)
        return response;
    throw std::logic_error(name);
  }
} // namespace fem::cases
