#include "dem/stage_path.h"

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    double interpolate(const double start, const double end, const double share, const bool is_geometric)
    {
      return is_geometric && start * end > 0. ? start * std::pow(end / start, share) : start + share * (end - start);
    }

    void hold(CellControl &control, const int component, const double stress)
    {
      control.is_stress_controlled[component] = true;
      control.target_stress(component, component) = stress;
    }

    /** Exponential of a symmetric matrix. */
    Matrix compute_exponential(const Matrix &symmetric)
    {
      const Eigen::SelfAdjointEigenSolver<Matrix> eigen(symmetric);
      return eigen.eigenvectors() * eigen.eigenvalues().array().exp().matrix().asDiagonal() *
             eigen.eigenvectors().transpose();
    }

    /** Stretch from the baseline to a logarithmic strain since the first stage, tension-positive. */
    Matrix compute_stretch_to(const Matrix &strain, const RevState &baseline)
    {
      const Matrix f =
          compute_exponential(strain) * compute_exponential(-compute_logarithmic_strain(baseline.cell.deformation));
      return 0.5 * (f + f.transpose());
    }

    void add_creep(const LaboratoryStage &stage, const LaboratoryPosition &position, CellControl &control)
    {
      hold(control, 2, position.stress_at_start(2, 2));
      if (stage.held == HeldStress::all_normal)
        for (int k = 0; k < 2; ++k)
          hold(control, k, position.stress_at_start(k, k));
    }

    void strain_axially(const LaboratoryStage &stage, const LaboratoryPosition &position, const double share,
                        const RevState &baseline, CellControl &control)
    {
      const double start = position.strain_at_start(2, 2);
      const double target = start + share * (-stage.axial_strain - start);
      control.stretch(2, 2) = std::exp(target - compute_logarithmic_strain(baseline.cell.deformation)(2, 2));
    }

    /** Volume at a share of the way, in equal steps of logarithmic strain. */
    void strain_in_volume(const LaboratoryStage &stage, const LaboratoryPosition &position, const double share,
                          const RevState &baseline, CellControl &control)
    {
      const double start = position.strain_at_start.trace();
      const double target = start + share * (-stage.volumetric_strain - start);
      const double left = target - compute_logarithmic_strain(baseline.cell.deformation).trace();
      control.stretch = std::exp(left / 3.) * Matrix::Identity();
      control.follows_volume = true;
      for (int k = 0; k < 3; ++k)
        control.is_stress_controlled[k] = true;
    }

    void hold_laterally(CellControl &control, const double stress)
    {
      hold(control, 0, stress);
      hold(control, 1, stress);
    }

    /** q at a share of the way, in equal steps: it begins near zero, where equal factors have no meaning. */
    double compute_deviator_on_the_way(const LaboratoryStage &stage, const LaboratoryPosition &position,
                                       const double share)
    {
      const double start = compute_deviator(position.stress_at_start);
      return start + share * (compute_target_deviator(stage, position) - start);
    }

    void add_triaxial(const LaboratoryStage &stage, const LaboratoryPosition &position, const double share,
                      const RevState &baseline, CellControl &control)
    {
      const double lateral = compute_lateral_stress(position.stress_at_start);
      hold_laterally(control, lateral);
      if (is_to_deviator(stage))
        hold(control, 2, lateral - compute_deviator_on_the_way(stage, position, share));
      else
        strain_axially(stage, position, share, baseline, control);
    }

    void add_constant_p(const LaboratoryStage &stage, const LaboratoryPosition &position, const double share,
                        const RevState &baseline, CellControl &control)
    {
      const double mean = position.stress_at_start.trace() / 3.;
      if (is_to_deviator(stage))
        {
          const double deviator = compute_deviator_on_the_way(stage, position, share);
          hold_laterally(control, mean + deviator / 3.);
          return hold(control, 2, mean - 2. * deviator / 3.);
        }
      // Exact where axial and lateral stress stay in proportion; what is left shrinks from one correction to the next.
      hold_laterally(control, compute_lateral_stress(baseline.stress) * mean / (baseline.stress.trace() / 3.));
      strain_axially(stage, position, share, baseline, control);
    }
  } // namespace

  CellControl compute_control(const LaboratoryStage &stage, const LaboratoryPosition &position, const double share,
                              const RevState &baseline)
  {
    CellControl control;
    switch (stage.kind)
      {
      case StageKind::isotropic:
        if (stage.stress == 0.)
          strain_in_volume(stage, position, share, baseline, control);
        else
          for (int k = 0; k < 3; ++k)
            hold(control, k, interpolate(position.stress_at_start(k, k), -stage.stress, share, stage.is_geometric));
        break;
      case StageKind::oedometric:
        if (stage.stress == 0.)
          strain_axially(stage, position, share, baseline, control);
        else
          hold(control, 2, interpolate(position.stress_at_start(2, 2), -stage.stress, share, stage.is_geometric));
        break;
      case StageKind::triaxial:
      case StageKind::strength_search:
        add_triaxial(stage, position, share, baseline, control);
        break;
      case StageKind::constant_p:
        add_constant_p(stage, position, share, baseline, control);
        break;
      case StageKind::creep:
        add_creep(stage, position, control);
        break;
      case StageKind::relaxation:
        break;
      case StageKind::strain_path:
        control.stretch =
            compute_stretch_to(position.strain_at_start + share * (-stage.strain - position.strain_at_start), baseline);
        break;
      }
    return control;
  }

  double compute_time_to_output(const LaboratoryStage &stage, const double time_in_stage)
  {
    double next = stage.duration;
    if (is_held(stage))
      {
        // Outputs at first * 10^(k / points): the first k beyond now, with a margin for the rounding of 10^x.
        const double k = std::floor(std::log10(std::max(time_in_stage, 1e-300) / stage.first_output) *
                                        stage.points_per_decade * (1. + 1e-12) +
                                    1e-9) +
                         1.;
        next = std::min(next, stage.first_output * std::pow(10., std::max(0., k) / stage.points_per_decade));
      }
    return next - time_in_stage;
  }

  bool is_put_back(const LaboratoryStage &stage)
  {
    return stage.kind == StageKind::strength_search && stage.goes_back;
  }

  double compute_lateral_stress(const Matrix &stress)
  {
    return 0.5 * (stress(0, 0) + stress(1, 1));
  }

  double compute_deviator(const Matrix &stress)
  {
    return compute_lateral_stress(stress) - stress(2, 2);
  }

  double compute_target_deviator(const LaboratoryStage &stage, const LaboratoryPosition &position)
  {
    if (stage.strength_share == 0.)
      return stage.deviatoric_stress;
    return stage.strength_share * (stage.strength > 0. ? stage.strength : position.strength);
  }

  bool is_to_deviator(const LaboratoryStage &stage)
  {
    return (stage.kind == StageKind::triaxial || stage.kind == StageKind::constant_p) && stage.axial_strain == 0.;
  }

  bool is_to_stress(const LaboratoryStage &stage)
  {
    const bool is_by_stress = stage.kind == StageKind::isotropic || stage.kind == StageKind::oedometric;
    return (is_by_stress && stage.stress != 0.) || is_to_deviator(stage);
  }

  bool is_mean_stress_held(const LaboratoryStage &stage, const LaboratoryPosition &position, const RevState &state,
                           const double tolerance)
  {
    if (stage.kind != StageKind::constant_p || is_to_deviator(stage))
      return true;
    const double mean = position.stress_at_start.trace();
    return std::abs(state.stress.trace() - mean) <= tolerance * std::abs(mean);
  }

  bool is_held(const LaboratoryStage &stage)
  {
    return stage.kind == StageKind::creep || stage.kind == StageKind::relaxation;
  }
} // namespace dem
