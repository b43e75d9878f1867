#include "dem/contact_forces.h"

#include "dem/contact_block.h"
#include "dem/fracture.h"

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    /** Half of what the spins of a pair do: (arm_a w_a + arm_b w_b) x n, and the mean turn of t about n. */
    struct PairSpin
    {
      Vector slip;  ///< velocity of b relative to a at the contact that comes from spins [m/s]
      double twist; ///< mean angular velocity about the normal [1/s]
    };

    PairSpin compute_spin(const Grains &grains, const ContactBlock &block, const std::size_t i, const std::uint32_t a,
                          const std::uint32_t b)
    {
      const double half = 0.5 * block.overlap[i];
      const double arm_a = grains.place[a].w - half, arm_b = grains.place[b].w - half;
      const Vector normal = Vector(block.branch_x[i], block.branch_y[i], block.branch_z[i]) / block.distance[i];
      const Vector spin_a = to_vector(grains.spin[a]), spin_b = to_vector(grains.spin[b]);
      return {-(arm_a * spin_a + arm_b * spin_b).cross(normal), 0.5 * (spin_a + spin_b).dot(normal)};
    }

    /** Fetches shear forces and relative displacements of a block's pairs. */
    template <bool is_rotation_free>
    void gather_steps(const Grains &grains, const ContactNetwork &network, const Motion &motion, ContactBlock &block)
    {
      const Matrix l = motion.strain_increment;
      const double dt = motion.time_step;
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const std::uint32_t a = network.a[block.pair[i]], b = network.b[block.pair[i]];
          const Row &va = grains.velocity[a], &vb = grains.velocity[b];
          const Row &shear = network.shear[block.pair[i]];
          const double x = block.branch_x[i], y = block.branch_y[i], z = block.branch_z[i];
          block.step_x[i] = (vb.x - va.x) * dt + (l(0, 0) * x + l(0, 1) * y + l(0, 2) * z);
          block.step_y[i] = (vb.y - va.y) * dt + (l(1, 0) * x + l(1, 1) * y + l(1, 2) * z);
          block.step_z[i] = (vb.z - va.z) * dt + (l(2, 0) * x + l(2, 1) * y + l(2, 2) * z);
          block.shear_x[i] = shear.x;
          block.shear_y[i] = shear.y;
          block.shear_z[i] = shear.z;
          if constexpr (is_rotation_free)
            {
              const PairSpin spin = compute_spin(grains, block, i, a, b);
              block.step_x[i] += spin.slip.x() * dt;
              block.step_y[i] += spin.slip.y() * dt;
              block.step_z[i] += spin.slip.z() * dt;
              const double turn = spin.twist * dt / block.distance[i];
              block.shear_x[i] += turn * (y * shear.z - z * shear.y);
              block.shear_y[i] += turn * (z * shear.x - x * shear.z);
              block.shear_z[i] += turn * (x * shear.y - y * shear.x);
            }
        }
    }

    void add(Row &row, const double x, const double y, const double z, const double w)
    {
      row.x += x;
      row.y += y;
      row.z += z;
      row.w += w;
    }

    void add_torques(const Grains &grains, const ContactBlock &block, const std::size_t i, const std::uint32_t a,
                     const std::uint32_t b, Forces &forces)
    {
      const double half = 0.5 * block.overlap[i];
      const double arm_a = grains.place[a].w - half, arm_b = grains.place[b].w - half;
      const Vector normal = Vector(block.branch_x[i], block.branch_y[i], block.branch_z[i]) / block.distance[i];
      const Vector moment = normal.cross(Vector(block.shear_x[i], block.shear_y[i], block.shear_z[i]));
      const double k = block.stiffness[i];
      add(forces.torque[a], arm_a * moment.x(), arm_a * moment.y(), arm_a * moment.z(), arm_a * arm_a * k);
      add(forces.torque[b], arm_b * moment.x(), arm_b * moment.y(), arm_b * moment.z(), arm_b * arm_b * k);
    }

    /** Gives forces to the grains, pair by pair in the network's order, and shear forces back to the network. */
    template <bool is_rotation_free>
    void scatter(const Grains &grains, const ContactBlock &block, ContactNetwork &network, Forces &forces,
                 ContactSums &sums)
    {
      Matrix moment = Matrix::Zero();
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const std::size_t k = block.pair[i];
          const std::uint32_t a = network.a[k], b = network.b[k];
          const double x = block.branch_x[i], y = block.branch_y[i], z = block.branch_z[i];
          const double along = block.force[i] / block.distance[i];
          const double fx = block.shear_x[i] - along * x, fy = block.shear_y[i] - along * y,
                       fz = block.shear_z[i] - along * z;
          network.shear[k] = Row{block.shear_x[i], block.shear_y[i], block.shear_z[i], block.status[i]};
          add(forces.force[a], fx, fy, fz, block.stiffness[i]);
          add(forces.force[b], -fx, -fy, -fz, block.stiffness[i]);
          if constexpr (is_rotation_free)
            add_torques(grains, block, i, a, b, forces);
          moment(0, 0) += fx * x, moment(0, 1) += fx * y, moment(0, 2) += fx * z;
          moment(1, 0) += fy * x, moment(1, 1) += fy * y, moment(1, 2) += fy * z;
          moment(2, 0) += fz * x, moment(2, 1) += fz * y, moment(2, 2) += fz * z;
          sums.normal_force += block.force[i];
          sums.stiffness_moment += block.stiffness[i] * block.distance[i] * block.distance[i];
        }
      sums.force_times_branch += moment;
      sums.n_touching += block.n;
    }

    void update_largest_stress(const ContactBlock &block, const ContactNetwork &network, const Grains &grains,
                               Forces &forces)
    {
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const std::uint32_t a = network.a[block.pair[i]], b = network.b[block.pair[i]];
          const double radius = compute_effective_radius(grains.place[a].w, grains.place[b].w);
          const double stress = compute_contact_stress(block.force[i], radius, block.overlap[i]);
          forces.largest_stress[a] = std::max(forces.largest_stress[a], stress);
          forces.largest_stress[b] = std::max(forces.largest_stress[b], stress);
        }
    }

    template <bool is_rotation_free>
    ContactSums compute(const RevState &state, const ContactLaw &law, const Motion &motion, ContactNetwork &network,
                        Forces &forces)
    {
      ContactSums sums;
      ContactBlock block;
      for (std::size_t begin = 0; begin < network.size(); begin += ContactBlock::capacity)
        {
          gather_touching(state, network, begin, std::min(begin + ContactBlock::capacity, network.size()), block);
          apply_normal_law(law, block);
          gather_steps<is_rotation_free>(state.grains, network, motion, block);
          apply_shear_law(law, block);
          scatter<is_rotation_free>(state.grains, block, network, forces, sums);
          if (motion.has_contact_stress)
            update_largest_stress(block, network, state.grains, forces);
        }
      return sums;
    }
  } // namespace

  ContactSums compute_contact_forces(const RevState &state, const ContactLaw &law, const Motion &motion,
                                     ContactNetwork &network, Forces &forces)
  {
    forces.force.assign(state.grains.size(), Row{});
    if (motion.is_rotation_free)
      forces.torque.assign(state.grains.size(), Row{});
    if (motion.has_contact_stress)
      forces.largest_stress.assign(state.grains.size(), 0.);
    return motion.is_rotation_free ? compute<true>(state, law, motion, network, forces)
                                   : compute<false>(state, law, motion, network, forces);
  }
} // namespace dem
