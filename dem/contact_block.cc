#include "dem/contact_block.h"

#include "dem/power.h"

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    void apply_rough_law(const ContactLaw &law, ContactBlock &block)
    {
      const double first_scale = law.force_scale_1, second_scale = law.force_scale_2;
      const double first_length = 1. / law.dT1, second_length = 1. / (law.dT2 - law.d1);
      const double hertz_scale = 4. / 3. * law.effective_modulus, shift = law.d1 + law.d2;
      // Of its length: a touch of no depth gives no force, no 0/0, and a power within its range whatever the exponent.
      const double smallest = std::exp2(-900. / std::max(law.b, law.c));
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const double distance = std::sqrt(block.distance[i]);
          const double sum = block.overlap[i];
          const double d = sum - distance;
          const double root = std::sqrt(block.radius_product[i] / sum);
          block.distance[i] = distance;
          block.overlap[i] = d;
          const bool is_first = d <= law.dT1;
          const bool is_hertz = d > law.dT2;
          const double exponent = is_first ? law.c : law.b;
          const double length = is_first ? first_length : second_length;
          const double share = (is_first ? d : d - law.d1) * length;
          const double base = share > smallest ? share : smallest;
          const double rough = (is_first ? first_scale : second_scale) * compute_power(base, exponent);
          const double deep = is_hertz ? d - shift : 1.;
          const double n = root * (is_hertz ? hertz_scale * deep * std::sqrt(deep) : rough);
          block.force[i] = n;
          block.stiffness[i] = n * (is_hertz ? 1.5 / deep : exponent * length / base);
        }
    }

    void apply_hertz_law(const ContactLaw &law, ContactBlock &block)
    {
      const double scale = 4. / 3. * law.effective_modulus;
      for (std::size_t i = 0; i < block.n; ++i)
        {
          const double distance = std::sqrt(block.distance[i]);
          const double sum = block.overlap[i];
          const double d = sum - distance > 0. ? sum - distance : 0.; // rounding may leave a touch of no depth
          const double root = std::sqrt(block.radius_product[i] / sum * d);
          block.distance[i] = distance;
          block.overlap[i] = d;
          block.force[i] = scale * root * d;
          block.stiffness[i] = 1.5 * scale * root;
        }
    }
  } // namespace

  void gather_touching(const RevState &state, ContactNetwork &network, const std::size_t begin, const std::size_t end,
                       ContactBlock &block)
  {
    const Matrix h = state.cell.edges;
    const Row *place = state.grains.place.data();
    std::size_t n = 0;
    for (std::size_t k = begin; k < end; ++k)
      {
        const Row &a = place[network.a[k]], &b = place[network.b[k]];
        const double fx = b.x - a.x, fy = b.y - a.y, fz = b.z - a.z;
        const double gx = fx - __builtin_rint(fx), gy = fy - __builtin_rint(fy), gz = fz - __builtin_rint(fz);
        const double x = h(0, 0) * gx + h(0, 1) * gy + h(0, 2) * gz;
        const double y = h(1, 0) * gx + h(1, 1) * gy + h(1, 2) * gz;
        const double z = h(2, 0) * gx + h(2, 1) * gy + h(2, 2) * gz;
        const double square = x * x + y * y + z * z;
        const double sum = a.w + b.w;
        // Written always, counted when touching: no branch to mispredict.
        block.pair[n] = static_cast<std::uint32_t>(k);
        block.branch_x[n] = x;
        block.branch_y[n] = y;
        block.branch_z[n] = z;
        block.distance[n] = square;
        block.overlap[n] = sum;
        block.radius_product[n] = a.w * b.w;
        if (square < sum * sum)
          ++n;
        else
          network.shear[k] = Row{0., 0., 0., pair_is_apart};
      }
    block.n = n;
  }

  void apply_normal_law(const ContactLaw &law, ContactBlock &block)
  {
    law.roughness > 0. ? apply_rough_law(law, block) : apply_hertz_law(law, block);
  }

  void apply_shear_law(const ContactLaw &law, ContactBlock &block)
  {
    const double smallest = 1e-300; // keeps an unloaded contact's zero shear from 0/0
    for (std::size_t i = 0; i < block.n; ++i)
      {
        const double inverse = 1. / block.distance[i];
        const double nx = block.branch_x[i] * inverse, ny = block.branch_y[i] * inverse,
                     nz = block.branch_z[i] * inverse;
        const double tx = block.shear_x[i], ty = block.shear_y[i], tz = block.shear_z[i];
        const double along = tx * nx + ty * ny + tz * nz;
        const double flat_x = tx - along * nx, flat_y = ty - along * ny, flat_z = tz - along * nz;
        const double flat_square = flat_x * flat_x + flat_y * flat_y + flat_z * flat_z;
        const double size_square = tx * tx + ty * ty + tz * tz;
        const double turn = std::sqrt(size_square / (flat_square > smallest ? flat_square : smallest));
        const double kt = law.shear_ratio * block.stiffness[i];
        const double normal_step = block.step_x[i] * nx + block.step_y[i] * ny + block.step_z[i] * nz;
        const double sx = turn * flat_x + kt * (block.step_x[i] - normal_step * nx);
        const double sy = turn * flat_y + kt * (block.step_y[i] - normal_step * ny);
        const double sz = turn * flat_z + kt * (block.step_z[i] - normal_step * nz);
        const double cap = law.friction * block.force[i];
        const double square = sx * sx + sy * sy + sz * sz;
        const bool slides = square > cap * cap;
        const double keep = slides ? cap / std::sqrt(square) : 1.;
        block.shear_x[i] = keep * sx;
        block.shear_y[i] = keep * sy;
        block.shear_z[i] = keep * sz;
        block.status[i] = slides ? pair_slides : pair_sticks;
      }
  }
} // namespace dem
