#include "fem/corotational_material.h"

namespace fem
{
  using dealii::SymmetricTensor;
  using dealii::Tensor;

  namespace
  {
    constexpr unsigned int n_numbers = 9 + 6 + 6; // rotation, stress, delayed strain

    void append(const CorotationalState &state, std::vector<double> &numbers)
    {
      for (unsigned int i = 0; i < 9; ++i)
        numbers.push_back(state.rotation[i / 3][i % 3]);
      for (const auto *tensor : {&state.stress, &state.delayed_strain})
        for (unsigned int i = 0; i < 6; ++i)
          numbers.push_back(tensor->access_raw_entry(i));
    }

    CorotationalState take(const double *numbers)
    {
      CorotationalState state;
      for (unsigned int i = 0; i < 9; ++i)
        state.rotation[i / 3][i % 3] = *numbers++;
      for (auto *tensor : {&state.stress, &state.delayed_strain})
        for (unsigned int i = 0; i < 6; ++i)
          tensor->access_raw_entry(i) = *numbers++;
      return state;
    }

    /** C turned into other axes: each column is the turned answer to a unit strain that is turned back. */
    SymmetricTensor<4, 3> rotate_modulus(const SymmetricTensor<4, 3> &modulus, const Tensor<2, 3> &rotation)
    {
      SymmetricTensor<4, 3> turned;
      const Tensor<2, 3> back = dealii::transpose(rotation);
      for (unsigned int k = 0; k < 3; ++k)
        for (unsigned int l = k; l < 3; ++l)
          {
            SymmetricTensor<2, 3> unit;
            unit[k][l] = k == l ? 1. : 0.5;
            const SymmetricTensor<2, 3> answer = rotate(modulus * rotate(unit, back), rotation);
            for (unsigned int i = 0; i < 3; ++i)
              for (unsigned int j = i; j < 3; ++j)
                turned[i][j][k][l] = answer[i][j];
          }
      return turned;
    }
  } // namespace

  void CorotationalMaterial::initialise(std::span<const PointSite> sites)
  {
    points_.clear();
    for (const PointSite &site : sites)
      {
        CorotationalState state;
        state.stress = site.initial_stress;
        points_[site.id] = {state, state, state};
      }
  }

  Status CorotationalMaterial::begin_step(double dt)
  {
    announce(dt);
    return Status::ok;
  }

  void CorotationalMaterial::evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                                      bool with_tangent)
  {
    for (std::size_t i = 0; i < requests.size(); ++i)
      {
        Point &point = points_.at(requests[i].id);
        const Tensor<2, 3> &increment = requests[i].deformation_increment;
        const Tensor<2, 3> &start = point.baseline.rotation;
        responses[i] = PointResponse();
        if (kinematics_ == Kinematics::finite && !(dealii::determinant(increment) > 0.))
          {
            responses[i].status = Status::failed;
            continue;
          }
        PolarDecomposition split;
        if (kinematics_ == Kinematics::finite)
          split = decompose_polar(increment);
        else
          split = {Tensor<2, 3>(dealii::unit_symmetric_tensor<3>()),
                   dealii::symmetrize(increment) - dealii::unit_symmetric_tensor<3>()};
        const LocalAnswer answer = respond(point.baseline, rotate(split.log_stretch, dealii::transpose(start)));
        point.trial = answer.state;
        point.trial.rotation = split.rotation * start;
        responses[i].stress = rotate(answer.state.stress, point.trial.rotation);
        if (with_tangent)
          responses[i].tangent = rotate_modulus(answer.modulus, point.trial.rotation);
      }
  }

  Settlement CorotationalMaterial::settle(bool)
  {
    for (auto &[id, point] : points_)
      point.baseline = point.trial;
    end_time();
    return {};
  }

  void CorotationalMaterial::commit()
  {
    for (auto &[id, point] : points_)
      point.committed = point.baseline;
  }

  void CorotationalMaterial::revert()
  {
    for (auto &[id, point] : points_)
      point.baseline = point.trial = point.committed;
    end_time();
  }

  void CorotationalMaterial::restart(std::span<const PointId> ids)
  {
    for (const PointId id : ids)
      points_.at(id) = {};
  }

  StateArchive CorotationalMaterial::make_archive() const
  {
    return {archive_group_, "corotational_states", "1, Pa, 1", n_numbers, communicator_};
  }

  void CorotationalMaterial::save(const std::string &file) const
  {
    std::map<PointId, std::vector<double>> states;
    for (const auto &[id, point] : points_)
      append(point.committed, states[id]);
    write_states(file, make_archive(), states);
  }

  void CorotationalMaterial::load(const std::string &file)
  {
    std::size_t n_found = 0;
    for (const auto &[id, numbers] : read_states(file, make_archive()))
      if (const auto point = points_.find(id); point != points_.end())
        {
          point->second.committed = take(numbers.data());
          ++n_found;
        }
    check_n_states(file, make_archive(), n_found, points_.size());
    revert();
  }
} // namespace fem
