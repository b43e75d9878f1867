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

    void add_triaxial(const LaboratoryStage &stage, const LaboratoryPosition &position, const double share,
                      const RevState &baseline, CellControl &control)
    {
      const double lateral = 0.5 * (position.stress_at_start(0, 0) + position.stress_at_start(1, 1));
      hold(control, 0, lateral);
      hold(control, 1, lateral);
      const double start = position.strain_at_start(2, 2);
      const double target = start + share * (-stage.axial_strain - start);
      control.stretch(2, 2) = std::exp(target - compute_logarithmic_strain(baseline.cell.deformation)(2, 2));
    }
  } // namespace

  CellControl compute_control(const LaboratoryStage &stage, const LaboratoryPosition &position, const double share,
                              const RevState &baseline)
  {
    CellControl control;
    switch (stage.kind)
      {
      case StageKind::isotropic:
        for (int k = 0; k < 3; ++k)
          hold(control, k, interpolate(position.stress_at_start(k, k), -stage.stress, share, stage.is_geometric));
        break;
      case StageKind::oedometric:
        hold(control, 2, interpolate(position.stress_at_start(2, 2), -stage.stress, share, stage.is_geometric));
        break;
      case StageKind::triaxial:
        add_triaxial(stage, position, share, baseline, control);
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

  bool is_held(const LaboratoryStage &stage)
  {
    return stage.kind == StageKind::creep || stage.kind == StageKind::relaxation;
  }
} // namespace dem
