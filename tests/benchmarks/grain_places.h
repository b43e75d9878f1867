#pragma once

#include "dem/contact_network.h"

#include <cmath>
#include <cstdint>

/**
 * Ways to say where grains are and how deep two of them overlap, in double and in single precision. Each answers the
 * same four questions: `follow` a cell that has been strained, `move` a grain, `separate` a pair of the network, and
 * where a grain is (`get_fraction`). They hold for as long as their network does.
 */
namespace benchmarks
{
  template <typename Real>
  using Triple = Eigen::Matrix<Real, 3, 1>;
  template <typename Real>
  using Square = Eigen::Matrix<Real, 3, 3>;

  /** How two grains of a pair lie. */
  template <typename Real>
  struct Separation
  {
    Triple<Real> branch; ///< x_b - x_a [m]
    Real distance;       ///< |branch| [m]
    Real overlap;        ///< Ra + Rb - distance [m]
  };

  /** Everything in double, as in dem; with Real = float "double positions, float everything else". */
  template <typename RealOfForces>
  class DoublePlaces
  {
  public:
    using Real = RealOfForces;

    DoublePlaces(const dem::RevState &state, const dem::ContactNetwork &network)
        : network_(network), place_(state.grains.place.begin(), state.grains.place.end())
    {
      follow(state.cell);
    }

    void follow(const dem::Cell &cell)
    {
      edges_ = cell.edges;
      to_fraction_ = cell.edges.inverse();
    }

    void move(const std::size_t i, const Triple<Real> &displacement)
    {
      const dem::Vector step = to_fraction_ * displacement.template cast<double>();
      place_[i] = {place_[i].x + step.x(), place_[i].y + step.y(), place_[i].z + step.z(), place_[i].w};
    }

    Separation<Real> separate(const std::size_t k) const
    {
      dem::Vector apart = get_fraction(network_.b[k]) - get_fraction(network_.a[k]);
      const dem::Vector branch = edges_ * (apart - apart.array().rint().matrix());
      const double distance = branch.norm();
      return {branch.cast<Real>(), static_cast<Real>(distance), static_cast<Real>(network_.radius_sum[k] - distance)};
    }

    dem::Vector get_fraction(const std::size_t i) const { return dem::to_vector(place_[i]); }

  private:
    const dem::ContactNetwork &network_;
    std::vector<dem::Row> place_;
    dem::Matrix edges_, to_fraction_;
  };

  inline constexpr double n_counts = 4294967296.; ///< of an edge: 2^32; counts wrap as periodic images do

  /** 32-bit fractions of the cell; differences are exact integers. */
  class CountedPlaces
  {
  public:
    using Counts = Eigen::Matrix<std::int32_t, 3, 1>;

    /** @param has_remainder  what a count is too coarse for is kept and added to the next step */
    CountedPlaces(const dem::RevState &state, const bool has_remainder)
        : counts_(state.grains.size()), remainder_(has_remainder ? state.grains.size() : 0, Triple<float>::Zero())
    {
      for (std::size_t i = 0; i < counts_.size(); ++i)
        for (int axis = 0; axis < 3; ++axis)
          {
            const double fraction = dem::to_vector(state.grains.place[i])[axis];
            const double exact = (fraction - std::floor(fraction)) * n_counts, whole = std::rint(exact);
            counts_[i][axis] = static_cast<std::uint32_t>(static_cast<std::int64_t>(whole));
            if (has_remainder)
              remainder_[i][axis] = static_cast<float>(exact - whole);
          }
    }

    void move(const std::size_t i, Triple<float> step) ///< [counts]
    {
      if (!remainder_.empty())
        step += remainder_[i];
      for (int axis = 0; axis < 3; ++axis)
        {
          const float whole = std::rint(step[axis]);
          counts_[i][axis] += static_cast<std::uint32_t>(static_cast<std::int64_t>(whole));
          if (!remainder_.empty())
            remainder_[i][axis] = step[axis] - whole;
        }
    }

    /** The shortest way from a to b around the cell. */
    Counts subtract(const std::size_t a, const std::size_t b) const
    {
      return (counts_[b] - counts_[a]).cast<std::int32_t>();
    }

    /** What the remainders add to it. */
    Triple<float> subtract_remainders(const std::size_t a, const std::size_t b) const
    {
      return remainder_.empty() ? Triple<float>(Triple<float>::Zero()) : Triple<float>(remainder_[b] - remainder_[a]);
    }

    dem::Vector get_fraction(const std::size_t i) const
    {
      const dem::Vector whole = counts_[i].cast<double>();
      return (remainder_.empty() ? whole : dem::Vector(whole + remainder_[i].cast<double>())) / n_counts;
    }

  private:
    std::vector<Eigen::Matrix<std::uint32_t, 3, 1>> counts_;
    std::vector<Triple<float>> remainder_;
  };

  /** The overlap as a difference of two floats hundreds of times as large: Ra + Rb - |branch|. */
  template <bool has_remainder>
  class FractionPlaces
  {
  public:
    using Real = float;

    FractionPlaces(const dem::RevState &state, const dem::ContactNetwork &network)
        : network_(network), places_(state, has_remainder)
    {
      follow(state.cell);
    }

    void follow(const dem::Cell &cell)
    {
      edges_ = (cell.edges / n_counts).cast<float>();
      to_counts_ = (n_counts * cell.edges.inverse()).cast<float>();
    }

    void move(const std::size_t i, const Triple<float> &displacement) { places_.move(i, to_counts_ * displacement); }

    Separation<float> separate(const std::size_t k) const
    {
      const std::size_t a = network_.a[k], b = network_.b[k];
      const Triple<float> apart = places_.subtract(a, b).cast<float>() + places_.subtract_remainders(a, b);
      const Triple<float> branch = edges_ * apart;
      const float distance = branch.norm();
      return {branch, distance, static_cast<float>(network_.radius_sum[k]) - distance};
    }

    dem::Vector get_fraction(const std::size_t i) const { return places_.get_fraction(i); }

  private:
    const dem::ContactNetwork &network_;
    CountedPlaces places_;
    Square<float> edges_, to_counts_;
  };

  /**
   * The overlap as the one when the network was built, found in double, plus its change since, in float: the change is
   * small, and so is what float takes from it. With b0 the branch then and D its change,
   * |b0 + D| - |b0| = (2 b0 + D) . D / (|b0 + D| + |b0|).
   */
  template <bool has_remainder>
  class ReferredPlaces
  {
  public:
    using Real = float;

    ReferredPlaces(const dem::RevState &state, const dem::ContactNetwork &network)
        : network_(network), places_(state, has_remainder), edges_then_(state.cell.edges), pairs_(network.size())
    {
      follow(state.cell);
      for (std::size_t k = 0; k < network.size(); ++k)
        {
          const std::size_t a = network.a[k], b = network.b[k];
          Reference &pair = pairs_[k];
          pair.apart = places_.subtract(a, b);
          const dem::Vector apart =
              pair.apart.template cast<double>() + places_.subtract_remainders(a, b).cast<double>();
          const double distance = (state.cell.edges * apart).norm() / n_counts;
          pair.overlap = static_cast<float>(network.radius_sum[k] - distance);
          pair.remainder = places_.subtract_remainders(a, b);
        }
    }

    void follow(const dem::Cell &cell)
    {
      edges_ = (cell.edges / n_counts).cast<float>();
      stretch_ = ((cell.edges - edges_then_) / n_counts).cast<float>();
      to_counts_ = (n_counts * cell.edges.inverse()).cast<float>();
    }

    void move(const std::size_t i, const Triple<float> &displacement) { places_.move(i, to_counts_ * displacement); }

    Separation<float> separate(const std::size_t k) const
    {
      const std::size_t a = network_.a[k], b = network_.b[k];
      const Reference &pair = pairs_[k];
      const Triple<float> then = pair.apart.template cast<float>();
      const CountedPlaces::Counts moved = places_.subtract(a, b) - pair.apart;
      const Triple<float> since = moved.cast<float>() + (places_.subtract_remainders(a, b) - pair.remainder);
      const Triple<float> change = edges_ * since + stretch_ * then;
      const Triple<float> branch_then = (edges_ - stretch_) * then, branch = branch_then + change;
      const float distance = branch.norm(), distance_then = static_cast<float>(network_.radius_sum[k]) - pair.overlap;
      const float longer = (branch_then + branch).dot(change) / (distance + distance_then);
      return {branch, distance, pair.overlap - longer};
    }

    dem::Vector get_fraction(const std::size_t i) const { return places_.get_fraction(i); }

  private:
    /** A pair when the network was built. */
    struct Reference
    {
      CountedPlaces::Counts apart;
      Triple<float> remainder;
      float overlap; ///< [m]
    };

    const dem::ContactNetwork &network_;
    CountedPlaces places_;
    const dem::Matrix edges_then_;
    Square<float> edges_, stretch_, to_counts_;
    std::vector<Reference> pairs_;
  };
} // namespace benchmarks
