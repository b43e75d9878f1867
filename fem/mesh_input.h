#pragma once

#include "fem/geometry.h"

#include <deal.II/distributed/tria.h>

#include <array>
#include <map>
#include <memory>
#include <string>

namespace fem
{
  enum class MeshKind
  {
    box,      ///< block from the origin; names left, right (x), front, back (y, 3-D only), bottom, top (z)
    cylinder, ///< around the z axis; names axis (a 2-D solid one) or inner, outer, bottom, top
    file      ///< gmsh 2.2 or 4.1; the physical names of its lines (2-D) or surfaces (3-D). In 2.2 some may lie inside
  };

  struct MeshParameters
  {
    MeshKind kind = MeshKind::box;
    std::string file;                                  ///< path of a .msh file
    std::array<double, 3> size = {{1., 1., 1.}};       ///< box: edges along x, y, z [m], > 0; 2-D ignores y
    double inner_radius = 0.;                          ///< cylinder [m], >= 0
    double outer_radius = 1.;                          ///< cylinder [m], > inner radius
    double height = 1.;                                ///< cylinder, from z = 0 [m], > 0
    std::array<unsigned int, 3> n_cells = {{1, 1, 1}}; ///< >= 1. Box: along x, y, z. Cylinder: radial, around, axial
    unsigned int n_refinements = 0;                    ///< uniform halvings after that, >= 0
  };

  /** A mesh and what its parts are called. */
  template <int dim>
  struct Mesh
  {
    std::unique_ptr<dealii::parallel::distributed::Triangulation<dim>> triangulation;
    std::map<std::string, dealii::types::boundary_id> boundary_ids;
    std::map<std::string, dealii::types::manifold_id> interface_ids; ///< named faces inside the mesh: their manifold id
    std::map<std::string, dealii::types::material_id> region_ids;    ///< "body" where no file names others
  };

  /** Builds or reads the mesh on the ranks of the communicator. Throws std::invalid_argument naming the parameter, its
   *  value and range, or std::runtime_error naming the file and, where known, the line. */
  template <int dim>
  Mesh<dim> create_mesh(const MeshParameters &parameters, Geometry geometry, MPI_Comm communicator);
} // namespace fem
