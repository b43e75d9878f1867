#pragma once

#include "dem/contact_network.h"
#include "dem/single_rows.h"

namespace dem
{
  /**
   * Sixteen pairs of a network as the single precision loop reads them, one pack after the other. Lengths and overlaps
   * are those when the network was built, found in double: the loop adds what has changed since.
   */
  struct alignas(64) SinglePack
  {
    SingleOffset row_a[n_singles], row_b[n_singles];
    float branch_x[n_singles], branch_y[n_singles], branch_z[n_singles]; ///< x_b - x_a [m]
    float overlap[n_singles];                                            ///< [m]
    float radius_sum[n_singles];                                         ///< Ra + Rb, less what has crept [m]
    float root_radius[n_singles];                                        ///< sqrt(R*) [m^0.5]
    float shear_x[n_singles], shear_y[n_singles], shear_z[n_singles];    ///< shear force on a [N]; zero where apart
  };

  /** One pack for each n_singles pairs of a network just built. @pre state is the one that it was built from */
  void build_packs(const ContactNetwork &network, const RevState &state, Team &team, std::vector<SinglePack> &packs);

  /** Tells the network the shear forces of its pairs. */
  void write_shear(const std::vector<SinglePack> &packs, ContactNetwork &network);
} // namespace dem
