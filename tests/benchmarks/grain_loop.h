#pragma once

#include "tests/benchmarks/grain_places.h"

#include "dem/motion.h"
#include "dem/skins.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace benchmarks
{
  /** Normal force and stiffness as dem::compute_normal_response gives them, every operation in Real. */
  template <typename Real>
  std::pair<Real, Real> compute_normal(const dem::ContactLaw &law, const Real overlap, const Real root_radius)
  {
    const auto real = [](const double value) { return static_cast<Real>(value); };
    if (overlap > real(law.dT2))
      {
        const Real depth = overlap - real(law.d1 + law.d2);
        const Real secant = real(4. / 3. * law.effective_modulus) * root_radius * std::sqrt(depth);
        return {secant * depth, real(1.5) * secant};
      }
    const bool is_first = overlap <= real(law.dT1);
    const Real depth = is_first ? overlap : overlap - real(law.d1);
    const Real exponent = real(is_first ? law.c : law.b), length = real(is_first ? law.dT1 : law.dT2 - law.d1);
    const Real force =
        real(is_first ? law.force_scale_1 : law.force_scale_2) * root_radius * std::pow(depth / length, exponent);
    return {force, exponent * force / depth};
  }

  /**
   * dem's cycle (contact_forces.*, motion.*) pair by pair and grain by grain, for any number type and any
   * representation of places. Sums over all contacts are made in double: they are read, and move no grain.
   */
  template <typename Places>
  class GrainLoop
  {
  public:
    using Real = typename Places::Real;

    /** @param skin  of the network [m]  @param time_step  with true masses [s]; scaled ones have 1 cycle */
    GrainLoop(dem::RevState state, const dem::ContactLaw &law, const dem::MotionRule &rule, const double skin,
              const double time_step)
        : state_(std::move(state)), law_(law), rule_(rule), time_step_(static_cast<Real>(time_step)),
          network_(dem::build_contact_network(state_, skin)), places_(state_, network_), grains_(state_.grains.size()),
          pairs_(network_.size())
    {
      dem::update_true_masses(state_.grains, rule.density);
      for (std::size_t i = 0; i < grains_.size(); ++i)
        {
          grains_[i].radius = static_cast<Real>(state_.grains.place[i].w);
          grains_[i].mass = static_cast<Real>(state_.grains.velocity[i].w);
          grains_[i].inertia = static_cast<Real>(state_.grains.spin[i].w);
        }
      for (std::size_t k = 0; k < pairs_.size(); ++k)
        {
          pairs_[k].shear = network_.get_shear(k).template cast<Real>();
          pairs_[k].root_radius = static_cast<Real>(network_.root_radius[k]);
        }
    }

    void compute_forces()
    {
      for (Grain &grain : grains_)
        {
          grain.force.setZero();
          grain.torque.setZero();
          grain.stiffness = 0;
        }
      moment_.setZero();
      normal_force_ = stiffness_moment_ = 0.;
      n_touching_ = 0;
      for (std::size_t k = 0; k < pairs_.size(); ++k)
        if (network_.is_pair(k))
          compute_pair(k);
    }

    void advance(const dem::Matrix &strain_increment)
    {
      Real smallest_mass = 0;
      for (const Grain &grain : grains_)
        smallest_mass += grain.stiffness;
      smallest_mass *= Real(0.2) / static_cast<Real>(grains_.size());
      for (std::size_t i = 0; i < grains_.size(); ++i)
        {
          Grain &grain = grains_[i];
          const Real mass = rule_.has_true_masses ? grain.mass : std::max(grain.stiffness, smallest_mass);
          grain.velocity += time_step_ / mass * damp(grain.force, grain.velocity);
          places_.move(i, time_step_ * grain.velocity);
          if (rule_.is_rotation_free)
            grain.spin += time_step_ / grain.inertia * damp(grain.torque, grain.spin);
        }
      last_step_ = time_step_;
      strain_ = strain_increment.cast<Real>();
      if (strain_increment.isZero(0.))
        return;
      state_.cell.deform(dem::Matrix::Identity() + strain_increment);
      places_.follow(state_.cell);
    }

    dem::Matrix compute_stress() const { return moment_ / state_.cell.compute_volume(); }

    double compute_unbalanced_ratio() const
    {
      double sum = 0.;
      for (const Grain &grain : grains_)
        sum += grain.force.template cast<double>().norm();
      return sum / static_cast<double>(grains_.size()) / (normal_force_ / static_cast<double>(n_touching_));
    }

    /** As dem::Dynamics has it [Pa]. */
    double compute_stiffness() const { return stiffness_moment_ / (3. * state_.cell.compute_volume()); }

    /** Of the grain that has used up most of its own [-]. */
    double compute_used_share_of_skin() const
    {
      return dem::compute_skin_use(network_, state_.cell, store().grains, 0, grains_.size()).share;
    }

    /** Kinetic energy at the time of the present places plus energy stored by the normal forces [J]. */
    double compute_energy() const
    {
      double energy = 0.;
      for (const Grain &grain : grains_)
        {
          const double mass = grain.mass;
          const dem::Vector half_step = 0.5 * time_step_ / mass * grain.force.template cast<double>();
          energy += 0.5 * mass * (grain.velocity.template cast<double>() + half_step).squaredNorm();
        }
      for (std::size_t k = 0; k < pairs_.size(); ++k)
        if (pairs_[k].overlap > 0)
          energy += dem::compute_stored_energy(law_, pairs_[k].overlap, std::pow(network_.root_radius[k], 2));
      return energy;
    }

    /** The touching pairs with overlap and normal force as they were found here. */
    std::vector<dem::Contact> list_contacts() const
    {
      std::vector<dem::Contact> contacts;
      for (std::size_t k = 0; k < pairs_.size(); ++k)
        if (pairs_[k].overlap > 0)
          {
            dem::Contact contact;
            contact.a = network_.a[k];
            contact.b = network_.b[k];
            contact.overlap = pairs_[k].overlap;
            contact.normal_force = pairs_[k].normal_force;
            contact.effective_radius = std::pow(network_.root_radius[k], 2);
            contact.shear_force = pairs_[k].shear.template cast<double>();
            contacts.push_back(contact);
          }
      return contacts;
    }

    /** The state at the present places; its grains are at rest. */
    dem::RevState store() const
    {
      dem::RevState state = state_;
      for (std::size_t i = 0; i < grains_.size(); ++i)
        {
          const dem::Vector fraction = places_.get_fraction(i);
          // The image that is nearest to where the grain was, whatever the representation wraps.
          const dem::Vector before = dem::to_vector(state_.grains.place[i]), step = fraction - before;
          const dem::Vector place = before + (step - step.array().rint().matrix());
          state.grains.place[i] = {place.x(), place.y(), place.z(), state.grains.place[i].w};
        }
      state.resize_contacts(0);
      for (std::size_t k = 0; k < pairs_.size(); ++k)
        if (pairs_[k].overlap > 0)
          state.add(dem::ContactMemory{network_.a[k], network_.b[k], pairs_[k].shear.template cast<double>(),
                                       pairs_[k].is_sliding});
      state.stress = compute_stress();
      return state;
    }

  private:
    struct Grain
    {
      Triple<Real> velocity = Triple<Real>::Zero(), spin = Triple<Real>::Zero(); ///< [m/s; 1/s]
      Triple<Real> force, torque;                                                ///< [N; N m]
      Real stiffness;                                                            ///< sum of kn [N/m]
      Real radius, mass, inertia;                                                ///< [m; kg; kg m2]
    };

    struct Pair
    {
      Triple<Real> shear; ///< on a [N]
      Real root_radius;
      Real overlap = 0, normal_force = 0; ///< [m; N]
      bool is_sliding = false;
    };

    Triple<Real> damp(const Triple<Real> &force, const Triple<Real> &velocity) const
    {
      const Real alpha = static_cast<Real>(rule_.local_damping);
      return force - alpha * force.cwiseAbs().cwiseProduct(velocity.array().sign().matrix());
    }

    void compute_pair(const std::size_t k)
    {
      Pair &pair = pairs_[k];
      const Separation<Real> apart = places_.separate(k);
      pair.overlap = apart.overlap;
      if (!(apart.overlap > 0))
        {
          pair.shear.setZero();
          return;
        }
      Grain &a = grains_[network_.a[k]], &b = grains_[network_.b[k]];
      const auto [normal_force, stiffness] = compute_normal<Real>(law_, apart.overlap, pair.root_radius);
      const Triple<Real> unit = apart.branch / apart.distance;
      const Real arm_a = a.radius - Real(0.5) * apart.overlap, arm_b = b.radius - Real(0.5) * apart.overlap;
      Triple<Real> step = strain_ * apart.branch + last_step_ * (b.velocity - a.velocity);
      if (rule_.is_rotation_free)
        {
          step += last_step_ * unit.cross(arm_a * a.spin + arm_b * b.spin);
          pair.shear += Real(0.5) * last_step_ * unit.dot(a.spin + b.spin) * unit.cross(pair.shear);
        }
      pair.normal_force = normal_force;
      update_shear(pair, unit, static_cast<Real>(law_.shear_ratio) * stiffness, step);

      const Triple<Real> force = pair.shear - normal_force * unit;
      a.force += force, a.stiffness += stiffness;
      b.force -= force, b.stiffness += stiffness;
      if (rule_.is_rotation_free)
        {
          const Triple<Real> moment = unit.cross(pair.shear);
          a.torque += arm_a * moment;
          b.torque += arm_b * moment;
        }
      moment_ += (force * apart.branch.transpose()).template cast<double>();
      normal_force_ += normal_force;
      stiffness_moment_ += stiffness * apart.distance * apart.distance;
      ++n_touching_;
    }

    /** Turns the shear force into the contact plane with its size kept, lets it grow, caps it. */
    void update_shear(Pair &pair, const Triple<Real> &unit, const Real shear_stiffness, const Triple<Real> &step) const
    {
      const Triple<Real> flat = pair.shear - pair.shear.dot(unit) * unit;
      const Real size = flat.norm();
      const Real turn = size > 0 ? pair.shear.norm() / size : Real(1);
      pair.shear = turn * flat + shear_stiffness * (step - step.dot(unit) * unit);
      const Real cap = static_cast<Real>(law_.friction) * pair.normal_force, grown = pair.shear.norm();
      pair.is_sliding = grown > cap;
      if (pair.is_sliding)
        pair.shear *= cap / grown;
    }

    dem::RevState state_; // its cell is the present one, its places are those at the start
    const dem::ContactLaw law_;
    const dem::MotionRule rule_;
    const Real time_step_;
    Real last_step_ = 0; // that led to the present places; 0: none
    Square<Real> strain_ = Square<Real>::Zero();
    dem::ContactNetwork network_;
    Places places_;
    std::vector<Grain> grains_;
    std::vector<Pair> pairs_;
    dem::Matrix moment_;           // sum of force x branch [N m]
    double normal_force_ = 0.;     // sum [N]
    double stiffness_moment_ = 0.; // sum of kn |branch|^2 [N m]
    std::size_t n_touching_ = 0;
  };
} // namespace benchmarks
