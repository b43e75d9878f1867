#include "tests/support/fem_cases.h"
#include "tests/support/scratch_folder.h"

#include <deal.II/grid/grid_tools.h>

#include <gtest/gtest.h>

#include <fstream>

using namespace fem;
using namespace fem::cases;

namespace
{
  std::string get_error(const MeshParameters &parameters, Geometry geometry = Geometry::axisymmetric)
  {
    try
      {
        create_mesh<2>(parameters, geometry, MPI_COMM_SELF);
      }
    catch (const std::exception &error)
      {
        return error.what();
      }
    return "";
  }

  MeshParameters from_file(const std::string &name)
  {
    MeshParameters parameters;
    parameters.kind = MeshKind::file;
    parameters.file = name;
    return parameters;
  }

  template <int dim>
  double compute_boundary_measure(const Mesh<dim> &mesh, const std::string &name)
  {
    double measure = 0.;
    for (const auto &cell : mesh.triangulation->active_cell_iterators())
      for (const auto &face : cell->face_iterators())
        if (face->at_boundary() && face->boundary_id() == mesh.boundary_ids.at(name))
          measure += face->measure();
    return measure;
  }
} // namespace

TEST(MeshInput, AGmshFileGivesItsNamesInBothFormats)
{
  // Law: boundaries are called what the file calls them; formats 2.2 and 4.1 of one geometry give one mesh.
  for (const std::string file : {"oedometer_22.msh", "oedometer_41.msh"})
    {
      const auto mesh =
          create_mesh<2>(from_file(SLOWSAND_SOURCE_DIR "/meshes/" + file), Geometry::axisymmetric, MPI_COMM_SELF);
      // The specimen of meshes/README.md: radius 0.035 m, height 0.02 m.
      EXPECT_NEAR(dealii::GridTools::volume(*mesh.triangulation), 0.035 * 0.02, 1e-12);
      EXPECT_NEAR(compute_boundary_measure(mesh, "axis"), 0.02, 1e-12);
      EXPECT_NEAR(compute_boundary_measure(mesh, "outer"), 0.02, 1e-12);
      EXPECT_NEAR(compute_boundary_measure(mesh, "bottom"), 0.035, 1e-12);
      EXPECT_NEAR(compute_boundary_measure(mesh, "top"), 0.035, 1e-12);
    }
}

TEST(MeshInput, CylindersInSpaceHaveTheirSurfaces)
{
  // Law: the area of each named surface converges to the cylinder's; a polygon of 32 sides is within 1 %.
  MeshParameters parameters;
  parameters.kind = MeshKind::cylinder;
  parameters.height = 3.;
  parameters.n_refinements = 2;
  const double pi = dealii::numbers::PI;
  for (const double inner : {0., 0.5})
    {
      parameters.inner_radius = inner;
      parameters.n_cells = {{1, 8, 2}};
      const auto mesh = create_mesh<3>(parameters, Geometry::three_dimensional, MPI_COMM_SELF);
      const double base = pi * (1. - inner * inner);
      EXPECT_NEAR(compute_boundary_measure(mesh, "bottom") / base, 1., 0.03);
      EXPECT_NEAR(compute_boundary_measure(mesh, "top") / base, 1., 0.03);
      EXPECT_NEAR(compute_boundary_measure(mesh, "outer") / (2. * pi * 3.), 1., 0.03);
      if (inner > 0.)
        {
          EXPECT_NEAR(compute_boundary_measure(mesh, "inner") / (2. * pi * inner * 3.), 1., 0.03);
        }
    }
}

TEST(MeshInput, BadFilesAndNumbersAreNamed)
{
  // Law: what cannot be a mesh is refused with file or parameter, value and range.
  EXPECT_EQ(get_error(from_file("/nowhere/mesh.msh")), "/nowhere/mesh.msh: cannot be opened");

  const ScratchFolder folder;
  const unsigned int rank = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD);
  const std::string file = folder.get_file("bad_" + std::to_string(rank) + ".msh");
  std::ofstream(file) << "$PhysicalNames\n2\n1 1 \"top\"\nnonsense\n";
  EXPECT_EQ(get_error(from_file(file)), file + ":4: expected: dimension number \"name\"");
  std::ofstream(file) << "no mesh at all\n";
  EXPECT_NE(get_error(from_file(file)).find("no physical names of dimension 1"), std::string::npos);
  std::ofstream(file)
      << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n1 1 \"top\"\n$EndPhysicalNames\n$Nodes\n4";
  EXPECT_NE(get_error(from_file(file)).find(file + ": not a gmsh"), std::string::npos);

  MeshParameters cylinder;
  cylinder.kind = MeshKind::cylinder;
  cylinder.inner_radius = 2.;
  EXPECT_EQ(get_error(cylinder), "mesh: outer radius = 1 must be > the inner radius, 2 m");
}

TEST(MeshInput, FacesInsideTheMeshKeepTheirNames)
{
  // Law: a physical curve with cells on both sides is an interface, on every level of refinement; regions have names.
  for (const unsigned int n_refinements : {0u, 2u})
    {
      MeshParameters parameters = from_file(SLOWSAND_SOURCE_DIR "/meshes/pile_coarse.msh");
      parameters.n_refinements = n_refinements;
      const auto mesh = create_mesh<2>(parameters, Geometry::axisymmetric, MPI_COMM_SELF);
      std::map<dealii::types::manifold_id, double> measures; // seen from both sides
      for (const auto &cell : mesh.triangulation->active_cell_iterators())
        for (const auto &face : cell->face_iterators())
          measures[face->manifold_id()] += 0.5 * face->measure();
      EXPECT_NEAR(measures.at(mesh.interface_ids.at("shaft")), 5., 1e-9);    // the length of the pile
      EXPECT_NEAR(measures.at(mesh.interface_ids.at("base")), 0.125, 1e-12); // its radius
      EXPECT_FALSE(mesh.boundary_ids.contains("shaft"));
      EXPECT_NEAR(compute_boundary_measure(mesh, "head"), 0.125, 1e-12);
      EXPECT_EQ(mesh.region_ids.size(), 3u);
      EXPECT_EQ(mesh.region_ids.at("pile"), 1u);
    }
}
