#include "dem/single_pairs.h"

namespace dem
{
  static_assert(n_lanes % n_singles == 0, "lists of pairs are filled up to whole packs");

  namespace
  {
    /** Grains beside themselves fill the last pack of a list: whatever the cell does, they stay apart. */
    void fill_lane(SinglePack &pack, const int lane)
    {
      pack.branch_x[lane] = 1.f;
      pack.branch_y[lane] = pack.branch_z[lane] = 0.f;
      pack.overlap[lane] = -1.f;
      pack.radius_sum[lane] = pack.root_radius[lane] = 0.f;
    }

    void describe_pair(const ContactNetwork &network, const RevState &state, const std::size_t k, SinglePack &pack)
    {
      const int lane = static_cast<int>(k % n_singles);
      const Column<Row> &place = state.grains.place;
      const Vector branch = compute_branch(state.cell, place[network.a[k]], place[network.b[k]]);
      pack.branch_x[lane] = static_cast<float>(branch.x());
      pack.branch_y[lane] = static_cast<float>(branch.y());
      pack.branch_z[lane] = static_cast<float>(branch.z());
      pack.overlap[lane] = static_cast<float>(network.radius_sum[k] - branch.norm());
      pack.radius_sum[lane] = static_cast<float>(network.radius_sum[k]);
      pack.root_radius[lane] = static_cast<float>(network.root_radius[k]);
    }
  } // namespace

  void build_packs(const ContactNetwork &network, const RevState &state, Team &team, std::vector<SinglePack> &packs)
  {
    packs.resize(network.size() / n_singles);
    team.run(packs.size(), [&](const std::size_t p) {
      SinglePack &pack = packs[p];
      for (std::size_t lane = 0; lane < n_singles; ++lane)
        {
          const std::size_t k = p * n_singles + lane;
          pack.row_a[lane] = network.a[k] * static_cast<SingleOffset>(sizeof(CountRow));
          pack.row_b[lane] = network.row_b[k] / sizeof(Row) * sizeof(CountRow); // a grain's, or that of its copy
          pack.shear_x[lane] = static_cast<float>(network.shear_x[k]);
          pack.shear_y[lane] = static_cast<float>(network.shear_y[k]);
          pack.shear_z[lane] = static_cast<float>(network.shear_z[k]);
          if (network.is_pair(k))
            describe_pair(network, state, k, pack);
          else
            fill_lane(pack, static_cast<int>(lane));
        }
    });
  }

  void write_shear(const std::vector<SinglePack> &packs, ContactNetwork &network)
  {
    for (std::size_t k = 0; k < network.size(); ++k)
      {
        const SinglePack &pack = packs[k / n_singles];
        network.shear_x[k] = pack.shear_x[k % n_singles];
        network.shear_y[k] = pack.shear_y[k % n_singles];
        network.shear_z[k] = pack.shear_z[k % n_singles];
      }
  }
} // namespace dem
