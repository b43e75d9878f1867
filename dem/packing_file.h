#pragma once

#include "dem/rev_state.h"

#include <string>

namespace dem
{
  /**
   * Reads "# cell Lx Ly Lz" [m], then "x y z radius" [m] a line, as grains in a cell; other lines that begin with #
   * and empty ones are passed over. Grains touch without shear forces. Between walls no grain reaches beyond one by
   * more than half its radius.
   *
   * Throws std::runtime_error with file and line for anything else: a number that is none, an edge or a radius that is
   * not positive, two grains that overlap by more than half the smaller radius, a cell narrower than two largest
   * diameters.
   */
  RevState read_packing(const std::string &file, CellKind kind = CellKind::periodic);

  /** Writes the packing as such a text file, all digits. Throws std::runtime_error with path and cause. @pre the cell's
   *  edges are along the axes */
  void write_packing(const std::string &file, const RevState &state);
} // namespace dem
