#include "apps/rev_case.h"

#include "apps/creep_parameters.h"

#include "dem/programme_check.h"

#include <fmt/format.h>

#include <sstream>

namespace apps
{
  namespace
  {
    /** What the file gives as lists of numbers and the program as a tensor. */
    struct StageText
    {
      std::vector<double> strain = std::vector<double>(6, 0.);
    };

    /** Stages with every default; `is_example`: the two of the template, which make a whole run. */
    std::vector<dem::LaboratoryStage> make_default_stages(const unsigned int n, const bool is_example)
    {
      std::vector<dem::LaboratoryStage> stages(n);
      for (unsigned int k = 0; k < n; ++k)
        {
          stages[k].name = fmt::format("stage {}", k + 1);
        }
      if (is_example)
        {
          stages[0].kind = dem::StageKind::oedometric;
          stages[0].stress = 21.7e6;
          stages[1].kind = dem::StageKind::creep;
          stages[1].duration = 1e6;
        }
      return stages;
    }

    /** Where a load ends: one of them is given. */
    void bind_targets(ParameterBinder &binder, dem::LaboratoryStage &stage)
    {
      binder.bind("Stress", stage.stress, any_number,
                  "Pressure (isotropic) or axial stress (oedometric) at the end, compression-positive; 0: not given. "
                  "Units: [Pa].");
      binder.bind("Axial strain", stage.axial_strain, {-1., 1.},
                  "Oedometric, triaxial, constant p: at the end; strength search: the largest; logarithmic since stage "
                  "1, compression-positive; 0: not given. Units: [-].");
      binder.bind("Volumetric strain", stage.volumetric_strain, {-1., 1.},
                  "Isotropic: at the end, the three normal stresses equal meanwhile; logarithmic since stage 1, "
                  "compression-positive; 0: not given. Units: [-].");
      binder.bind("Deviatoric stress", stage.deviatoric_stress, any_number,
                  "Triaxial, constant p: q, axial less lateral stress, at the end; 0: not given. Units: [Pa].");
      binder.bind("Share of q_max", stage.strength_share, {0., 10.},
                  "Triaxial, constant p: q at the end over q_max; 0: not given. Units: [-].");
      binder.bind("q_max", stage.strength, non_negative,
                  "For Share of q_max; 0: that found by the strength search before. Units: [Pa].");
      binder.bind("Drop below q_max", stage.strength_drop, {0., 1., true, true},
                  "Strength search: it ends once q has fallen by this share of its maximum. Units: [-].");
      binder.bind("Goes back", stage.goes_back,
                  "Strength search: the REV is put back to where the search began, and q_max alone is kept. Units: "
                  "none.");
    }

    void bind_stage(ParameterBinder &binder, const std::string &section, dem::LaboratoryStage &stage, StageText &text)
    {
      using dem::HeldStress;
      using dem::StageKind;
      binder.enter(section);
      binder.bind("Name", stage.name, "What the progress and the messages call it. Units: none.");
      binder.bind_choice<StageKind>(
          "Kind", stage.kind,
          {{"isotropic", StageKind::isotropic},
           {"oedometric", StageKind::oedometric},
           {"triaxial", StageKind::triaxial},
           {"constant p", StageKind::constant_p},
           {"strength search", StageKind::strength_search},
           {"creep", StageKind::creep},
           {"relaxation", StageKind::relaxation},
           {"strain path", StageKind::strain_path}},
          "isotropic: three equal stresses, or a volume; oedometric: axial stress or strain, no lateral strain; "
          "triaxial: axial "
          "strain or deviatoric stress, lateral stresses held; constant p: the same, mean stress held; strength "
          "search: "
          "axial strain at held lateral stresses until q has passed its maximum; creep: stresses held; relaxation: "
          "strain held; strain path: six strains. Units: none.");
      bind_targets(binder, stage);
      binder.bind_list("Strain", text.strain, 6,
                       "Strain path: xx, yy, zz, xy, yz, xz at the end, logarithmic since stage 1, "
                       "compression-positive, tensor shear. Units: [-].");
      binder.bind_choice<HeldStress>("Held stresses", stage.held,
                                     {{"axial", HeldStress::axial}, {"all normal", HeldStress::all_normal}},
                                     "Creep: axial (oedometer) or all normal (triaxial). Units: none.");
      binder.bind("Duration", stage.duration, non_negative, "0: a load without time. Units: [s].");
      binder.bind("Increments", stage.n_increments, {1., 1e6}, "Of a load. Units: [-].");
      binder.bind_choice<bool>("Spacing", stage.is_geometric, {{"geometric", true}, {"linear", false}},
                               "Of stress increments: equal factors or equal steps. Units: none.");
      binder.bind("First output", stage.first_output, positive,
                  "Creep and relaxation: first time since the stage began that is written for certain. Units: [s].");
      binder.bind("Points per decade", stage.points_per_decade, {1., 1000.},
                  "Creep and relaxation: times written for certain after the first. Units: [-].");
      binder.leave();
    }

    void bind_boundary(ParameterBinder &binder, RevParameters &parameters)
    {
      binder.enter("Boundary");
      binder.bind_choice<dem::CellKind>(
          "Kind", parameters.packing.cell_kind,
          {{"periodic", dem::CellKind::periodic}, {"walls", dem::CellKind::rigid}},
          "What bounds the REV: a periodic cell, or six rigid walls that a servo moves; between walls, held stresses "
          "are those on the walls. Units: none.");
      binder.bind("Wall friction", parameters.model.material.wall_friction, non_negative,
                  "mu between a grain and a wall. Units: [-].");
      binder.leave();
    }

    void bind_laboratory(ParameterBinder &binder, RevCase &rev_case)
    {
      binder.enter("Laboratory");
      binder.bind("Smallest share", rev_case.laboratory.smallest_share, {0., 1., true, false},
                  "Of an increment: below it the increment is not halved again. Units: [-].");
      binder.bind("Round cap", rev_case.laboratory.round_cap, {1., 1e6},
                  "Equilibria of one avalanche of fractures, beyond which it is a rupture. Units: [-].");
      binder.bind("Flow strain", rev_case.laboratory.flow_strain, positive,
                  "Largest strain that one dynamic computation under held stress may bring: beyond it a creep has "
                  "ruptured. Units: [-].");
      binder.bind("Rupture strain", rev_case.laboratory.rupture_strain, positive,
                  "Of a creep under held normal stresses, since it began: beyond it the creep has ruptured, however "
                  "gently it came there. Units: [-].");
      binder.bind("Largest strain", rev_case.laboratory.largest_strain, positive,
                  "Of a load that goes to a stress, since the load began: beyond it the stress is not reached. Units: "
                  "[-].");
      binder.bind("Unstable swing", rev_case.laboratory.unstable_swing, positive,
                  "Of a controlled stress to both sides, over the largest target: one that does not come to rest and "
                  "swings by more has an unstable servo. Units: [-].");
      binder.bind("Checkpoint interval", rev_case.checkpoint_interval, non_negative,
                  "Wall time between checkpoints; the results do not depend on it. Units: [s].");
      binder.leave();
    }

    /** Which of the REV's stages contradicts itself, as a mistake in the file. */
    void check_stages(const ParameterBinder &binder, const std::vector<dem::LaboratoryStage> &stages,
                      const dem::CellKind kind)
    {
      try
        {
          dem::check_programme(stages, kind);
        }
      catch (const dem::StageContradiction &error)
        {
          binder.reject(fmt::format("Stage {}/{}", error.stage + 1, error.quantity),
                        fmt::format("is not allowed: {}", std::string(error.what())));
        }
    }
  } // namespace

  RevCase read_rev_case(const ParameterFile &file)
  {
    RevCase rev_case;
    const bool is_example = file.get_entries().empty();
    const Range allowed{1., 100.};
    const unsigned int n_stages = ParameterBinder::read_number(file, "Number of stages", allowed, is_example ? 2 : 1);
    rev_case.stages = make_default_stages(n_stages, is_example);
    std::vector<StageText> texts(n_stages);

    ParameterBinder binder;
    binder.bind_fixed("Number of stages", n_stages, allowed, "Of the loading programme. Units: [-].");
    bind_rev_parameters(binder, rev_case.rev);
    binder.bind(
        "REV number", rev_case.rev.model.identity.rev, non_negative,
        "Whose strengths and cracks are drawn: that of a Gauss point, to take its REV through a laboratory test. "
        "Units: [-].");
    bind_boundary(binder, rev_case.rev);
    CreepParameters creep;
    bind_creep_law(binder, rev_case.rev.model.creep, creep);
    bind_laboratory(binder, rev_case);
    bind_breakage(binder, rev_case.breakage);
    for (unsigned int k = 0; k < n_stages; ++k)
      bind_stage(binder, fmt::format("Stage {}", k + 1), rev_case.stages[k], texts[k]);
    binder.read(file);

    complete_rev_parameters(binder, rev_case.rev);
    for (unsigned int k = 0; k < n_stages; ++k)
      for (int m = 0; m < 6; ++m)
        {
          const int i = dem::tangent_index[m][0], j = dem::tangent_index[m][1];
          rev_case.stages[k].strain(i, j) = rev_case.stages[k].strain(j, i) = texts[k].strain[m];
        }
    check_stages(binder, rev_case.stages, rev_case.rev.packing.cell_kind);
    complete_creep_law(binder, creep, rev_case.stages, rev_case.rev.model);
    std::ostringstream text;
    binder.print(text);
    rev_case.parameters = text.str();
    return rev_case;
  }
} // namespace apps
