#include "fem/secant_memory.h"

namespace fem
{
  namespace
  {
    // Below this share of its length a correction counts as a combination of newer ones: what is left of it is the
    // noise of evaluations that come to rest only so far, and the fit would divide by it.
    constexpr double dependence = 1e-2;
  } // namespace

  bool SecantMemory::learn(const SecantPair &pair)
  {
    if (parameters_.kind == SecantKind::none)
      return false;
    const double step_squared = pair.step * pair.step;
    if (!(step_squared > 0.))
      return false;

    Vector predicted(pair.step); // the step that the present inverse would have expected from this change
    solve_(pair.change, predicted);
    if (parameters_.kind == SecantKind::broyden)
      apply_broyden(predicted);
    const double alignment = pair.step * predicted;
    if (!(alignment > step_squared / parameters_.largest_softening))
      return false;

    if (terms_.size() >= parameters_.max_pairs)
      {
        if (parameters_.kind == SecantKind::broyden)
          terms_.clear(); // each term builds on those before it
        else
          terms_.erase(terms_.begin());
      }
    if (parameters_.kind == SecantKind::broyden)
      {
        predicted.sadd(-1. / alignment, 1. / alignment, pair.step);
        terms_.push_back({pair.step, predicted});
      }
    else
      terms_.push_back({pair.step, predicted});
    return true;
  }

  void SecantMemory::apply(const Vector &residual, Vector &direction) const
  {
    solve_(residual, direction);
    if (parameters_.kind == SecantKind::broyden)
      apply_broyden(direction);
    else if (parameters_.kind == SecantKind::anderson)
      apply_anderson(direction);
  }

  void SecantMemory::apply_broyden(Vector &direction) const
  {
    for (const Term &term : terms_)
      direction.add(term.step * direction, term.correction);
  }

  void SecantMemory::apply_anderson(Vector &direction) const
  {
    std::vector<Term> basis; // corrections orthonormal, the newest pair first; steps combined likewise
    Vector rest(direction);
    for (auto term = terms_.rbegin(); term != terms_.rend(); ++term)
      {
        Term added = *term;
        const double length = added.correction.l2_norm();
        for (const Term &known : basis)
          {
            const double share = known.correction * added.correction;
            added.correction.add(-share, known.correction);
            added.step.add(-share, known.step);
          }
        const double remaining = added.correction.l2_norm();
        if (remaining <= dependence * length)
          continue;
        added.correction /= remaining;
        added.step /= remaining;
        const double share = added.correction * rest;
        rest.add(-share, added.correction);
        direction.add(share, added.step, -share, added.correction);
        basis.push_back(added);
      }
  }
} // namespace fem
