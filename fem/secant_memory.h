#pragma once

#include "fem/linear_solver.h"

#include <functional>
#include <vector>

namespace fem
{
  enum class SecantKind
  {
    none,
    broyden, ///< good Broyden, Sherman-Morrison form: J+ = J + (y - J s) s^T / s^T s
    anderson ///< all stored pairs at once by least squares (multisecant)
  };

  struct SecantParameters
  {
    SecantKind kind = SecantKind::broyden;
    unsigned int max_pairs = 20; ///< kept within an equilibrium, >= 1
    unsigned int n_carried = 1;  ///< total pairs of past equilibria that the next one starts from, >= 0
    double largest_softening =
        10.; ///< a pair softer than J0 by more than this teaches nothing [-], > 1: it would step far
  };

  /** A step and the change of the residual that it brought. */
  struct SecantPair
  {
    Vector step;   ///< s [m]
    Vector change; ///< y [N]; prescribed entries [m]
  };

  using SecantHistory = std::vector<SecantPair>;

  /** Corrections of J0^-1 by what has been seen of the true residual. */
  class SecantMemory
  {
  public:
    /** x = J0^-1 r, as solve(r, x). */
    using Solve = std::function<void(const Vector &, Vector &)>;

    SecantMemory(const SecantParameters &parameters, Solve solve) : parameters_(parameters), solve_(std::move(solve)) {}

    /** Learns from a pair; false: it was of no use (see largest_softening, or a zero step). */
    bool learn(const SecantPair &pair);

    /** Goes back to J0. */
    void forget() { terms_.clear(); }

    /** direction = H r, H the corrected inverse. */
    void apply(const Vector &residual, Vector &direction) const;

  private:
    /** Broyden: H+ = H + correction step^T H. Anderson: a pair (step, H0 y), the latter in `correction`. */
    struct Term
    {
      Vector step;
      Vector correction;
    };

    void apply_broyden(Vector &direction) const;
    void apply_anderson(Vector &direction) const;

    SecantParameters parameters_;
    Solve solve_;
    std::vector<Term> terms_;
  };
} // namespace fem
