#pragma once

#include <array>
#include <iosfwd>
#include <map>
#include <string>
#include <vector>

namespace fem
{
  /** Physical names of dimension `dimension` in a gmsh file, with their numbers. Throws std::runtime_error naming file
   *  and line. */
  std::map<std::string, unsigned int> read_physical_names(const std::string &file, int dimension);

  /** Faces inside a mesh that a gmsh file gives a name to. */
  struct NamedInterfaces
  {
    /** Centres [m] of the faces (the mean of their corners) by the number of their name. */
    std::map<unsigned int, std::vector<std::array<double, 3>>> centres;

    /** The file without the elements of these faces: a reader that knows faces of the outer boundary alone takes it. */
    std::string text;
  };

  /**
   * Finds named faces that have cells on both sides: the shaft of a pile in the ground, for example.
   *
   * Format 2.2 alone: a 4.1 file comes back as it is, without interfaces. Throws std::runtime_error naming the file and
   * what is missing in it.
   *
   * @param dimension  of the cells: 2 (quadrilaterals, faces are lines) or 3 (hexahedra, faces are quadrilaterals)
   */
  NamedInterfaces read_interfaces(const std::string &file, int dimension);
} // namespace fem
