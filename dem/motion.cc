#include "dem/motion.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

namespace dem
{
  namespace
  {
    void update_scaled_masses(std::vector<double> &inverse_mass, const std::vector<Row> &forces)
    {
      double mean = 0.;
      for (const Row &force : forces)
        mean += force.w;
      mean /= static_cast<double>(std::max<std::size_t>(1, forces.size()));
      const double smallest = mean > 0. ? 0.2 * mean : 1.;
      inverse_mass.resize(forces.size());
      for (std::size_t i = 0; i < forces.size(); ++i)
        inverse_mass[i] = 1. / std::max(forces[i].w, smallest);
    }

    void update_time_step(Kinetics &kinetics, const MotionRule &rule, const Grains &grains, const Forces &forces)
    {
      double smallest_square = std::numeric_limits<double>::infinity();
      kinetics.inverse_mass.resize(grains.size());
      kinetics.inverse_inertia.resize(grains.size());
      for (std::size_t i = 0; i < grains.size(); ++i)
        {
          kinetics.inverse_mass[i] = 1. / grains.velocity[i].w;
          kinetics.inverse_inertia[i] = 1. / grains.spin[i].w;
          if (forces.force[i].w > 0.)
            smallest_square = std::min(smallest_square, 2. * grains.velocity[i].w / forces.force[i].w);
          if (rule.is_rotation_free && forces.torque[i].w > 0.)
            smallest_square = std::min(smallest_square, 2. * grains.spin[i].w / forces.torque[i].w);
        }
      if (std::isfinite(smallest_square))
        kinetics.time_step = rule.time_step_share * std::sqrt(smallest_square);
    }

    double damp(const double force, const double velocity, const double alpha)
    {
      const double sign = velocity > 0. ? 1. : (velocity < 0. ? -1. : 0.);
      return force - alpha * std::abs(force) * sign;
    }

    void accelerate(Row &velocity, const Row &force, const double step_over_mass, const double alpha)
    {
      velocity.x += step_over_mass * damp(force.x, velocity.x, alpha);
      velocity.y += step_over_mass * damp(force.y, velocity.y, alpha);
      velocity.z += step_over_mass * damp(force.z, velocity.z, alpha);
    }
  } // namespace

  void update_true_masses(Grains &grains, const double density)
  {
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        const double radius = grains.place[i].w;
        grains.velocity[i].w = 4. / 3. * std::numbers::pi * density * radius * radius * radius;
        grains.spin[i].w = 0.4 * grains.velocity[i].w * radius * radius;
      }
  }

  void update_kinetics(Kinetics &kinetics, const MotionRule &rule, const Grains &grains, const Forces &forces)
  {
    if (rule.has_true_masses)
      return update_time_step(kinetics, rule, grains, forces);
    kinetics.time_step = 1.;
    update_scaled_masses(kinetics.inverse_mass, forces.force);
    if (rule.is_rotation_free)
      update_scaled_masses(kinetics.inverse_inertia, forces.torque);
  }

  double advance_grains(Grains &grains, const Cell &cell, const Forces &forces, const Kinetics &kinetics,
                        const MotionRule &rule)
  {
    const Matrix to_fraction = cell.edges.inverse() * kinetics.time_step;
    const double i00 = to_fraction(0, 0), i01 = to_fraction(0, 1), i02 = to_fraction(0, 2), i10 = to_fraction(1, 0),
                 i11 = to_fraction(1, 1), i12 = to_fraction(1, 2), i20 = to_fraction(2, 0), i21 = to_fraction(2, 1),
                 i22 = to_fraction(2, 2);
    double largest_square = 0.;
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        Row &v = grains.velocity[i];
        accelerate(v, forces.force[i], kinetics.time_step * kinetics.inverse_mass[i], rule.local_damping);
        largest_square = std::max(largest_square, v.x * v.x + v.y * v.y + v.z * v.z);
        Row &place = grains.place[i];
        place.x += i00 * v.x + i01 * v.y + i02 * v.z;
        place.y += i10 * v.x + i11 * v.y + i12 * v.z;
        place.z += i20 * v.x + i21 * v.y + i22 * v.z;
      }
    if (rule.is_rotation_free)
      for (std::size_t i = 0; i < grains.size(); ++i)
        accelerate(grains.spin[i], forces.torque[i], kinetics.time_step * kinetics.inverse_inertia[i],
                   rule.local_damping);
    return std::sqrt(largest_square) * kinetics.time_step;
  }

  double compute_mean_resultant(const Forces &forces)
  {
    double sum = 0.;
    for (const Row &force : forces.force)
      sum += std::sqrt(force.x * force.x + force.y * force.y + force.z * force.z);
    return sum / static_cast<double>(std::max<std::size_t>(1, forces.force.size()));
  }
} // namespace dem
