#include "dem/laboratory.h"

#include "dem/attempt_judgement.h"
#include "dem/stage_path.h"

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    enum class StepOutcome
    {
      ok,
      too_large,
      given_up
    };

    /** Equilibria that a mean stress may take to come back to its value: each leaves less than a half of the error
     * while the grains still bear load, so that a tenth of these do. */
    constexpr std::size_t correction_cap = 30;

    struct Step
    {
      double share = 0.; ///< of the load at its end
      double dt = 0.;    ///< [s]
      bool may_be_halved = false;
      std::optional<CrackClock> clock; ///< scaled time: dt passes within the dynamic computation
    };

    /** One stage at work: try a step, commit it or roll back and halve. */
    class StageRunner
    {
    public:
      StageRunner(Rev &rev, const LaboratoryStage &stage, const LaboratoryRule &rule, LaboratoryPosition &position)
          : rev_(rev), stage_(stage), rule_(rule), position_(position), nominal_(1. / std::max(1u, stage.n_increments))
      {}

      /** @param before  the stage before this one, if any: stresses that it controlled are held at their targets, not
       * at what the servo's tolerance left of them */
      void start(const LaboratoryStage *before)
      {
        const RevState &state = rev_.get_committed();
        Matrix stress = 0.5 * (state.stress + state.stress.transpose());
        if (before != nullptr && is_put_back(*before))
          stress = position_.stress_at_start; // of the search: this stage starts where it did
        else if (before != nullptr)
          {
            const CellControl control = compute_control(*before, position_, 1., state);
            const Matrix mean = stress.trace() / 3. * Matrix::Identity();
            for (int k = 0; k < 3; ++k)
              if (control.is_stress_controlled[k])
                stress(k, k) = control.follows_volume ? mean(k, k) : control.target_stress(k, k);
          }
        position_.share = is_held(stage_) ? 1. : 0.;
        position_.share_step = nominal_;
        position_.time_in_stage = 0.;
        position_.n_cuts = 0;
        position_.stress_at_start = stress;
        position_.strain_at_start = compute_logarithmic_strain(state.cell.deformation);
        if (stage_.kind == StageKind::strength_search)
          position_.strength = position_.strain_at_strength = 0.;
        if (is_put_back(stage_))
          position_.before_search = state;
      }

      bool is_finished() const { return position_.share >= 1. && position_.time_in_stage >= stage_.duration; }

      double compute_fraction() const
      {
        if (!is_held(stage_))
          return position_.share;
        const double decades = std::log10(stage_.duration / stage_.first_output) + 1.;
        return std::clamp(1. + std::log10(std::max(position_.time_in_stage, 1e-300) / stage_.duration) / decades, 0.,
                          1.);
      }

      /** Steps until one is committed; its observations are those of the committed attempt alone.
       *  @param tell  called with what each attempt cost, committed or not */
      LaboratoryOutcome advance(std::vector<Observation> &observations,
                                const std::function<void(const AttemptEffort &)> &tell)
      {
        while (true)
          {
            observations.clear();
            const Step step = choose_step();
            const StepOutcome outcome = attempt(step, observations);
            effort_.is_committed = outcome == StepOutcome::ok;
            if (tell)
              tell(effort_);
            if (effort_.is_committed)
              {
                commit(step);
                return LaboratoryOutcome::finished;
              }
            rev_.revert();
            if (outcome == StepOutcome::given_up)
              return failure_;
            shorten();
          }
      }

      /** Dynamic computations of the last step, if time passed in it. */
      const std::vector<DynamicRecord> &get_dynamics() const { return dynamics_; }

    private:
      Step choose_step() const
      {
        Step step;
        if (is_held(stage_) && rev_.get_model().creep.kind == CreepKind::scaled_time)
          return choose_scaled_step();
        const double to_batch = stage_.duration > 0. ? rev_.compute_longest_jump(position_.n_cuts) : 0.;
        if (is_held(stage_))
          {
            step.share = 1.;
            step.dt = std::min(to_batch, compute_time_to_output(stage_, position_.time_in_stage));
            step.may_be_halved = rev_.can_cut_jump(position_.n_cuts);
            return step;
          }
        // The last share is reached to the last bit, whatever the sum of steps rounds to.
        const double next = position_.share + position_.share_step;
        step.share = next > 1. - 1e-12 ? 1. : next;
        step.dt = stage_.duration > 0. ? std::max(0., step.share * stage_.duration - position_.time_in_stage) : 0.;
        if (to_batch < step.dt)
          {
            step.dt = to_batch;
            step.share = std::min(step.share, (position_.time_in_stage + to_batch) / stage_.duration);
          }
        step.may_be_halved = can_halve_load() || (stage_.duration > 0. && rev_.can_cut_jump(position_.n_cuts));
        return step;
      }

      /** To the next output, at rest at the end of the stage alone. */
      Step choose_scaled_step() const
      {
        Step step;
        step.share = 1.;
        step.dt = compute_time_to_output(stage_, position_.time_in_stage);
        step.clock = {rev_.get_model().creep.time_scale, step.dt, is_last(step)};
        return step;
      }

      /** True for the step with which the stage ends. */
      bool is_last(const Step &step) const
      {
        return step.dt >= (stage_.duration - position_.time_in_stage) * (1. - 1e-14);
      }

      bool can_halve_load() const { return position_.share_step > nominal_ * rule_.smallest_share; }

      void shorten()
      {
        if (!is_held(stage_) && can_halve_load())
          position_.share_step *= 0.5;
        if (rev_.can_cut_jump(position_.n_cuts))
          ++position_.n_cuts;
      }

      void commit(const Step &step)
      {
        rev_.commit();
        position_.share = step.share;
        // The end of a stage is reached to the last bit, whatever the sum of steps rounds to.
        position_.time_in_stage = is_last(step) ? stage_.duration : position_.time_in_stage + step.dt + dynamic_time_;
        position_.share_step = std::min(nominal_, 2. * position_.share_step);
        position_.n_cuts = position_.n_cuts > 0 ? position_.n_cuts - 1 : 0;
        if (stage_.kind == StageKind::strength_search)
          follow_strength();
      }

      /** Keeps the largest q at rest, and ends the search once q has fallen far enough below it. */
      void follow_strength()
      {
        const RevState &state = rev_.get_committed();
        const double deviator = compute_deviator(state.stress);
        if (deviator > position_.strength)
          {
            position_.strength = deviator;
            position_.strain_at_strength = compute_logarithmic_strain(state.cell.deformation)(2, 2);
          }
        else if (deviator <= (1. - stage_.strength_drop) * position_.strength)
          {
            position_.share = 1.;
            position_.time_in_stage = stage_.duration;
          }
      }

      StepOutcome attempt(const Step &step, std::vector<Observation> &observations)
      {
        dynamic_time_ = 0.;
        effort_ = AttemptEffort{};
        effort_.stage = position_.stage;
        dynamics_.clear();
        if (step.clock)
          return attempt_in_scaled_time(step, observations);
        DynamicRecord record_of_round = begin_record(step.dt);
        if (step.dt > 0.)
          record_of_round.n_broken = age(step.dt, observations);
        for (std::size_t round = 0; round < rule_.round_cap; ++round)
          {
            const AttemptEnd end = equilibrate(step);
            const RestReport &report = end.rest;
            position_.last_rest = report.status;
            const LaboratoryOutcome judgement = judge_attempt(stage_, rule_, end);
            const bool is_over = has_crept_too_far(stage_, rule_, end);
            if (is_over)
              position_.criterion = RuptureCriterion::large_creep;
            if (judgement != LaboratoryOutcome::finished)
              return step.may_be_halved && !is_over ? StepOutcome::too_large : give_up(judgement, observations);
            if (step.dt > 0.)
              end_record(record_of_round, end);
            dynamic_time_ += report.duration;
            record(get_kind_at_rest(), observations, rev_.get_baseline());
            const std::size_t batch = compute_batch_limit(rev_.get_model().fracture, rev_.get_baseline().grains.size());
            if (rev_.count_overstressed() > batch && step.may_be_halved)
              return StepOutcome::too_large;
            record_of_round = begin_record(0.);
            record_of_round.cause = BreakageCause::instant;
            record_of_round.n_broken = rev_.split_overstressed();
            if (record_of_round.n_broken == 0)
              return StepOutcome::ok;
          }
        position_.criterion = RuptureCriterion::endless_avalanche;
        return give_up(LaboratoryOutcome::ruptured, observations);
      }

      /** One dynamic computation in which the step's time passes and grains break. */
      StepOutcome attempt_in_scaled_time(const Step &step, std::vector<Observation> &observations)
      {
        DynamicRecord disturbance = begin_record(0.);
        const Counters before = rev_.get_baseline().counters;
        const AttemptEnd end = equilibrate(step);
        position_.last_rest = end.rest.status;
        const LaboratoryOutcome judgement = judge_attempt(stage_, rule_, end);
        if (judgement != LaboratoryOutcome::finished)
          return give_up(judgement, observations);
        const Counters &after = rev_.get_baseline().counters;
        const std::size_t n_delayed = after.broken_delayed - before.broken_delayed;
        disturbance.n_broken = n_delayed + (after.broken_instant - before.broken_instant);
        disturbance.cause = 2 * n_delayed >= disturbance.n_broken ? BreakageCause::delayed : BreakageCause::instant;
        end_record(disturbance, end);
        record(get_kind_at_rest(), observations, rev_.get_baseline());
        return StepOutcome::ok;
      }

      /** One equilibrium: the cell as it is told, again until a mean stress that is held is what it must be. */
      AttemptEnd equilibrate(const Step &step)
      {
        AttemptEnd end;
        CellControl control;
        for (std::size_t n = 0; n < correction_cap; ++n)
          {
            control = compute_control(stage_, position_, step.share, rev_.get_baseline());
            end.rest += step.clock ? rev_.control(control, *step.clock) : rev_.control(control);
            ++effort_.n_equilibria;
            if (end.rest.status != RestStatus::at_rest)
              break;
            rev_.accept();
            if (is_mean_stress_held(stage_, position_, rev_.get_baseline(),
                                    rev_.get_model().equilibrium.stress_tolerance))
              break;
            if (n + 1 == correction_cap)
              end.rest.status = RestStatus::cap_reached;
          }
        effort_.n_cycles += end.rest.n_cycles;
        const Matrix strain = compute_logarithmic_strain(rev_.get_trial().cell.deformation);
        end.strain = (strain - compute_logarithmic_strain(rev_.get_committed().cell.deformation)).cwiseAbs().maxCoeff();
        end.strain_of_stage = (strain - position_.strain_at_start).cwiseAbs().maxCoeff();
        end.largest_target =
            (control.follows_volume ? rev_.get_trial().stress : control.target_stress).cwiseAbs().maxCoeff();
        end.is_stress_controlled = control.is_stress_controlled;
        return end;
      }

      ObservationKind get_kind_at_rest() const
      {
        if (!is_held(stage_))
          return ObservationKind::load;
        return stage_.kind == StageKind::relaxation ? ObservationKind::relaxed : ObservationKind::dynamic;
      }

      StepOutcome give_up(const LaboratoryOutcome failure, std::vector<Observation> &observations)
      {
        failure_ = failure;
        if (failure != LaboratoryOutcome::ruptured)
          return StepOutcome::given_up;
        const RestStatus rest = position_.last_rest;
        if (position_.criterion == RuptureCriterion::none)
          position_.criterion =
              rest == RestStatus::at_rest ? RuptureCriterion::large_strain : RuptureCriterion::no_rest;
        position_.rupture_time = rev_.get_trial().time;
        // A cell that has become too narrow was left in the middle of a cycle: it has no stress to tell.
        record(ObservationKind::rupture, observations,
               rest == RestStatus::cell_too_narrow ? rev_.get_baseline() : rev_.get_trial());
        return StepOutcome::given_up;
      }

      std::size_t age(const double dt, std::vector<Observation> &observations)
      {
        record(ObservationKind::ageing, observations, rev_.get_baseline());
        observations.back().time += dt;
        return rev_.age(dt);
      }

      DynamicRecord begin_record(const double jump) const
      {
        DynamicRecord record;
        record.stage = position_.stage;
        record.time = rev_.get_baseline().time;
        record.jump = jump;
        record.strain_change = -compute_logarithmic_strain(rev_.get_baseline().cell.deformation);
        return record;
      }

      void end_record(DynamicRecord record, const AttemptEnd &end)
      {
        record.n_cycles = end.rest.n_cycles;
        record.is_stress_controlled = end.is_stress_controlled;
        record.largest_deviation = end.rest.largest_deviation;
        record.smallest_deviation = end.rest.smallest_deviation;
        record.strain_change += compute_logarithmic_strain(rev_.get_baseline().cell.deformation);
        dynamics_.push_back(record);
      }

      void record(const ObservationKind kind, std::vector<Observation> &observations, const RevState &state) const
      {
        Observation observation = observe(state, rev_.get_model());
        observation.stage = position_.stage;
        observation.kind = kind;
        observations.push_back(observation);
      }

      Rev &rev_;
      const LaboratoryStage &stage_;
      const LaboratoryRule &rule_;
      LaboratoryPosition &position_;
      const double nominal_;
      double dynamic_time_ = 0.; // of the present attempt [s]
      AttemptEffort effort_;     // of the present attempt
      LaboratoryOutcome failure_ = LaboratoryOutcome::no_equilibrium;
      std::vector<DynamicRecord> dynamics_; // of the present attempt
    };

    /** One stage from where it stands to its end. */
    LaboratoryOutcome run_stage(StageRunner &runner, const std::size_t n_stages, const LaboratoryObserver &observer,
                                LaboratoryPosition &position)
    {
      std::vector<Observation> observations;
      while (!runner.is_finished())
        {
          const LaboratoryOutcome outcome = runner.advance(observations, observer.attempted);
          const bool is_told = outcome == LaboratoryOutcome::finished || outcome == LaboratoryOutcome::ruptured;
          if (is_told && observer.observe)
            for (const Observation &observation : observations)
              observer.observe(observation);
          if (outcome != LaboratoryOutcome::finished)
            return outcome;
          if (observer.disturbed)
            for (const DynamicRecord &record : runner.get_dynamics())
              observer.disturbed(record);
          const double fraction =
              (static_cast<double>(position.stage) + runner.compute_fraction()) / static_cast<double>(n_stages);
          if (observer.committed && observer.committed(position, fraction))
            return LaboratoryOutcome::stopped;
        }
      return LaboratoryOutcome::finished;
    }
  } // namespace

  LaboratoryOutcome run_programme(Rev &rev, const std::vector<LaboratoryStage> &stages, const LaboratoryRule &rule,
                                  const LaboratoryObserver &observer, LaboratoryPosition &position)
  {
    for (; position.stage < stages.size(); ++position.stage, position.share_step = 0.)
      {
        StageRunner runner(rev, stages[position.stage], rule, position);
        if (position.share_step == 0.) // a resumed stage has begun already
          {
            runner.start(position.stage > 0 ? &stages[position.stage - 1] : nullptr);
            if (observer.stage_edge)
              observer.stage_edge(position.stage, false);
          }
        const LaboratoryOutcome outcome = run_stage(runner, stages.size(), observer, position);
        if (outcome != LaboratoryOutcome::finished)
          return outcome;
        if (observer.stage_edge)
          observer.stage_edge(position.stage, true);
        if (position.before_search)
          {
            rev = Rev(rev.get_model(), *position.before_search);
            position.before_search.reset();
          }
      }
    return LaboratoryOutcome::finished;
  }
} // namespace dem
