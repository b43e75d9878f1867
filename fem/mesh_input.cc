#include "fem/mesh_input.h"

#include "fem/gmsh_file.h"

#include <deal.II/grid/grid_generator.h>
#include <deal.II/grid/grid_in.h>
#include <deal.II/grid/grid_tools.h>
#include <deal.II/grid/manifold_lib.h>

#include <fmt/format.h>

#include <cmath>
#include <sstream>
#include <stdexcept>

namespace fem
{
  namespace
  {
    void require(bool is_met, const std::string &name, double value, const std::string &range)
    {
      if (!is_met)
        throw std::invalid_argument(fmt::format("mesh: {} = {} must be {}", name, value, range));
    }

    template <int dim>
    void create_box(const MeshParameters &parameters, Mesh<dim> &mesh)
    {
      std::vector<unsigned int> n_cells;
      dealii::Point<dim> corner;
      for (unsigned int c = 0; c < dim; ++c)
        {
          const unsigned int axis = get_axis<dim>(c);
          require(parameters.size[axis] > 0., fmt::format("size along {}", "xyz"[axis]), parameters.size[axis],
                  "> 0 m");
          require(parameters.n_cells[axis] > 0, fmt::format("cells along {}", "xyz"[axis]), 0, ">= 1");
          corner[c] = parameters.size[axis];
          n_cells.push_back(parameters.n_cells[axis]);
        }
      dealii::GridGenerator::subdivided_hyper_rectangle(*mesh.triangulation, n_cells, dealii::Point<dim>(), corner,
                                                        true);
      if constexpr (dim == 2)
        mesh.boundary_ids = {{"left", 0}, {"right", 1}, {"bottom", 2}, {"top", 3}};
      else
        mesh.boundary_ids = {{"left", 0}, {"right", 1}, {"front", 2}, {"back", 3}, {"bottom", 4}, {"top", 5}};
    }

    template <int dim>
    void name_cylinder(const MeshParameters &parameters, Mesh<dim> &mesh)
    {
      const std::string inside = dim == 2 && parameters.inner_radius == 0. ? "axis" : "inner";
      mesh.boundary_ids = {{inside, 0}, {"outer", 1}, {"bottom", 2}, {"top", 3}};
      if (dim == 3 && parameters.inner_radius == 0.)
        mesh.boundary_ids.erase(inside);
      const double tolerance = 1e-8 * parameters.height;
      const double mean_radius = 0.5 * (parameters.inner_radius + parameters.outer_radius);
      for (const auto &cell : mesh.triangulation->active_cell_iterators())
        for (const auto &face : cell->face_iterators())
          if (face->at_boundary())
            {
              const auto position = embed<dim>(face->vertex(0));
              const auto centre = embed<dim>(face->center());
              const double radius = std::hypot(position[0], position[1]);
              if (centre[2] < tolerance)
                face->set_boundary_id(2);
              else if (centre[2] > parameters.height - tolerance)
                face->set_boundary_id(3);
              else
                face->set_boundary_id(radius > mean_radius ? 1 : 0);
            }
    }

    void create_solid(const MeshParameters &parameters, dealii::Triangulation<3> &triangulation)
    {
      using namespace dealii;
      GridGenerator::subdivided_cylinder(triangulation, parameters.n_cells[2], parameters.outer_radius,
                                         0.5 * parameters.height);
      // deal.II's cylinder lies along x: turn (x, y, z) to (y, z, x).
      GridTools::transform([&](const Point<3> &p) { return Point<3>(p[1], p[2], p[0] + 0.5 * parameters.height); },
                           triangulation);
      triangulation.set_manifold(0, CylindricalManifold<3>(2));
    }

    template <int dim>
    void create_cylinder(const MeshParameters &parameters, Geometry geometry, Mesh<dim> &mesh)
    {
      require(parameters.inner_radius >= 0., "inner radius", parameters.inner_radius, ">= 0 m");
      require(parameters.outer_radius > parameters.inner_radius, "outer radius", parameters.outer_radius,
              fmt::format("> the inner radius, {} m", parameters.inner_radius));
      require(parameters.height > 0., "height", parameters.height, "> 0 m");
      for (const unsigned int n : parameters.n_cells)
        require(n > 0, "cells of the cylinder", n, ">= 1");
      auto &triangulation = *mesh.triangulation;
      if constexpr (dim == 2)
        {
          if (geometry != Geometry::axisymmetric)
            throw std::invalid_argument("mesh: a two-dimensional cylinder needs the axisymmetric geometry");
          dealii::GridGenerator::subdivided_hyper_rectangle(
              triangulation, {parameters.n_cells[0], parameters.n_cells[2]},
              dealii::Point<2>(parameters.inner_radius, 0.),
              dealii::Point<2>(parameters.outer_radius, parameters.height));
        }
      else if (parameters.inner_radius > 0.)
        dealii::GridGenerator::cylinder_shell(triangulation, parameters.height, parameters.inner_radius,
                                              parameters.outer_radius, parameters.n_cells[1], parameters.n_cells[2]);
      else
        create_solid(parameters, triangulation);
      name_cylinder(parameters, mesh);
    }

    /** Gives the named faces inside the mesh a manifold id, which children inherit: boundary ids are for the outside.
     */
    template <int dim>
    void mark_interfaces(const std::string &file, const NamedInterfaces &interfaces, Mesh<dim> &mesh)
    {
      for (auto name = mesh.boundary_ids.begin(); name != mesh.boundary_ids.end();)
        {
          const auto [id, is_inside] = std::pair(name->second, interfaces.centres.contains(name->second));
          if (is_inside)
            {
              mesh.interface_ids[name->first] = id;
              mesh.triangulation->set_manifold(id, dealii::FlatManifold<dim>());
            }
          name = is_inside ? mesh.boundary_ids.erase(name) : std::next(name);
        }
      const double tolerance = 1e-9 * dealii::GridTools::diameter(*mesh.triangulation);
      for (const auto &cell : mesh.triangulation->active_cell_iterators())
        for (const auto &face : cell->face_iterators())
          for (const auto &[id, centres] : interfaces.centres)
            {
              if (face->at_boundary() && face->boundary_id() == id)
                throw std::runtime_error(fmt::format("{}: physical number {} names faces both inside the mesh and on "
                                                     "its outer boundary; give them two names",
                                                     file, id));
              for (const auto &centre : centres)
                {
                  dealii::Point<dim> place;
                  for (unsigned int c = 0; c < dim; ++c)
                    place[c] = centre[c];
                  if (!face->at_boundary() && face->center().distance(place) < tolerance)
                    face->set_manifold_id(id);
                }
            }
    }

    template <int dim>
    void read_mesh(const std::string &file, Mesh<dim> &mesh)
    {
      for (const auto &[name, id] : read_physical_names(file, dim - 1))
        mesh.boundary_ids[name] = id;
      if (mesh.boundary_ids.empty())
        throw std::runtime_error(
            fmt::format("{}: no physical names of dimension {}; boundaries need them", file, dim - 1));
      const NamedInterfaces interfaces = read_interfaces(file, dim);
      std::istringstream stream(interfaces.text);
      dealii::GridIn<dim> reader(*mesh.triangulation);
      try
        {
          reader.read_msh(stream);
        }
      catch (const dealii::ExceptionBase &error)
        {
          std::ostringstream cause;
          error.print_info(cause);
          throw std::runtime_error(
              fmt::format("{}: not a gmsh 2.2 or 4.1 mesh of quadrilaterals or hexahedra: {}", file, cause.str()));
        }
      mark_interfaces(file, interfaces, mesh);
      mesh.region_ids.clear();
      for (const auto &[name, id] : read_physical_names(file, dim))
        mesh.region_ids[name] = id;
    }
  } // namespace

  template <int dim>
  Mesh<dim> create_mesh(const MeshParameters &parameters, Geometry geometry, MPI_Comm communicator)
  {
    if ((geometry == Geometry::three_dimensional) != (dim == 3))
      throw std::invalid_argument("mesh: the geometry and the dimension of the mesh do not match");
    Mesh<dim> mesh;
    mesh.triangulation = std::make_unique<dealii::parallel::distributed::Triangulation<dim>>(communicator);
    mesh.region_ids = {{"body", 0}};
    if (parameters.kind == MeshKind::box)
      create_box(parameters, mesh);
    else if (parameters.kind == MeshKind::cylinder)
      create_cylinder(parameters, geometry, mesh);
    else
      read_mesh(parameters.file, mesh);
    mesh.triangulation->refine_global(parameters.n_refinements);
    return mesh;
  }

  template Mesh<2> create_mesh(const MeshParameters &, Geometry, MPI_Comm);
  template Mesh<3> create_mesh(const MeshParameters &, Geometry, MPI_Comm);
} // namespace fem
