#include "dem/programme_check.h"

#include "dem/stage_path.h"

#include <algorithm>
#include <cmath>

namespace dem
{
  namespace
  {
    /** A way to say where a load ends. */
    struct Target
    {
      const char *quantity;
      double value;
      bool is_allowed;
    };

    std::vector<Target> list_targets(const LaboratoryStage &stage)
    {
      const bool is_sheared = stage.kind == StageKind::triaxial || stage.kind == StageKind::constant_p;
      const bool is_oedometric = stage.kind == StageKind::oedometric;
      return {
          {"Stress", stage.stress, stage.kind == StageKind::isotropic || is_oedometric},
          {"Volumetric strain", stage.volumetric_strain, stage.kind == StageKind::isotropic},
          {"Axial strain", stage.axial_strain, is_sheared || is_oedometric || stage.kind == StageKind::strength_search},
          {"Deviatoric stress", stage.deviatoric_stress, is_sheared},
          {"Share of q_max", stage.strength_share, is_sheared}};
    }

    /** The rules of one stage, which may look at the stages before it. */
    class StageCheck
    {
    public:
      StageCheck(const std::vector<LaboratoryStage> &stages, const std::size_t i)
          : stages_(stages), i_(i), stage_(stages[i])
      {}

      void run(const CellKind kind) const
      {
        if (is_held(stage_))
          check_held();
        check_targets();
        if (stage_.stress != 0.)
          require(stage_.stress > 0., "Stress", "the stress at its end must be above 0 Pa (compression-positive)");
        if (stage_.kind == StageKind::strength_search)
          check_search();
        check_strength();
        if (stage_.kind == StageKind::constant_p)
          check_constant_p();
        if (kind == CellKind::rigid && stage_.kind == StageKind::strain_path)
          require(stage_.strain.isDiagonal(0.), "Strain",
                  "rigid walls cannot shear: xy, yz and xz must be 0, or the boundary periodic");
      }

    private:
      void require(const bool is_met, const std::string &quantity, const std::string &what) const
      {
        if (!is_met)
          throw StageContradiction(i_, quantity, "stage " + std::to_string(i_ + 1) + " (" + stage_.name + "): " + what);
      }

      void check_held() const
      {
        require(stage_.duration > 0., "Duration", "a stage that holds its load needs a duration above 0 s");
        require(i_ > 0, "Kind", "a stage that holds its load needs a loading stage before it");
        require(stage_.first_output > 0. && stage_.first_output <= stage_.duration, "First output",
                "the first output must lie between 0 s and the duration");
      }

      void check_targets() const
      {
        std::string allowed, given;
        for (const Target &target : list_targets(stage_))
          {
            const std::string quantity = target.quantity;
            if (target.is_allowed)
              allowed += (allowed.empty() ? "" : ", ") + quantity;
            if (target.value == 0.)
              continue;
            require(target.is_allowed, quantity, quantity + " is no target of a stage of this kind");
            require(given.empty(), quantity, given + " is given already: a stage has one target");
            given = quantity;
          }
        require(allowed.empty() || !given.empty(), "Kind",
                "a stage of this kind needs a target other than 0, one of: " + allowed);
      }

      void check_search() const
      {
        require(stage_.axial_strain > 0., "Axial strain",
                "a search for q_max compresses: the largest axial strain must be above 0");
        require(stage_.strength_drop > 0. && stage_.strength_drop < 1., "Drop below q_max",
                "the share by which q falls below its maximum must lie between 0 and 1");
      }

      void check_strength() const
      {
        if (stage_.strength_share == 0.)
          return require(stage_.strength == 0., "q_max", "q_max serves Share of q_max alone, which is not given");
        require(stage_.strength_share > 0., "Share of q_max", "must be above 0");
        require(stage_.strength >= 0., "q_max", "must be above 0 Pa, or 0 for that of a search before");
        const auto end = stages_.begin() + static_cast<long>(i_);
        const bool is_searched = std::any_of(stages_.begin(), end, [](const LaboratoryStage &stage) {
          return stage.kind == StageKind::strength_search;
        });
        require(stage_.strength > 0. || is_searched, "Share of q_max",
                "a share of q_max needs its value above 0 Pa, or a stage before that searches for it");
      }

      /** Where mean stress and q are both known beforehand. */
      void check_constant_p() const
      {
        require(i_ > 0, "Kind", "a stage at constant p needs a stage before it that brings p about");
        const LaboratoryStage &before = stages_[i_ - 1];
        const double deviator =
            stage_.strength_share == 0. ? stage_.deviatoric_stress : stage_.strength_share * stage_.strength;
        if (before.kind == StageKind::isotropic && before.stress != 0.)
          require(deviator < 3. * before.stress && deviator > -1.5 * before.stress,
                  stage_.strength_share == 0. ? "Deviatoric stress" : "Share of q_max",
                  "at a mean stress of p, q must lie between -1.5 p and 3 p: grains bear no tension");
      }

      const std::vector<LaboratoryStage> &stages_;
      const std::size_t i_;
      const LaboratoryStage &stage_;
    };
  } // namespace

  void check_programme(const std::vector<LaboratoryStage> &stages, const CellKind kind)
  {
    if (stages.empty())
      throw std::invalid_argument("the programme has no stage");
    for (std::size_t i = 0; i < stages.size(); ++i)
      StageCheck(stages, i).run(kind);
  }
} // namespace dem
