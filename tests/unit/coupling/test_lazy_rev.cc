// Law: while the bound of its error allows it, a REV answers s + c : eps without a cycle and forgets nothing of eps.

#include "coupling/lazy_rev.h"
#include "coupling/tensor_conversion.h"

#include "tests/unit/coupling/rev_sample.h"

#include "dem/ageing.h"

#include <gtest/gtest.h>

namespace
{
  using coupling::LazyRev;

  coupling::PointRule make_rule(const double tolerance)
  {
    coupling::PointRule rule;
    rule.lazy_tolerance = tolerance;
    return rule;
  }

  LazyRev make_lazy(const double tolerance)
  {
    return LazyRev(rev_sample::make_rev(rev_sample::make_model()), make_rule(tolerance));
  }

  dealii::Tensor<2, 3> make_increment(const double axial)
  {
    dem::Matrix increment = dem::Matrix::Identity();
    increment(2, 2) += axial;
    increment(0, 2) += 0.3 * axial;
    increment(2, 0) += 0.3 * axial;
    return coupling::to_tensor(increment);
  }

  std::uint64_t count_cycles(const LazyRev &rev)
  {
    return rev.get_rev().get_trial().counters.cycles;
  }

  void step(LazyRev &rev, const dealii::Tensor<2, 3> &increment)
  {
    ASSERT_EQ(rev.evaluate(increment, false).response.status, fem::Status::ok);
    rev.accept();
    rev.commit();
  }

  coupling::RevQuestion make_ageing(const double dt)
  {
    coupling::RevQuestion question;
    question.kind = coupling::QuestionKind::age;
    question.dt = dt;
    return question;
  }

  // At 1 MPa a modulus of some 300 MPa answers to 1e-6 with 3e-4 of the stress, below a tolerance of 1e-2.
  constexpr double small = -1e-6, tolerance = 1e-2;
} // namespace

TEST(LazyRev, WithoutToleranceItIsTheRevBitByBit)
{
  LazyRev lazy = make_lazy(0.);
  dem::Rev plain = rev_sample::make_rev(rev_sample::make_model());
  for (const double axial : {small, -1e-3})
    {
      const auto answer = lazy.evaluate(make_increment(axial), true).response;
      const auto expected = coupling::evaluate(plain, make_increment(axial), true, {}).response;
      EXPECT_TRUE(answer.stress == expected.stress);
      EXPECT_TRUE(answer.tangent == expected.tangent);
      EXPECT_EQ(dem::serialise(lazy.get_rev().get_trial()), dem::serialise(plain.get_trial()));
    }
}

TEST(LazyRev, ANegligibleStrainIsAnsweredFromTheTangentWithoutACycle)
{
  LazyRev lazy = make_lazy(tolerance);
  const auto start = lazy.evaluate(make_increment(0.), true).response;
  const std::uint64_t n_cycles = count_cycles(lazy);
  const auto answer = lazy.evaluate(make_increment(small), false).response;
  EXPECT_EQ(count_cycles(lazy), n_cycles);
  const auto change = start.tangent * coupling::to_symmetric_tensor(coupling::to_matrix(make_increment(small)) -
                                                                    dem::Matrix::Identity());
  EXPECT_GT(change.norm(), 0.);
  EXPECT_LT((answer.stress - start.stress - change).norm(), 1e-9 * change.norm()); // rounding of 1 + 1e-6
  lazy.accept();
  lazy.commit();
  EXPECT_NEAR(lazy.get_committed_state().error_bound, change.norm(), 1e-9 * change.norm());
  EXPECT_LT((lazy.compute_committed_stress() - answer.stress).norm(), 1e-12 * answer.stress.norm()); // rounding
}

TEST(LazyRev, GrainsFollowAllThatWasPendingAtOnce)
{
  LazyRev lazy = make_lazy(tolerance);
  dem::Rev plain = rev_sample::make_rev(rev_sample::make_model());
  for (int i = 0; i < 3; ++i)
    step(lazy, make_increment(small));
  ASSERT_TRUE(lazy.get_committed_state().is_pending());
  const dem::Matrix pending = lazy.get_committed_state().pending;
  const double expected = 1. + 3. * small;
  EXPECT_NEAR(pending(2, 2), expected, 1e-11); // strains squared
  const auto answer = lazy.evaluate(make_increment(-2e-3), false).response;
  const dem::Matrix &rotation = lazy.get_rev().get_baseline().rotation; // one, but for rounding
  const auto last = coupling::find_increment(make_increment(-2e-3), rotation, {});
  const coupling::RevIncrement whole{last->stretch * pending, last->rotation};
  EXPECT_TRUE(answer.stress == coupling::evaluate(plain, whole, false, {}).response.stress);
  lazy.accept();
  lazy.commit();
  EXPECT_FALSE(lazy.get_committed_state().is_pending());
  const auto tally = [&] {
    double numbers[LazyRev::n_tally_numbers];
    lazy.write_tally(numbers);
    return LazyRev::read_tally(numbers);
  }();
  EXPECT_EQ(tally.n_questions, 4.);
  EXPECT_EQ(tally.n_forecasts, 3.);
  EXPECT_EQ(tally.n_checks, 1.);
  EXPECT_GT(tally.largest_error, 0.);
}

TEST(LazyRev, ToleranceHoldsForTheSumOfAllThatIsPending)
{
  LazyRev lazy = make_lazy(tolerance);
  const double stress = coupling::to_symmetric_tensor(lazy.get_rev().get_committed().stress).norm();
  const std::uint64_t n_cycles = count_cycles(lazy);
  for (int i = 0; i < 200 && count_cycles(lazy) == n_cycles; ++i)
    {
      step(lazy, make_increment(small));
      EXPECT_LE(lazy.get_committed_state().error_bound, tolerance * stress);
    }
  EXPECT_GT(count_cycles(lazy), n_cycles); // at the latest after 200 strains of 3e-4 of the stress
}

TEST(LazyRev, RevertDropsWhatIsPendingAndCounted)
{
  LazyRev lazy = make_lazy(tolerance);
  step(lazy, make_increment(small));
  const dem::Matrix pending = lazy.get_committed_state().pending;
  const auto before = lazy.evaluate(make_increment(small), false).response;
  lazy.accept();
  EXPECT_EQ(lazy.change_baseline(make_ageing(1.), {}).n_broken, 0u);
  lazy.evaluate(make_increment(-1e-3), false);
  lazy.accept();
  lazy.revert();
  lazy.commit();
  EXPECT_TRUE(lazy.get_committed_state().pending == pending);
  EXPECT_TRUE(lazy.evaluate(make_increment(small), false).response.stress == before.stress);
}

TEST(LazyRev, CracksGrowAtTheContactStressesThatGrainsWereLeftWith)
{
  LazyRev lazy = make_lazy(tolerance);
  step(lazy, make_increment(small));
  const dem::RevState kept = lazy.get_rev().get_committed();
  const dem::Grains &before = kept.grains;
  const double dt = 0.5 * dem::compute_time_to_batch(before, 1);
  ASSERT_TRUE(std::isfinite(dt));
  ASSERT_FALSE(lazy.needs_catching_up(dt));
  const auto report = lazy.change_baseline(make_ageing(dt), {});
  EXPECT_EQ(report.n_broken, 0u);
  EXPECT_EQ(report.rest.n_cycles, 0u);
  const dem::Grains &after = lazy.get_rev().get_baseline().grains;
  for (std::size_t i = 0; i < before.size(); ++i)
    EXPECT_EQ(after.crack_half_length[i], before.crack_half_length[i] + dt * before.crack_velocity[i]);
  lazy.commit();
  EXPECT_TRUE(lazy.get_committed_state().is_pending());
}

TEST(LazyRev, GrainsCatchUpBeforeOneOfThemBreaks)
{
  LazyRev lazy = make_lazy(tolerance);
  const double to_first = dem::compute_time_to_batch(lazy.get_rev().get_baseline().grains, 1);
  EXPECT_FALSE(lazy.needs_catching_up(2. * to_first)); // nothing is pending
  const auto answer = lazy.evaluate(make_increment(small), false).response;
  lazy.accept();
  EXPECT_FALSE(lazy.needs_catching_up(0.5 * to_first));
  ASSERT_TRUE(lazy.needs_catching_up(2. * to_first));
  EXPECT_FALSE(lazy.catch_up().has_failed());
  dem::Rev plain = rev_sample::make_rev(rev_sample::make_model());
  const auto expected = coupling::evaluate(plain, make_increment(small), false, {}).response;
  EXPECT_EQ(dem::serialise(lazy.get_rev().get_baseline()), dem::serialise(plain.get_trial()));
  lazy.commit();
  double numbers[LazyRev::n_tally_numbers];
  lazy.write_tally(numbers);
  const double error = (answer.stress - expected.stress).norm();
  // The same difference in axes that have not turned: rounding of the stress itself.
  EXPECT_NEAR(LazyRev::read_tally(numbers).largest_error, error, 1e-12 * expected.stress.norm());
}

TEST(LazyRev, AxesTurnWhileGrainsRest)
{
  LazyRev lazy = make_lazy(tolerance), still = make_lazy(tolerance);
  const dem::Matrix q = rev_sample::make_rotation(25.);
  step(still, make_increment(small));
  step(lazy, coupling::to_tensor(dem::Matrix(q * coupling::to_matrix(make_increment(small)))));
  const std::uint64_t n_cycles = count_cycles(lazy);
  const dem::Matrix second = coupling::to_matrix(make_increment(2. * small));
  const auto plain = still.evaluate(coupling::to_tensor(second), true).response;
  const auto turned = lazy.evaluate(coupling::to_tensor(dem::Matrix(q * second * q.transpose())), true).response;
  EXPECT_EQ(count_cycles(lazy), n_cycles);
  const auto expected = coupling::to_symmetric_tensor(q * coupling::to_matrix(plain.stress) * q.transpose());
  EXPECT_LT((turned.stress - expected).norm(), 1e-12 * expected.norm()); // rounding of dR
  EXPECT_LT((turned.tangent - coupling::rotate(plain.tangent, q)).norm(), 1e-12 * plain.tangent.norm());
}

TEST(LazyRev, OneThatWasSentOrStoredAnswersAlike)
{
  LazyRev lazy = make_lazy(tolerance);
  step(lazy, make_increment(small));
  LazyRev stored(dem::Rev(lazy.get_rev().get_model(), lazy.get_rev().get_committed()), make_rule(tolerance));
  double numbers[LazyRev::n_committed_numbers];
  lazy.write_committed(numbers);
  stored.read_committed(numbers);
  lazy.change_baseline(make_ageing(1.), {});
  stored.change_baseline(make_ageing(1.), {});
  lazy.evaluate(make_increment(small), false);
  lazy.accept();
  stored.evaluate(make_increment(small), false);
  stored.accept();
  LazyRev sent = LazyRev::unpack(lazy.get_rev().get_model(), make_rule(tolerance), lazy.pack());
  for (const double axial : {small, -1e-3})
    {
      const auto here = lazy.evaluate(make_increment(axial), true).response;
      for (LazyRev *other : {&stored, &sent})
        {
          const auto there = other->evaluate(make_increment(axial), true).response;
          EXPECT_TRUE(there.stress == here.stress);
          EXPECT_TRUE(there.tangent == here.tangent);
        }
    }
}
