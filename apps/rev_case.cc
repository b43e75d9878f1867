#include "apps/rev_case.h"

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

    void bind_stage(ParameterBinder &binder, const std::string &section, dem::LaboratoryStage &stage, StageText &text)
    {
      using dem::HeldStress;
      using dem::StageKind;
      binder.enter(section);
      binder.bind("Name", stage.name, "What the progress and the messages call it. Units: none.");
      binder.bind_choice<StageKind>("Kind", stage.kind,
                                    {{"isotropic", StageKind::isotropic},
                                     {"oedometric", StageKind::oedometric},
                                     {"triaxial", StageKind::triaxial},
                                     {"creep", StageKind::creep},
                                     {"relaxation", StageKind::relaxation},
                                     {"strain path", StageKind::strain_path}},
                                    "isotropic: three equal stresses; oedometric: axial stress, no lateral strain; "
                                    "triaxial: axial strain, lateral stresses held; creep: stresses held; relaxation: "
                                    "strain held; strain path: six strains. Units: none.");
      binder.bind("Stress", stage.stress, any_number,
                  "Pressure (isotropic) or axial stress (oedometric) at the end, compression-positive. Units: [Pa].");
      binder.bind("Axial strain", stage.axial_strain, {-1., 1.},
                  "Triaxial: at the end, logarithmic since stage 1, compression-positive. Units: [-].");
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

    void bind_laboratory(ParameterBinder &binder, RevCase &rev_case)
    {
      binder.enter("Laboratory");
      binder.bind("Smallest share", rev_case.laboratory.smallest_share, {0., 1., true, false},
                  "Of an increment: below it the increment is not halved again. Units: [-].");
      binder.bind("Round cap", rev_case.laboratory.round_cap, {1., 1e6},
                  "Equilibria of one avalanche of fractures, beyond which it is a rupture. Units: [-].");
      binder.bind("Checkpoint interval", rev_case.checkpoint_interval, non_negative,
                  "Wall time between checkpoints; the results do not depend on it. Units: [s].");
      binder.leave();
    }

    /** Which of the REV's stages contradicts itself, as a mistake in the file. */
    void check_stages(const ParameterBinder &binder, const std::vector<dem::LaboratoryStage> &stages)
    {
      try
        {
          dem::check_programme(stages);
        }
      catch (const std::invalid_argument &error)
        {
          binder.reject("Number of stages",
                        fmt::format("describes an impossible programme: {}", std::string(error.what())));
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
    bind_laboratory(binder, rev_case);
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
    check_stages(binder, rev_case.stages);
    std::ostringstream text;
    binder.print(text);
    rev_case.parameters = text.str();
    return rev_case;
  }
} // namespace apps
