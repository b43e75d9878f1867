#include "dem/rev.h"
#include "dem/stopwatch.h"

#include "dem/rev_snapshot.h"
#include "dem/splitting.h"
#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <limits>

namespace
{
  using namespace dem;
  using namespace dem::cases;

  Rev make_loaded_rev()
  {
    return Rev(RevModel{}, get_loaded_state());
  }

  Matrix make_stretch()
  {
    Matrix stretch;
    stretch << 0.9995, 0.0002, 0., 0.0002, 1.0001, 0.0001, 0., 0.0001, 0.999;
    return stretch;
  }

  TEST(Rev, AStretchOfOneKeepsEveryBit)
  {
    // Law: a question without strain runs no cycle and returns the baseline.
    Rev rev = make_loaded_rev();
    rev.deform(make_stretch());
    const RestReport report = rev.deform(Matrix::Identity());
    EXPECT_EQ(report.status, RestStatus::at_rest);
    EXPECT_EQ(report.n_cycles, 0u);
    EXPECT_EQ(report.unbalanced_ratio, get_loaded_state().unbalanced_ratio);
    EXPECT_TRUE(are_equal_bits(rev.get_trial(), get_loaded_state()));
  }

  TEST(Rev, QuestionsHaveTheSameMemoryAgainAndAgain)
  {
    // Law: a trial begins as a copy of the baseline into a block that is there; the first question has found out how
    // large it must be, those after it and taking back ask for none.
    Rev rev = make_loaded_rev();
    rev.deform(make_stretch());
    const std::byte *const block = rev.peek_trial().get_used_block().data();
    for (int i = 0; i < 3; ++i)
      {
        rev.deform(make_stretch());
        EXPECT_EQ(rev.peek_trial().get_used_block().data(), block);
        rev.revert();
        EXPECT_EQ(rev.peek_trial().get_used_block().data(), block);
      }
    rev.deform(make_stretch());
    EXPECT_GT(rev.peek_trial().contacts.size(), rev.get_baseline().contacts.size()) << "a test that asks for no room";
  }

  TEST(Rev, StrainsThatDifferByRoundingGetTheSameBits)
  {
    // Law: the strain of a cell lies on a grid; what the grid leaves out is kept in the deformation and never adds up.
    constexpr double grid = 0x1p-34;
    Rev one = make_loaded_rev(), other = make_loaded_rev();
    const Matrix rounding = Matrix::Constant(1e-15);
    one.deform(make_stretch());
    other.deform(make_stretch() + rounding);
    EXPECT_TRUE(one.get_trial().stress == other.get_trial().stress);
    EXPECT_LT((other.get_trial().cell.deformation - one.get_trial().cell.deformation - rounding).norm(), 1e-15);

    // Ten strains of a fifth of the grid each move the cell twice as far as the grid, in two of the questions.
    Matrix fifth = Matrix::Identity();
    fifth(0, 0) += 0.2 * grid;
    const double width = one.get_baseline().cell.edges(0, 0);
    unsigned int n_moves = 0;
    for (unsigned int k = 0; k < 10; ++k)
      {
        n_moves += one.deform(fifth).n_cycles > 0;
        one.accept();
      }
    EXPECT_EQ(n_moves, 2u);
    EXPECT_NEAR(one.get_baseline().cell.edges(0, 0) / width - 1., 2 * grid,
                0.1 * grid); // the edge's own stretch is not quite 1
  }

  TEST(Rev, EveryQuestionStartsAtTheBaseline)
  {
    // Law: the answer depends on the baseline and the question, not on the questions before; fracture is frozen.
    Rev rev = make_loaded_rev();
    ASSERT_EQ(rev.deform(make_stretch()).status, RestStatus::at_rest);
    const RevState first = rev.get_trial();
    rev.control(make_oedometer(12e6));
    rev.deform(make_stretch());
    EXPECT_TRUE(are_equal_bits(rev.get_trial(), first));
    EXPECT_EQ(first.grains.size(), n_grains);
    EXPECT_EQ(first.time, 0.);
    EXPECT_TRUE(are_equal_bits(rev.get_baseline(), get_loaded_state()));
    EXPECT_TRUE(are_equal_bits(rev.get_committed(), get_loaded_state()));
  }

  TEST(Rev, ATrialsCracksAreThoseOfItsOwnContacts)
  {
    // Law: whether somebody looks at a trial or it is accepted unseen, its cracks grow as its own contacts say; a trial
    // that is dropped leaves nothing behind.
    Rev seen = make_loaded_rev(), unseen = make_loaded_rev();
    seen.deform(make_stretch());
    const RevState trial = seen.get_trial();
    RevState expected = trial;
    update_crack_velocities(expected.grains, list_contacts(expected, seen.get_law()), seen.get_model().fracture);
    EXPECT_TRUE(are_equal_bits(trial, expected));
    EXPECT_NE(trial.grains.largest_contact_stress, get_loaded_state().grains.largest_contact_stress);

    unseen.deform(make_stretch());
    EXPECT_TRUE(unseen.peek_trial().stress == trial.stress);
    unseen.deform(Matrix::Identity());
    EXPECT_TRUE(are_equal_bits(unseen.get_trial(), get_loaded_state()));
    unseen.deform(make_stretch());
    unseen.accept();
    EXPECT_TRUE(are_equal_bits(unseen.get_baseline(), trial));
  }

  TEST(Rev, AcceptCommitAndRevertMoveTheRightStates)
  {
    // Law: accept makes the trial the baseline, commit the baseline history, revert drops baseline and trial.
    Rev rev = make_loaded_rev();
    rev.deform(make_stretch());
    const RevState answer = rev.get_trial();
    rev.accept();
    EXPECT_TRUE(are_equal_bits(rev.get_baseline(), answer));
    EXPECT_TRUE(are_equal_bits(rev.get_committed(), get_loaded_state()));
    rev.revert();
    EXPECT_TRUE(are_equal_bits(rev.get_baseline(), get_loaded_state()));
    EXPECT_TRUE(are_equal_bits(rev.get_trial(), get_loaded_state()));

    rev.deform(make_stretch());
    rev.accept();
    rev.commit();
    rev.age(rev.compute_time_to_next_batch());
    rev.revert();
    EXPECT_TRUE(are_equal_bits(rev.get_committed(), answer));
    EXPECT_TRUE(are_equal_bits(rev.get_baseline(), answer));
  }

  TEST(Rev, AgeingMovesTheBaselineAlone)
  {
    // Law: the baseline ages at frozen forces: cracks by v dt, the batch splits, time and counters go on; the rest
    // waits for equilibrium. A REV aged to its batch breaks it, a shade earlier nothing.
    Rev rev = make_loaded_rev();
    const double time = rev.compute_time_to_next_batch();
    ASSERT_LT(time, std::numeric_limits<double>::infinity());
    EXPECT_EQ(rev.age(time * (1. - 1e-9)), 0u);
    EXPECT_EQ(rev.get_baseline().grains.size(), n_grains);
    rev.revert();
    EXPECT_EQ(rev.age(time), 1u);
    EXPECT_EQ(rev.get_baseline().grains.size(), n_grains + 13);
    EXPECT_EQ(rev.get_baseline().time, time);
    EXPECT_EQ(rev.get_baseline().counters.broken_delayed, 1u);
    EXPECT_EQ(rev.get_baseline().counters.broken_instant, 0u);
    EXPECT_EQ(rev.get_committed().grains.size(), n_grains);

    ASSERT_EQ(rev.relax().status, RestStatus::at_rest);
    EXPECT_EQ(rev.get_baseline().cell.edges, get_loaded_state().cell.edges); // at held strain
    EXPECT_LT(rev.get_baseline().unbalanced_ratio, 1e-4);
    EXPECT_GT(rev.get_baseline().stress(2, 2), get_loaded_state().stress(2, 2)); // a grain less to bear it
  }

  TEST(Rev, SplitsTheMostOverstressedFirstAndAtMostABatch)
  {
    // Law: at equilibrium F > F_lim breaks, most overstressed first, one batch at once.
    RevState weak = get_loaded_state();
    for (const std::size_t i : {2, 5, 9})
      weak.grains.strength[i] = weak.grains.largest_contact_stress[i] / (1. + 0.1 * static_cast<double>(i));
    RevModel model;
    model.fracture.batch_limit = 2;
    Rev rev(model, weak);
    const std::size_t n = rev.count_overstressed();
    ASSERT_GE(n, 3u);
    const auto listed = list_overstressed(weak.grains, model.fracture);
    EXPECT_EQ(rev.split_overstressed(), 2u);
    EXPECT_EQ(rev.get_baseline().counters.broken_instant, 2u);
    EXPECT_EQ(rev.get_baseline().grains.size(), n_grains + 26);
    EXPECT_EQ(rev.count_overstressed(), n - 2);
    for (const std::size_t place : {listed[0], listed[1]})
      EXPECT_EQ(std::count(rev.get_baseline().grains.parent.begin(), rev.get_baseline().grains.parent.end(),
                           weak.grains.id[place]),
                n_siblings);
  }

  /** Asks all kinds of questions and answers them, from a state. */
  RevState live_on(const RevState &state)
  {
    Rev rev(RevModel{}, state);
    rev.age(rev.compute_time_to_next_batch());
    rev.relax();
    rev.control(make_oedometer(10e6));
    rev.accept();
    rev.split_overstressed();
    rev.deform(make_stretch());
    rev.accept();
    return rev.get_baseline();
  }

  TEST(Rev, LivesOnFromItsBytesAsIfNothingHadHappened)
  {
    // Law: a REV's future depends on its state and parameters alone: through bytes and through a snapshot, bit by bit.
    Rev rev = make_loaded_rev();
    rev.age(rev.compute_time_to_next_batch());
    rev.relax();
    const RevState state = rev.get_baseline();
    const RevState future = live_on(state);
    ASSERT_GT(future.grains.size(), state.grains.size());
    EXPECT_TRUE(are_equal_bits(live_on(deserialise(serialise(state))), future));

    const std::string file =
        std::filesystem::temp_directory_path() / ("slowsand_rev_" + std::to_string(getpid()) + ".h5");
    write_snapshot(file, state, list_contacts(state, rev.get_law()), {1, 0});
    const RevState read = read_snapshot(file).state;
    std::filesystem::remove(file);
    EXPECT_TRUE(are_equal_bits(live_on(read), future));
  }

  TEST(Rev, EachRevDrawsItsOwnStrengths)
  {
    // Law: identical packings, different REVs: other strengths and cracks for each grain; the same REV the same ones.
    RevModel model;
    model.identity = {5, 0};
    const Rev first = make_rev(model, get_packing().state), again = make_rev(model, get_packing().state);
    model.identity.rev = 1;
    const Rev second = make_rev(model, get_packing().state);
    EXPECT_TRUE(are_equal_bits(first.get_committed(), again.get_committed()));
    const Grains &one = first.get_committed().grains, &other = second.get_committed().grains;
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        EXPECT_NE(one.strength[i], other.strength[i]);
        EXPECT_NE(one.crack_half_length[i], other.crack_half_length[i]);
        EXPECT_EQ(one.place[i].x, other.place[i].x);
      }
    EXPECT_EQ(first.get_committed().cell.deformation, Matrix::Identity());
    EXPECT_EQ(first.get_committed().counters.next_id, n_grains);
  }

  TEST(Rev, TangentsAreThoseOfTheBaseline)
  {
    // Law: the affine estimate bounds the condensed one from above; neither looks at the trial.
    Rev rev = make_loaded_rev();
    const Tangent condensed = rev.compute_tangent(rev.get_baseline(), TangentKind::condensed);
    const Tangent affine = rev.compute_tangent(rev.get_baseline(), TangentKind::affine);
    for (int k = 0; k < 6; ++k)
      EXPECT_LT(condensed(k, k), affine(k, k));
    EXPECT_GT(condensed(2, 2), 0.);
    rev.deform(make_stretch());
    EXPECT_EQ(rev.compute_tangent(rev.get_baseline(), TangentKind::condensed), condensed);
    rev.accept();
    EXPECT_NE(rev.compute_tangent(rev.get_baseline(), TangentKind::condensed), condensed);
  }

  TEST(Rev, SaysWhatItSpendsAndHolds)
  {
    // Law: times by part are not negative and no longer than the whole; memory of the three states and of a run to
    // rest, contacts included, is at most 1500 bytes a grain.
    const dem::Clock::time_point start = dem::Clock::now();
    Rev rev = make_rev(RevModel{}, get_packing().state);
    rev.deform(Vector(1., 1., 0.998).asDiagonal());
    rev.accept();
    rev.compute_tangent(rev.get_baseline(), TangentKind::condensed);
    double sum = 0.;
    for (const double seconds : rev.get_profile().seconds)
      {
        EXPECT_GE(seconds, 0.);
        sum += seconds;
      }
    EXPECT_LE(sum, dem::measure_seconds_since(start));
    for (const Part part : {Part::forces, Part::search, Part::motion, Part::servo, Part::tangent, Part::copy})
      EXPECT_GT(rev.get_profile()[part], 0.) << part_names[static_cast<std::size_t>(part)];
    const std::size_t n_grains = rev.get_baseline().grains.size();
    EXPECT_GT(rev.count_bytes(), 3 * n_grains * (3 * sizeof(Row) + 2 * sizeof(ContactMemory))); // two contacts a grain
    EXPECT_LT(rev.count_bytes(), 1500 * n_grains);
  }

  TEST(Rev, FracturesOfACommittedStepAreListed)
  {
    // Law: what split between two commits, as it was before, with cause and time; what was rolled back is not among it,
    // nor what split before.
    Rev rev = make_loaded_rev();
    const Grains &whole = get_loaded_state().grains;
    const double dt = rev.compute_time_to_next_batch();
    rev.age(dt);
    rev.revert();
    rev.commit();
    EXPECT_TRUE(rev.get_last_fractures().empty());

    const std::size_t n = rev.age(dt);
    ASSERT_GE(n, 1u);
    rev.commit();
    const std::vector<Fracture> &fractures = rev.get_last_fractures();
    ASSERT_EQ(fractures.size(), n);
    const Grains &now = rev.get_committed().grains;
    for (const Fracture &fracture : fractures)
      {
        const auto was = std::find(whole.id.begin(), whole.id.end(), fracture.grain);
        ASSERT_NE(was, whole.id.end());
        const std::size_t place = static_cast<std::size_t>(was - whole.id.begin());
        EXPECT_EQ(fracture.time, dt);
        EXPECT_EQ(fracture.cause, BreakageCause::delayed);
        EXPECT_EQ(fracture.diameter, 2. * whole.place[place].w);
        EXPECT_EQ(fracture.strength, whole.strength[place]);
        EXPECT_EQ(fracture.generation, 0u);
        EXPECT_EQ(std::find(now.id.begin(), now.id.end(), fracture.grain), now.id.end());
      }
    rev.commit();
    EXPECT_TRUE(rev.get_last_fractures().empty());
  }
} // namespace
