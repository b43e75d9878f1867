#include "dem/laboratory.h"

#include "dem/stage_path.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem
{
  namespace
  {
    enum class StepOutcome
    {
      ok,
      too_large,
      no_equilibrium,
      ruptured
    };

    struct Step
    {
      double share = 0.; ///< of the load at its end
      double dt = 0.;    ///< [s]
      bool may_be_halved = false;
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
        if (before != nullptr)
          {
            const CellControl control = compute_control(*before, position_, 1., state);
            for (int k = 0; k < 3; ++k)
              if (control.is_stress_controlled[k])
                stress(k, k) = control.target_stress(k, k);
          }
        position_.share = is_held(stage_) ? 1. : 0.;
        position_.share_step = nominal_;
        position_.time_in_stage = 0.;
        position_.n_cuts = 0;
        position_.stress_at_start = stress;
        position_.strain_at_start = compute_logarithmic_strain(state.cell.deformation);
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

      /** Steps until one is committed; its observations are those of the committed attempt alone. */
      LaboratoryOutcome advance(std::vector<Observation> &observations)
      {
        while (true)
          {
            observations.clear();
            const Step step = choose_step();
            const StepOutcome outcome = attempt(step, observations);
            if (outcome == StepOutcome::ok)
              {
                commit(step);
                return LaboratoryOutcome::finished;
              }
            rev_.revert();
            if (outcome == StepOutcome::ruptured)
              return LaboratoryOutcome::ruptured;
            if (!step.may_be_halved)
              return LaboratoryOutcome::no_equilibrium;
            shorten();
          }
      }

    private:
      Step choose_step() const
      {
        Step step;
        const double to_batch = rev_.compute_time_to_next_batch(position_.n_cuts);
        if (is_held(stage_))
          {
            step.share = 1.;
            step.dt = std::min(to_batch, compute_time_to_output(stage_, position_.time_in_stage));
            step.may_be_halved = can_cut_batch();
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
        step.may_be_halved = can_halve_load() || (stage_.duration > 0. && can_cut_batch());
        return step;
      }

      bool can_halve_load() const { return position_.share_step > nominal_ * rule_.smallest_share; }

      bool can_cut_batch() const
      {
        return compute_batch_limit(rev_.get_model().fracture, rev_.get_committed().grains.size(), position_.n_cuts) > 1;
      }

      void shorten()
      {
        if (!is_held(stage_) && can_halve_load())
          position_.share_step *= 0.5;
        if (can_cut_batch())
          ++position_.n_cuts;
      }

      void commit(const Step &step)
      {
        rev_.commit();
        position_.share = step.share;
        // The end of a stage is reached to the last bit, whatever the sum of steps rounds to.
        const double left = stage_.duration - position_.time_in_stage;
        position_.time_in_stage =
            step.dt >= left * (1. - 1e-14) ? stage_.duration : position_.time_in_stage + step.dt + dynamic_time_;
        position_.share_step = std::min(nominal_, 2. * position_.share_step);
        position_.n_cuts = position_.n_cuts > 0 ? position_.n_cuts - 1 : 0;
      }

      StepOutcome attempt(const Step &step, std::vector<Observation> &observations)
      {
        dynamic_time_ = 0.;
        if (step.dt > 0.)
          age(step.dt, observations);
        for (std::size_t round = 0; round < rule_.round_cap; ++round)
          {
            const RestReport report = rev_.control(compute_control(stage_, position_, step.share, rev_.get_baseline()));
            position_.last_rest = report.status;
            if (report.status != RestStatus::at_rest)
              return step.may_be_halved ? StepOutcome::too_large : StepOutcome::no_equilibrium;
            rev_.accept();
            dynamic_time_ += report.duration;
            record(is_held(stage_)
                       ? (stage_.kind == StageKind::relaxation ? ObservationKind::relaxed : ObservationKind::dynamic)
                       : ObservationKind::load,
                   observations);
            const std::size_t batch = compute_batch_limit(rev_.get_model().fracture, rev_.get_baseline().grains.size());
            if (rev_.count_overstressed() > batch && step.may_be_halved)
              return StepOutcome::too_large;
            if (rev_.split_overstressed() == 0)
              return StepOutcome::ok;
          }
        return StepOutcome::ruptured;
      }

      void age(const double dt, std::vector<Observation> &observations)
      {
        record(ObservationKind::ageing, observations);
        observations.back().time += dt;
        rev_.age(dt);
      }

      void record(const ObservationKind kind, std::vector<Observation> &observations) const
      {
        Observation observation = observe(rev_.get_baseline(), rev_.get_model());
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
    };

    /** One stage from where it stands to its end. */
    LaboratoryOutcome run_stage(StageRunner &runner, const std::size_t n_stages, const LaboratoryObserver &observer,
                                LaboratoryPosition &position)
    {
      std::vector<Observation> observations;
      while (!runner.is_finished())
        {
          const LaboratoryOutcome outcome = runner.advance(observations);
          if (outcome != LaboratoryOutcome::finished)
            return outcome;
          if (observer.observe)
            for (const Observation &observation : observations)
              observer.observe(observation);
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
      }
    return LaboratoryOutcome::finished;
  }

  Observation observe(const RevState &state, const RevModel &model)
  {
    Observation observation;
    const auto contacts = list_contacts(state, make_contact_law(model.material));
    observation.time = state.time;
    observation.counters = state.counters;
    observation.strain = compute_logarithmic_strain(state.cell.deformation);
    observation.stress = 0.5 * (state.stress + state.stress.transpose());
    observation.void_ratio = compute_void_ratio(state);
    observation.void_ratio_with_fines = compute_void_ratio_with_fines(state);
    observation.coordination =
        compute_coordination(contacts, state.grains.size(), model.dynamics.motion.is_rotation_free).all;
    observation.unbalanced_ratio = state.unbalanced_ratio;
    observation.n_grains = state.grains.size();
    return observation;
  }

  void check_programme(const std::vector<LaboratoryStage> &stages)
  {
    if (stages.empty())
      throw std::invalid_argument("the programme has no stage");
    for (std::size_t i = 0; i < stages.size(); ++i)
      {
        const LaboratoryStage &stage = stages[i];
        const auto require = [&](const bool is_met, const std::string &what) {
          if (!is_met)
            throw std::invalid_argument("stage " + std::to_string(i + 1) + " (" + stage.name + "): " + what);
        };
        if (is_held(stage))
          {
            require(stage.duration > 0., "a stage that holds its load needs a duration above 0 s");
            require(i > 0, "a stage that holds its load needs a loading stage before it");
            require(stage.first_output > 0. && stage.first_output <= stage.duration,
                    "the first output must lie between 0 s and the duration");
          }
        if (stage.kind == StageKind::isotropic || stage.kind == StageKind::oedometric)
          require(stage.stress > 0., "the stress at its end must be above 0 Pa (compression-positive)");
        if (stage.kind == StageKind::triaxial)
          require(stage.axial_strain != 0., "the axial strain at its end must not be 0");
      }
  }

  const char *describe(const LaboratoryOutcome outcome)
  {
    switch (outcome)
      {
      case LaboratoryOutcome::finished:
        return "finished";
      case LaboratoryOutcome::no_equilibrium:
        return "no equilibrium at the smallest step";
      case LaboratoryOutcome::ruptured:
        return "ruptured: an avalanche of fractures did not end";
      case LaboratoryOutcome::stopped:
        return "stopped";
      }
    return "unknown";
  }

  const char *describe(const ObservationKind kind)
  {
    switch (kind)
      {
      case ObservationKind::load:
        return "load";
      case ObservationKind::dynamic:
        return "dynamic";
      case ObservationKind::ageing:
        return "ageing";
      case ObservationKind::relaxed:
        return "relaxed";
      }
    return "unknown";
  }
} // namespace dem
