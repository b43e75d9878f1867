#pragma once

#include "coupling/rev_material.h"

#include "dem/packing.h"
#include "dem/rev.h"

#include <Eigen/Geometry>

/** REVs small enough for a unit test. */
namespace rev_sample
{
  /** Seventy grains, packed with a given friction: no search. */
  inline dem::PackingRule make_packing_rule()
  {
    dem::PackingRule rule;
    rule.n_grains = 70;
    rule.friction = 0.1;
    rule.void_ratio = 0.65;
    rule.tolerance = 1.; // whatever that friction gives
    rule.pressure = 1e6;
    return rule;
  }

  inline dem::RevModel make_model(const bool is_rotation_free = false)
  {
    dem::RevModel model;
    model.dynamics.motion.is_rotation_free = is_rotation_free;
    return model;
  }

  inline dem::Rev make_rev(const dem::RevModel &model)
  {
    return dem::make_rev(model, dem::generate_packing(make_packing_rule(), model.material, model.dynamics).state);
  }

  inline dealii::SymmetricTensor<2, 3> make_pressure(const double pressure)
  {
    return -pressure * dealii::unit_symmetric_tensor<3>();
  }

  /** A material with points 3 and 8 at 1 MPa. */
  inline coupling::RevMaterialParameters make_parameters()
  {
    coupling::RevMaterialParameters parameters;
    parameters.model = make_model();
    parameters.packing.rule = make_packing_rule();
    return parameters;
  }

  inline std::vector<fem::PointSite> make_sites()
  {
    return {{3, {}, make_pressure(1e6)}, {8, {}, make_pressure(1e6)}};
  }

  inline coupling::RevPool make_pool()
  {
    return {MPI_COMM_WORLD, true, 1};
  }

  inline dem::Matrix make_rotation(const double degrees)
  {
    const dem::Vector axis = dem::Vector(1., -2., 0.5).normalized(); // no axis of anything else
    return Eigen::AngleAxisd(degrees * 3.14159265358979323846 / 180., axis).toRotationMatrix();
  }
} // namespace rev_sample
