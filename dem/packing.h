#pragma once

#include "dem/equilibrium.h"
#include "dem/grading.h"
#include "dem/rev_state.h"

#include <string>

namespace dem
{
  /** What a packing is to be. */
  struct PackingRule
  {
    std::size_t n_grains = 1000;
    Grading grading = make_ne34_grading();
    CellKind cell_kind = CellKind::periodic;
    double void_ratio = 0.65;       ///< e0 at the pressure [-]
    double tolerance = 0.005;       ///< of the void ratio [-]
    double pressure = 100e3;        ///< isotropic, compression-positive [Pa]
    double friction = -1.;          ///< during generation [-]; negative: searched for
    unsigned int search_cap = 12;   ///< packings tried for one set of first positions
    unsigned int positions_cap = 4; ///< sets of first positions tried
    std::uint64_t seed = 1;
    std::uint64_t number = 0; ///< of the packing: the same seed and number give the same packing
  };

  struct PackingReport
  {
    RestStatus status = RestStatus::at_rest;
    bool is_found = false;  ///< void ratio within its tolerance
    double friction = 0.;   ///< that gave it [-]
    double void_ratio = 0.; ///< reached [-]
    unsigned int n_tried = 0;
    std::size_t n_cycles = 0;
  };

  struct Packing
  {
    RevState state;
    PackingReport report;
  };

  /**
   * Random packing by radius expansion: grains at random places grow in a loose cell, then the cell closes in until the
   * isotropic stress holds. The denser, the lower the friction meanwhile: it is searched for until the void ratio is
   * met. (The friction of the material is back in force afterwards.) Between walls the void ratio is that of the whole
   * box, looser pores along the walls included.
   *
   * The best packing found is returned with report.is_found false when the search is exhausted.
   */
  Packing generate_packing(const PackingRule &rule, const GrainMaterial &material, const DynamicsRule &dynamics);
} // namespace dem
