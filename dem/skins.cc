#include "dem/skins.h"

#include "dem/memory.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace dem
{
  namespace
  {
    /** A new network is due before a skin is used up, so that the last part of it is not looked at every cycle. */
    constexpr double due_share = 0.8;

    /** Cycles that the skins of fast grains are made to last at the speed they had (docs/performance.md). */
    constexpr double lasting_cycles = 200.;

    /** Of the grains: those need no larger skin than usual, or all would have one while a packing is made. */
    constexpr double many_share = 0.95;

    /** Of a large skin that stays when its grain is slow for once. */
    constexpr double kept_share = 0.5;

    double compute_way(const ContactNetwork &network, const Cell &cell, const Grains &grains, const std::size_t i)
    {
      return (cell.edges * (to_vector(grains.place[i]) - to_vector(network.place_when_built[i]))).norm();
    }
  } // namespace

  SkinUse compute_skin_use(const ContactNetwork &network, const Cell &cell, const Grains &grains,
                           const std::size_t begin, const std::size_t end)
  {
    const Matrix strain = cell.edges * network.edges_when_built.inverse() - Matrix::Identity();
    const double strained = 0.5 * strain.norm() * network.reach; // each grain's half of what it does to a pair
    SkinUse use{0., std::numeric_limits<double>::infinity()};
    for (std::size_t i = begin; i < end; ++i)
      {
        const double skin = network.place_when_built[i].w - grains.place[i].w;
        const double used = compute_way(network, cell, grains, i) + strained;
        use.share = std::max(use.share, used / skin);
        use.rest = std::min(use.rest, skin - used);
      }
    return use;
  }

  void Skins::set_alike(const Grains &grains, const double skin)
  {
    usual_ = 0.5 * skin;
    skins_.assign(grains.size(), usual_);
  }

  void Skins::adapt(const ContactNetwork &network, const Cell &cell, const Grains &grains)
  {
    const std::size_t n_grains = grains.size();
    ways_.resize(2 * n_grains);
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        const double way = ways_[i] = compute_way(network, cell, grains, i);
        ways_[n_grains + i] =
            std::isnan(way) ? std::numeric_limits<double>::infinity() : way; // what is no number has no order
      }
    const auto ordered = ways_.begin() + static_cast<std::ptrdiff_t>(n_grains);
    const auto of_many = ordered + static_cast<std::ptrdiff_t>(many_share * static_cast<double>(n_grains - 1));
    std::nth_element(ordered, of_many, ways_.end());
    const double cycles = static_cast<double>(std::max<std::size_t>(1, n_cycles_));
    const double growth = std::min(lasting_cycles / cycles, usual_ / *of_many);
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        const double wanted = std::max(kept_share * skins_[i], growth * ways_[i]);
        const double most = std::max(usual_, 0.5 * network.reach - grains.place[i].w);
        skins_[i] = wanted > usual_ ? std::min(wanted, most) : usual_; // NaN: as usual
      }
  }

  void Skins::begin(const ContactNetwork &network)
  {
    n_cycles_ = 0;
    rests_.resize(network.blocks.size());
    for (std::size_t k = 0; k < rests_.size(); ++k)
      rests_[k] = *std::min_element(skins_.begin() + static_cast<std::ptrdiff_t>(network.blocks[k].grain_begin),
                                    skins_.begin() + static_cast<std::ptrdiff_t>(network.blocks[k].grain_end));
  }

  void Skins::add_cycle(const ContactNetwork &network, const std::span<const double> block_steps, const double strain)
  {
    ++n_cycles_;
    for (std::size_t k = 0; k < rests_.size(); ++k)
      rests_[k] -= block_steps[k] + 0.5 * strain * network.reach;
  }

  bool Skins::look(const std::size_t k, const ContactNetwork &network, const Cell &cell, const Grains &grains)
  {
    const GrainBlock &block = network.blocks[k];
    const SkinUse use = compute_skin_use(network, cell, grains, block.grain_begin, block.grain_end);
    rests_[k] = use.rest;
    return use.share > due_share;
  }

  std::size_t Skins::count_bytes() const
  {
    return dem::count_bytes(skins_, ways_, rests_);
  }
} // namespace dem
