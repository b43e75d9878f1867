#include "dem/burgers_contact.h"

#include <gtest/gtest.h>

#include <cmath>

namespace
{
  using namespace dem;

  const BurgersElements elements{2e11, 3e6, 4e9};

  /** J(t) without the spring of the contact: t/Cm + (1 - exp(-t Kk/Ck))/Kk [m/N]. */
  double compute_creep_function(const double time)
  {
    return time / 2e11 + (1. - std::exp(-time * 3e6 / 4e9)) / 3e6;
  }

  TEST(BurgersContact, UnderAConstantForceItFollowsTheCreepFunction)
  {
    // Law: u(t) = f J(t), by one step or by unequal ones of a decade and more. Tolerance: rounding.
    for (const double end : {1., 1e3, 1e5, 1e8})
      {
        BurgersDisplacement<double> sum{0., 0.};
        double time = 0.;
        for (const double share : {1e-6, 1e-3, 0.1, 0.35, 1.})
          {
            const auto grown = compute_creep(elements, 1.7, sum.retarded, share * end - time);
            sum.viscous += grown.viscous;
            sum.retarded += grown.retarded;
            time = share * end;
          }
        EXPECT_NEAR((sum.viscous + sum.retarded) / (1.7 * compute_creep_function(end)), 1., 1e-12) << end;
      }
  }

  TEST(BurgersContact, UnloadedItComesBackButForTheDashpot)
  {
    // Law (Boltzmann): force f until t1, none after: u = f (J(t) - J(t - t1)), which leaves f t1/Cm. Tolerance:
    // rounding of the difference.
    const double t1 = 2e3;
    BurgersDisplacement<double> sum = compute_creep(elements, 1.7, 0., t1);
    for (const double later : {10., 1e3, 1e4, 1e6})
      {
        const double back = compute_creep(elements, 0., sum.retarded, later).retarded;
        const double expected = 1.7 * (compute_creep_function(t1 + later) - compute_creep_function(later));
        EXPECT_NEAR((sum.viscous + sum.retarded + back) / expected, 1., 1e-9) << later;
      }
    EXPECT_EQ(compute_creep(elements, 0., sum.retarded, 1.).viscous, 0.);
  }

  TEST(BurgersContact, AVectorCreepsComponentByComponent)
  {
    // Law: the elements are isotropic in the contact plane: each component is the scalar law, to the bit.
    const Vector force(1., -2., 0.5), retarded(1e-8, 0., -1e-7);
    const auto grown = compute_creep(elements, force, retarded, 700.);
    for (int k = 0; k < 3; ++k)
      {
        const auto alone = compute_creep(elements, force[k], retarded[k], 700.);
        EXPECT_EQ(grown.viscous[k], alone.viscous);
        EXPECT_EQ(grown.retarded[k], alone.retarded);
      }
  }
} // namespace
