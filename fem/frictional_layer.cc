#include "fem/frictional_layer.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace fem
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    const Tensor<2, 3> identity(dealii::unit_symmetric_tensor<3>());
    constexpr std::size_t n_numbers = 3 + 1 + 3 + 6 + 1;

    SymmetricTensor<2, 3> compute_symmetric_product(const Tensor<1, 3> &a, const Tensor<1, 3> &b)
    {
      return dealii::symmetrize(dealii::outer_product(a, b));
    }

    /** Smallest rotation from one direction to another. @pre they are not opposite */
    Tensor<2, 3> compute_turn(const Tensor<1, 3> &from, const Tensor<1, 3> &to)
    {
      const Tensor<2, 3> spin = dealii::outer_product(to, from) - dealii::outer_product(from, to);
      return identity + spin + spin * spin / (1. + from * to);
    }

    SymmetricTensor<2, 3> assemble_stress(const LayerState &state, const double pressure)
    {
      return -pressure * compute_symmetric_product(state.normal, state.normal) +
             2. * compute_symmetric_product(state.shear, state.normal) + state.in_plane;
    }

    /** Some direction at right angles to another. */
    Tensor<1, 3> compute_perpendicular(const Tensor<1, 3> &normal)
    {
      unsigned int least = 0;
      for (unsigned int d = 1; d < 3; ++d)
        if (std::abs(normal[d]) < std::abs(normal[least]))
          least = d;
      Tensor<1, 3> axis;
      axis[least] = 1.;
      const Tensor<1, 3> perpendicular = axis - (axis * normal) * normal;
      return perpendicular / perpendicular.norm();
    }

    Tensor<1, 3> choose_normal(const LayerNormal normal, const dealii::Point<3> &place)
    {
      Tensor<1, 3> direction;
      if (normal == LayerNormal::radial)
        {
          direction[0] = place[0];
          direction[1] = place[1];
          return direction / direction.norm();
        }
      direction[normal == LayerNormal::x ? 0 : normal == LayerNormal::y ? 1 : 2] = 1.;
      return direction;
    }
  } // namespace

  FrictionalLayer::FrictionalLayer(const FrictionalLayerParameters &parameters, MPI_Comm communicator)
      : parameters_(parameters), communicator_(communicator)
  {
    for (const auto &[name, modulus] :
         {std::pair("normal modulus", parameters.normal_modulus), std::pair("shear modulus", parameters.shear_modulus)})
      if (!(modulus > 0.))
        throw std::invalid_argument(fmt::format("frictional layer: {} = {} must be > 0 Pa", name, modulus));
    if (!(parameters.friction >= 0.))
      throw std::invalid_argument(fmt::format("frictional layer: friction = {} must be >= 0", parameters.friction));
  }

  void FrictionalLayer::initialise(std::span<const PointSite> sites)
  {
    points_.clear();
    for (const PointSite &site : sites)
      {
        LayerState state;
        state.normal = choose_normal(parameters_.normal, site.position);
        const Tensor<1, 3> traction = site.initial_stress * state.normal;
        state.strain = traction * state.normal / parameters_.normal_modulus;
        state.shear = traction - (traction * state.normal) * state.normal;
        state.in_plane = site.initial_stress - 2. * compute_symmetric_product(state.shear, state.normal) -
                         (traction * state.normal) * compute_symmetric_product(state.normal, state.normal);
        points_[site.id] = {state, state, state};
      }
  }

  // A fibre across the layer at the baseline ends on the other face: what it has become along the faces' normal is the
  // thickness, what it has become along them is the slide. Faces are carried along by F^-T.
  FrictionalLayer::Motion FrictionalLayer::compute_motion(const LayerState &start, const Tensor<2, 3> &increment) const
  {
    const Tensor<1, 3> &normal = start.normal;
    Motion motion;
    if (parameters_.kinematics == Kinematics::small)
      {
        const Tensor<1, 3> doubled =
            2. * ((dealii::symmetrize(increment) - dealii::unit_symmetric_tensor<3>()) * normal);
        const double strain = 0.5 * (doubled * normal);
        return {normal, 1. + strain, doubled - (doubled * normal) * normal, identity};
      }
    motion.normal = dealii::transpose(dealii::invert(increment)) * normal;
    motion.normal /= motion.normal.norm();
    const Tensor<1, 3> fibre = increment * normal;
    motion.opening = fibre * motion.normal;
    motion.slide = fibre - motion.opening * motion.normal;
    const Tensor<2, 3> rotation = decompose_polar(increment).rotation;
    motion.turn = compute_turn(rotation * normal, motion.normal) * rotation;
    return motion;
  }

  double FrictionalLayer::compute_pressure(const LayerState &state) const
  {
    return std::max(0., -parameters_.normal_modulus * state.strain);
  }

  LayerState FrictionalLayer::respond(const LayerState &start, const Motion &motion) const
  {
    LayerState now = start;
    now.normal = motion.normal;
    now.strain += parameters_.kinematics == Kinematics::small ? motion.opening - 1. : std::log(motion.opening);
    now.in_plane = rotate(start.in_plane, motion.turn);
    now.shear = motion.turn * start.shear + parameters_.shear_modulus * motion.slide;
    const double size = now.shear.norm(), limit = parameters_.friction * compute_pressure(now);
    if (size > limit)
      {
        now.slip += (size - limit) / parameters_.shear_modulus;
        now.shear *= limit / size;
      }
    return now;
  }

  // Change of stress with strains of the layer's own frame, less what the solver adds for the spin of such a motion
  // (assembly.cc): shear is taken as slide along the faces, which does not turn them.
  SymmetricTensor<4, 3> FrictionalLayer::compute_tangent(const LayerState &start, const Motion &motion,
                                                         const LayerState &now) const
  {
    const double pressure = compute_pressure(now), limit = parameters_.friction * pressure;
    const Tensor<1, 3> tried = motion.turn * start.shear + parameters_.shear_modulus * motion.slide;
    const bool slips = tried.norm() > limit;
    const Tensor<1, 3> direction = slips ? tried / tried.norm() : Tensor<1, 3>();
    const Tensor<2, 3> stress(assemble_stress(now, pressure));
    const bool is_finite = parameters_.kinematics == Kinematics::finite;

    const double stiffness = pressure > 0. ? parameters_.normal_modulus : 0.;
    const auto normal_part = compute_symmetric_product(now.normal, now.normal);
    SymmetricTensor<2, 3> answer = stiffness * normal_part;
    answer -= 2. * parameters_.friction * stiffness * compute_symmetric_product(direction, now.normal);
    SymmetricTensor<4, 3> tangent = dealii::outer_product(answer, normal_part);
    const Tensor<1, 3> first = compute_perpendicular(now.normal);
    for (const Tensor<1, 3> &along : {first, dealii::cross_product_3d(now.normal, first)})
      {
        Tensor<1, 3> change = parameters_.shear_modulus * (is_finite ? motion.opening : 1.) * along;
        if (slips)
          change = limit / tried.norm() * (change - (change * direction) * direction);
        answer = 2. * compute_symmetric_product(change, now.normal);
        if (is_finite)
          {
            const Tensor<2, 3> slide = dealii::outer_product(along, now.normal);
            const Tensor<2, 3> spin = 0.5 * (slide - dealii::transpose(slide));
            answer -= dealii::symmetrize(spin * stress - stress * spin);
          }
        tangent += dealii::outer_product(answer, 2. * compute_symmetric_product(along, now.normal));
      }
    return tangent;
  }

  void FrictionalLayer::evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                                 bool with_tangent)
  {
    for (std::size_t i = 0; i < requests.size(); ++i)
      {
        Point &point = points_.at(requests[i].id);
        responses[i] = PointResponse();
        if (parameters_.kinematics == Kinematics::finite &&
            !(dealii::determinant(requests[i].deformation_increment) > 0.))
          {
            responses[i].status = Status::failed;
            continue;
          }
        const Motion motion = compute_motion(point.baseline, requests[i].deformation_increment);
        point.trial = respond(point.baseline, motion);
        responses[i].stress = assemble_stress(point.trial, compute_pressure(point.trial));
        if (with_tangent)
          responses[i].tangent = compute_tangent(point.baseline, motion, point.trial);
      }
  }

  Settlement FrictionalLayer::settle(bool)
  {
    for (auto &[id, point] : points_)
      point.baseline = point.trial;
    return {};
  }

  void FrictionalLayer::commit()
  {
    for (auto &[id, point] : points_)
      point.committed = point.baseline;
  }

  void FrictionalLayer::revert()
  {
    for (auto &[id, point] : points_)
      point.baseline = point.trial = point.committed;
  }

  std::vector<double> FrictionalLayer::compute_fields(PointId id) const
  {
    const auto point = points_.find(id);
    if (point == points_.end())
      return {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::quiet_NaN()};
    const LayerState &state = point->second.committed;
    const double limit = parameters_.friction * compute_pressure(state);
    return {state.slip, limit > 0. ? state.shear.norm() / limit : std::numeric_limits<double>::quiet_NaN()};
  }

  StateArchive FrictionalLayer::make_archive() const
  {
    return {archive_group_, "layer_states", "1, 1, Pa, Pa, 1", n_numbers, communicator_};
  }

  void FrictionalLayer::save(const std::string &file) const
  {
    std::map<PointId, std::vector<double>> states;
    for (const auto &[id, point] : points_)
      {
        const LayerState &state = point.committed;
        std::vector<double> &numbers = states[id];
        for (const Tensor<1, 3> *vector : {&state.normal, &state.shear})
          for (unsigned int d = 0; d < 3; ++d)
            numbers.push_back((*vector)[d]);
        for (unsigned int m = 0; m < 6; ++m)
          numbers.push_back(state.in_plane.access_raw_entry(m));
        numbers.insert(numbers.end(), {state.strain, state.slip});
      }
    write_states(file, make_archive(), states);
  }

  void FrictionalLayer::load(const std::string &file)
  {
    std::size_t n_found = 0;
    for (const auto &[id, numbers] : read_states(file, make_archive()))
      if (const auto point = points_.find(id); point != points_.end())
        {
          LayerState &state = point->second.committed;
          auto from = numbers.begin();
          for (Tensor<1, 3> *vector : {&state.normal, &state.shear})
            for (unsigned int d = 0; d < 3; ++d)
              (*vector)[d] = *from++;
          for (unsigned int m = 0; m < 6; ++m)
            state.in_plane.access_raw_entry(m) = *from++;
          state.strain = *from++;
          state.slip = *from++;
          ++n_found;
        }
    check_n_states(file, make_archive(), n_found, points_.size());
    revert();
  }
} // namespace fem
