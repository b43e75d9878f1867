#include "dem/rev.h"

#include "dem/ageing.h"
#include "dem/contact_creep.h"
#include "dem/stopwatch.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace dem
{
  namespace
  {
    std::vector<double> list_radii(const Grains &grains)
    {
      std::vector<double> radii(grains.size());
      for (std::size_t i = 0; i < radii.size(); ++i)
        radii[i] = grains.place[i].w;
      return radii;
    }

    /**
     * Deformation gradients at which a cell is brought to rest are multiples of this [-]. It lies far above the
     * rounding of what a caller computes, so that two ways of computing one strain get the same bits, and is worth
     * about 1e-10 of the stress (docs/theory.md, section 8).
     */
    constexpr double deformation_grid = 0x1p-34;

    /** How often a step of contact creep is halved at most: then it disturbs by a thousandth of what it may. */
    constexpr unsigned int n_creep_cuts = 10;

    Matrix round_to_grid(const Matrix &deformation)
    {
      return (deformation / deformation_grid).array().round().matrix() * deformation_grid;
    }

    /** What takes the cell from the grid's point at its deformation to that at `asked`; exactly one if they are one. */
    Matrix compute_stretch_on_grid(const Matrix &deformation, const Matrix &asked)
    {
      const Matrix from = round_to_grid(deformation), to = round_to_grid(asked);
      return from == to ? Matrix(Matrix::Identity()) : Matrix(to * from.inverse());
    }
  } // namespace

  Rev::Rev(const RevModel &model, const RevState &state) : Rev(model, state, state) {}

  Rev::Rev(const RevModel &model, const RevState &committed, const RevState &baseline)
      : model_(model), law_(make_contact_law(model.material)), committed_(committed), baseline_(baseline),
        trial_(baseline)
  {}

  void Rev::copy(const RevState &from, RevState &to)
  {
    const Stopwatch watch(profile_[Part::copy]);
    to = from;
  }

  void Rev::set_trial(const RevState &state)
  {
    copy(state, trial_);
    has_old_cracks_ = false;
  }

  RestReport Rev::bring_to_rest(RevState &state, CellControl control, const CrackClock *const clock)
  {
    const bool is_strained = !control.has_servo();
    const Matrix asked = control.stretch * state.cell.deformation;
    if (is_strained)
      control.stretch = compute_stretch_on_grid(state.cell.deformation, asked);
    const RestRule rule{law_, model_.dynamics, model_.equilibrium};
    const CrackingRule cracking{model_.fracture, model_.identity, clock != nullptr ? *clock : CrackClock{}};
    const RestReport report = model_.dynamics.motion.has_true_masses || clock != nullptr
                                  ? run_dynamic_computation(state, rule, cracking, control)
                                  : dem::bring_to_rest(state, rule, control);
    profile_ += report.profile;
    profile_.n_cycles += report.n_cycles;
    ++profile_.n_rests;
    n_bytes_at_rest_ = report.n_bytes;
    if (is_strained)
      state.cell.deformation = asked; // so that what the grid leaves out never adds up
    if (report.status == RestStatus::at_rest)
      forget_open_contacts(state);
    return report;
  }

  void Rev::update_cracks(RevState &state) const
  {
    const Stopwatch watch(profile_[Part::ageing]);
    update_crack_velocities(state.grains, list_contacts(state, law_), model_.fracture);
  }

  // Most trials are dropped again: how fast their cracks would grow is found once somebody asks.
  const RevState &Rev::get_trial() const
  {
    if (has_old_cracks_)
      update_cracks(trial_);
    has_old_cracks_ = false;
    return trial_;
  }

  RestReport Rev::bring_trial_to_rest(const CellControl &control, const CrackClock *const clock)
  {
    const RestReport report = bring_to_rest(trial_, control, clock);
    has_old_cracks_ = report.status == RestStatus::at_rest;
    return report;
  }

  RestReport Rev::deform(const Matrix &stretch)
  {
    set_trial(baseline_);
    const Matrix &deformation = baseline_.cell.deformation;
    const Matrix asked = stretch * deformation;
    if (compute_stretch_on_grid(deformation, asked) == Matrix::Identity())
      {
        trial_.cell.deformation = asked;
        RestReport report;
        report.unbalanced_ratio = trial_.unbalanced_ratio;
        return report;
      }
    CellControl control;
    control.stretch = stretch;
    return bring_trial_to_rest(control);
  }

  RestReport Rev::control(const CellControl &control)
  {
    set_trial(baseline_);
    return bring_trial_to_rest(control);
  }

  RestReport Rev::control(const CellControl &control, const CrackClock &clock)
  {
    set_trial(baseline_);
    return bring_trial_to_rest(control, &clock);
  }

  RestReport Rev::relax()
  {
    const RestReport report = bring_to_rest(baseline_, CellControl{});
    if (report.status == RestStatus::at_rest)
      update_cracks(baseline_);
    return report;
  }

  double Rev::compute_time_to_next_batch(const unsigned int n_cuts) const
  {
    const Stopwatch watch(profile_[Part::ageing]);
    return compute_time_to_batch(baseline_.grains,
                                 compute_batch_limit(model_.fracture, baseline_.grains.size(), n_cuts));
  }

  double Rev::compute_longest_jump(const unsigned int n_cuts) const
  {
    const double to_batch = compute_time_to_next_batch(n_cuts);
    if (!model_.creep.has_contact_creep())
      return to_batch;
    const Stopwatch watch(profile_[Part::ageing]);
    const double creep_step = compute_longest_creep_step(baseline_, list_contacts(baseline_, law_), model_.creep);
    return std::min(to_batch, std::ldexp(creep_step, -static_cast<int>(n_cuts)));
  }

  bool Rev::can_cut_jump(const unsigned int n_cuts) const
  {
    if (model_.creep.has_contact_creep() && n_cuts < n_creep_cuts)
      return true;
    return compute_batch_limit(model_.fracture, committed_.grains.size(), n_cuts) > 1;
  }

  std::size_t Rev::age(const double dt)
  {
    const Stopwatch watch(profile_[Part::ageing]);
    const auto broken = advance_cracks(baseline_.grains, dt);
    std::vector<Contact> contacts; // as they were before anything crept
    if (model_.creep.has_contact_creep())
      {
        contacts = list_contacts(baseline_, law_);
        advance_contact_creep(baseline_, contacts, model_.creep, dt);
      }
    else if (!broken.empty())
      contacts = list_contacts_of(baseline_, broken, law_);
    baseline_.time += dt;
    for (const std::size_t place : broken)
      record_fracture(baseline_, place, BreakageCause::delayed);
    if (!broken.empty())
      split_grains(baseline_, broken, contacts, model_.fracture, model_.identity);
    return broken.size();
  }

  std::size_t Rev::count_overstressed() const
  {
    return list_overstressed(baseline_.grains, model_.fracture).size();
  }

  std::size_t Rev::split_overstressed()
  {
    const Stopwatch watch(profile_[Part::ageing]);
    auto places = list_overstressed(baseline_.grains, model_.fracture);
    places.resize(std::min(places.size(), compute_batch_limit(model_.fracture, baseline_.grains.size())));
    if (places.empty())
      return 0;
    for (const std::size_t place : places)
      record_fracture(baseline_, place, BreakageCause::instant);
    split_grains(baseline_, places, list_contacts_of(baseline_, places, law_), model_.fracture, model_.identity);
    return places.size();
  }

  void Rev::commit()
  {
    last_fractures_ = std::move(baseline_.fractures);
    baseline_.fractures.clear();
    trial_.fractures.clear();
    copy(baseline_, committed_);
  }

  void Rev::revert()
  {
    copy(committed_, baseline_);
    set_trial(committed_);
  }

  std::size_t Rev::count_bytes() const
  {
    return dem::count_bytes(committed_) + dem::count_bytes(baseline_) + dem::count_bytes(trial_) + n_bytes_at_rest_;
  }

  Tangent Rev::compute_tangent(const RevState &state, const TangentKind kind) const
  {
    if (state.cell.has_walls())
      throw std::invalid_argument(
          "a REV between rigid walls has no tangent: only a periodic cell may stand for a point");
    const Stopwatch watch(profile_[Part::tangent]);
    const auto contacts = list_contacts(state, law_);
    const auto radii = list_radii(state.grains);
    const ContactGraph graph{contacts, radii, state.cell.compute_volume(), model_.dynamics.motion.is_rotation_free};
    return kind == TangentKind::condensed ? compute_condensed_tangent(graph) : compute_affine_tangent(graph);
  }

  Rev make_rev(const RevModel &model, RevState packing)
  {
    packing.time = 0.;
    packing.cell.deformation = Matrix::Identity();
    packing.rotation = Matrix::Identity();
    packing.initial_solid_volume = compute_solid_volume(packing.grains);
    packing.counters = Counters{};
    for (std::size_t i = 0; i < packing.grains.size(); ++i)
      {
        packing.grains.id[i] = packing.grains.parent[i] = i;
        packing.grains.generation[i] = 0;
      }
    packing.counters.next_id = packing.grains.size();
    update_true_masses(packing.grains, model.dynamics.motion.density);
    draw_strengths(packing.grains, model.fracture, model.identity);
    update_crack_velocities(packing.grains, list_contacts(packing, make_contact_law(model.material)), model.fracture);
    return Rev(model, packing);
  }
} // namespace dem
