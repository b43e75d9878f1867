#include "dem/contact_forces.h"

#include "dem/fracture.h"
#include "dem/power.h"

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    /** Touching pairs of a stretch of the network, as arrays: the law is evaluated for all of them at once. */
    struct Block
    {
      static constexpr std::size_t capacity = 256;

      std::size_t n = 0;
      std::uint32_t pair[capacity];
      alignas(64) double bx[capacity], by[capacity], bz[capacity]; // branch [m]
      alignas(64) double distance[capacity], overlap[capacity], root_radius[capacity];
      alignas(64) double force[capacity], stiffness[capacity];
    };

    /** Collects the touching pairs of [begin, end) and forgets the shear of those apart. */
    void gather(const RevState &state, ContactNetwork &network, const std::size_t begin, const std::size_t end,
                Block &block)
    {
      const Matrix &h = state.cell.edges;
      const double h00 = h(0, 0), h01 = h(0, 1), h02 = h(0, 2), h10 = h(1, 0), h11 = h(1, 1), h12 = h(1, 2),
                   h20 = h(2, 0), h21 = h(2, 1), h22 = h(2, 2);
      const Row *place = state.grains.place.data();
      std::size_t n = 0;
      for (std::size_t k = begin; k < end; ++k)
        {
          const Row &a = place[network.a[k]], &b = place[network.b[k]];
          const double fx = b.x - a.x, fy = b.y - a.y, fz = b.z - a.z;
          const double gx = fx - __builtin_rint(fx), gy = fy - __builtin_rint(fy), gz = fz - __builtin_rint(fz);
          const double x = h00 * gx + h01 * gy + h02 * gz;
          const double y = h10 * gx + h11 * gy + h12 * gz;
          const double z = h20 * gx + h21 * gy + h22 * gz;
          const double square = x * x + y * y + z * z;
          const double sum = a.w + b.w;
          block.pair[n] = static_cast<std::uint32_t>(k);
          block.bx[n] = x;
          block.by[n] = y;
          block.bz[n] = z;
          block.distance[n] = square;
          block.overlap[n] = sum;
          block.root_radius[n] = a.w * b.w;
          if (square < sum * sum)
            ++n;
          else
            network.shear[k] = Row{0., 0., 0., pair_is_apart};
        }
      block.n = n;
    }

    /** The normal law for all pairs of a block, without branches (reference: compute_normal_response). */
    void apply_normal_law(const ContactLaw &law, Block &block)
    {
      const double first_scale = law.force_scale_1, second_scale = law.force_scale_2;
      const double first_length = 1. / law.dT1, second_length = 1. / (law.dT2 - law.d1);
      const double hertz_scale = 4. / 3. * law.effective_modulus, shift = law.d1 + law.d2;
      const double smallest = 1e-100; // of its length: a touch of no depth gives no force and no 0/0
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const double distance = std::sqrt(block.distance[i]);
          const double sum = block.overlap[i];
          const double d = sum - distance;
          const double root = std::sqrt(block.root_radius[i] / sum);
          block.distance[i] = distance;
          block.overlap[i] = d;
          const bool is_first = d <= law.dT1;
          const bool is_hertz = d > law.dT2;
          const double exponent = is_first ? law.c : law.b;
          const double argument = is_first ? d : d - law.d1;
          const double length = is_first ? first_length : second_length;
          const double base = argument * length > smallest ? argument * length : smallest;
          const double scale = is_first ? first_scale : second_scale;
          const double rough = scale * compute_power(base, exponent);
          const double deep = d - shift > 0. ? d - shift : 0.;
          const double hertz = hertz_scale * deep * std::sqrt(deep);
          const double n = root * (is_hertz ? hertz : rough);
          block.force[i] = n;
          block.stiffness[i] = n * (is_hertz ? 1.5 / deep : exponent * length / base);
        }
    }

    void apply_hertz_law(const ContactLaw &law, Block &block)
    {
      const double scale = 4. / 3. * law.effective_modulus;
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const double distance = std::sqrt(block.distance[i]);
          const double sum = block.overlap[i];
          const double d = sum - distance > 0. ? sum - distance : 0.; // rounding may leave a touch of no depth
          const double root = std::sqrt(block.root_radius[i] / sum * d);
          block.distance[i] = distance;
          block.overlap[i] = d;
          block.force[i] = scale * root * d;
          block.stiffness[i] = 1.5 * scale * root;
        }
    }

    struct Pair
    {
      const Row &velocity_a, &velocity_b, &spin_a, &spin_b;
      double arm_a, arm_b; // lever arms R - d/2 [m]
    };

    /** Displacement of b relative to a at their contact since the last forces [m]. */
    template <bool is_rotation_free>
    Vector compute_relative_displacement(const Pair &pair, const Motion &motion, const Vector &branch,
                                         const Vector &normal)
    {
      Vector velocity = to_vector(pair.velocity_b) - to_vector(pair.velocity_a);
      if constexpr (is_rotation_free)
        velocity -= (pair.arm_a * to_vector(pair.spin_a) + pair.arm_b * to_vector(pair.spin_b)).cross(normal);
      return velocity * motion.time_step + motion.strain_increment * branch;
    }

    /** Turns a shear force into the new contact plane, its size kept. */
    Vector turn(const Vector &shear, const Vector &normal)
    {
      const Vector flat = shear - shear.dot(normal) * normal;
      const double flat_square = flat.squaredNorm();
      return flat_square > 0. ? Vector(flat * std::sqrt(shear.squaredNorm() / flat_square)) : flat;
    }

    void add(Row &row, const Vector &value, const double w)
    {
      row.x += value.x();
      row.y += value.y();
      row.z += value.z();
      row.w += w;
    }

    template <bool is_rotation_free>
    void scatter(const RevState &state, const ContactLaw &law, const Motion &motion, ContactNetwork &network,
                 const Block &block, Forces &forces, ContactSums &sums)
    {
      const Grains &grains = state.grains;
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const std::size_t k = block.pair[i];
          const auto a = network.a[k], b = network.b[k];
          const Vector branch(block.bx[i], block.by[i], block.bz[i]);
          const Vector normal = branch / block.distance[i];
          const double half = 0.5 * block.overlap[i];
          const Pair pair{grains.velocity[a], grains.velocity[b],       grains.spin[a],
                          grains.spin[b],     grains.place[a].w - half, grains.place[b].w - half};
          const Vector step = compute_relative_displacement<is_rotation_free>(pair, motion, branch, normal);

          Row &memory = network.shear[k];
          Vector shear = turn(to_vector(memory), normal);
          if constexpr (is_rotation_free)
            shear += 0.5 * motion.time_step * (to_vector(pair.spin_a) + to_vector(pair.spin_b)).dot(normal) *
                     normal.cross(shear);
          shear += law.shear_ratio * block.stiffness[i] * (step - step.dot(normal) * normal);
          const double cap = law.friction * block.force[i];
          const double square = shear.squaredNorm();
          const bool slides = square > cap * cap;
          if (slides)
            shear *= cap / std::sqrt(square);
          memory = Row{shear.x(), shear.y(), shear.z(), slides ? pair_slides : pair_sticks};

          const Vector force = shear - block.force[i] * normal;
          add(forces.force[a], force, block.stiffness[i]);
          add(forces.force[b], -force, block.stiffness[i]);
          if constexpr (is_rotation_free)
            {
              const Vector moment = normal.cross(shear);
              add(forces.torque[a], pair.arm_a * moment, pair.arm_a * pair.arm_a * block.stiffness[i]);
              add(forces.torque[b], pair.arm_b * moment, pair.arm_b * pair.arm_b * block.stiffness[i]);
            }
          sums.force_times_branch += force * branch.transpose();
          if (motion.has_contact_stress)
            {
              const double stress = compute_contact_stress(
                  block.force[i], compute_effective_radius(grains.place[a].w, grains.place[b].w), block.overlap[i]);
              forces.largest_stress[a] = std::max(forces.largest_stress[a], stress);
              forces.largest_stress[b] = std::max(forces.largest_stress[b], stress);
            }
          sums.normal_force += block.force[i];
          sums.stiffness_moment += block.stiffness[i] * block.distance[i] * block.distance[i];
        }
      sums.n_touching += block.n;
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
    ContactSums sums;
    Block block;
    for (std::size_t begin = 0; begin < network.size(); begin += Block::capacity)
      {
        gather(state, network, begin, std::min(begin + Block::capacity, network.size()), block);
        if (law.roughness > 0.)
          apply_normal_law(law, block);
        else
          apply_hertz_law(law, block);
        if (motion.is_rotation_free)
          scatter<true>(state, law, motion, network, block, forces, sums);
        else
          scatter<false>(state, law, motion, network, block, forces, sums);
      }
    return sums;
  }
} // namespace dem
