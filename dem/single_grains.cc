#include "dem/single_grains.h"

namespace dem
{
  namespace
  {
    constexpr double n_counts = 4294967296.; // of an edge: 2^32

    SingleRow to_single(const Row &row, const double w)
    {
      return {static_cast<float>(row.x), static_cast<float>(row.y), static_cast<float>(row.z), static_cast<float>(w)};
    }
  } // namespace

  SingleMatrix::SingleMatrix(const Matrix &m)
      : xx(m(0, 0)), xy(m(0, 1)), xz(m(0, 2)), yx(m(1, 0)), yy(m(1, 1)), yz(m(1, 2)), zx(m(2, 0)), zy(m(2, 1)),
        zz(m(2, 2))
  {}

  SingleTask make_single_task(const ForceTask &task, const ContactNetwork &network)
  {
    const Matrix &edges = task.state.cell.edges, &then = network.edges_when_built;
    const Matrix &strain = task.motion.strain_increment;
    return {task.law,
            SingleMatrix(edges / n_counts),
            SingleMatrix((edges - then) * then.inverse()),
            SingleMatrix(strain),
            then.isDiagonal(0.) && edges.isDiagonal(0.) && strain.isDiagonal(0.),
            static_cast<float>(task.motion.time_step),
            task.motion.has_contact_stress,
            task.motion.has_sums};
  }

  void SingleGrains::load(const Grains &grains, const std::size_t n_copies)
  {
    counts.resize(grains.size() + n_copies);
    motion.resize(grains.size() + n_copies);
    for (std::size_t i = 0; i < grains.size(); ++i)
      {
        counts[i] = {0, 0, 0, static_cast<float>(grains.velocity[i].w)};
        motion[i] = {to_single(grains.velocity[i], grains.place[i].w), to_single(grains.spin[i], grains.spin[i].w)};
      }
  }

  void SingleGrains::write(const ContactNetwork &network, const std::size_t begin, const std::size_t end,
                           Grains &grains) const
  {
    for (std::size_t i = begin; i < end; ++i)
      {
        const Row &then = network.place_when_built[i];
        Row &place = grains.place[i], &velocity = grains.velocity[i], &spin = grains.spin[i];
        place = {then.x + counts[i].x / n_counts, then.y + counts[i].y / n_counts, then.z + counts[i].z / n_counts,
                 place.w};
        const auto &[linear, angular] = motion[i];
        velocity = {linear.x, linear.y, linear.z, velocity.w};
        spin = {angular.x, angular.y, angular.z, spin.w};
      }
  }

  void round_places(Grains &grains)
  {
    const auto round = [](const double fraction) { return __builtin_rint(fraction * n_counts) / n_counts; };
    for (Row &place : grains.place)
      place = {round(place.x), round(place.y), round(place.z), place.w};
  }
} // namespace dem
