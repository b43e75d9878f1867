#include "apps/creep_parameters.h"

#include "dem/stage_path.h"

#include <fmt/format.h>

namespace apps
{
  namespace
  {
    void bind_rate_process(ParameterBinder &binder, dem::RateProcessLaw &law)
    {
      binder.enter("Rate process");
      binder.bind("Temperature", law.temperature, positive, "T of the contacts. A choice: a laboratory. Units: [K].");
      binder.bind("Activation energy", law.activation_energy, non_negative,
                  "dF of a bond in v = 2 lambda (kT/h) exp(-dF/RT) sinh(alpha t/N). A choice. Units: [J/mol].");
      binder.bind("Unit displacement", law.unit_displacement, positive,
                  "lambda, from one resting place of a bond to the next. A choice: about the distance of neighbouring oxygens in silica. "
                  "Units: [m].");
      binder.bind("Bonds per force", law.bonds_per_force, positive,
                  "n1, bonds in a contact over its normal force; alpha = lambda/(2 k T n1). A choice. Units: [1/N].");
      binder.leave();
    }

    void bind_elements(ParameterBinder &binder, const std::string &direction, dem::BurgersElements &elements)
    {
      binder.bind(direction + " viscosity", elements.viscosity, positive,
                  "Of the dashpot in series with the contact's spring. A choice. Units: [N s/m].");
      binder.bind(direction + " retarded stiffness", elements.retarded_stiffness, positive,
                  "Of the Kelvin element's spring. A choice. Units: [N/m].");
      binder.bind(direction + " retarded viscosity", elements.retarded_viscosity, positive,
                  "Of the Kelvin element's dashpot. A choice. Units: [N s/m].");
    }
  } // namespace

  void bind_creep_law(ParameterBinder &binder, dem::CreepLaw &law, CreepParameters &parameters)
  {
    using dem::CreepKind;
    binder.enter("Creep law");
    binder.bind_choice<CreepKind>(
        "Kind", law.kind,
        {{"delayed fracture", CreepKind::delayed_fracture},
         {"scaled time", CreepKind::scaled_time},
         {"rate process", CreepKind::rate_process},
         {"burgers", CreepKind::burgers}},
        "delayed fracture: cracks grow, in jumps from batch to batch; scaled time: cracks grow in every cycle of one "
        "long "
        "computation; rate process: contacts slide as bonds break by heat (Kuhn and Mitchell 1993); burgers: contacts "
        "are Burgers bodies (Wang et al. 2014). Units: none.");
    binder.bind(
        "Cracks grow", parameters.cracks_grow,
        "Whether there is delayed fracture beside the creep of contacts; false: grains break by overload alone. "
        "Units: none.");
    binder.bind(
        "Time scale", law.time_scale, positive,
        "Scaled time: time of creep over that of the computation. A choice. Units: [s] a cycle, or [-] with true "
        "masses.");
    binder.bind("Step share", law.step_share, {0., 1., true, false},
                "Rate process, burgers: longest step between equilibria, by the mean change of contact forces at held "
                "grains over the mean normal force. A choice. Units: [-].");
    bind_rate_process(binder, law.rate_process);
    binder.enter("Burgers");
    bind_elements(binder, "Normal", law.burgers.normal);
    bind_elements(binder, "Shear", law.burgers.shear);
    binder.leave();
    binder.leave();
  }

  void complete_creep_law(const ParameterBinder &binder, const CreepParameters &parameters,
                          const std::vector<dem::LaboratoryStage> &stages, dem::RevModel &model)
  {
    if (!parameters.cracks_grow)
      {
        if (!model.creep.has_contact_creep())
          binder.reject("Creep law/Cracks grow", "is false, but Creep law/Kind creeps by the growth of cracks alone; "
                                                 "allowed: rate process, burgers");
        model.fracture.crack.reference_velocity = 0.;
      }
    if (model.creep.kind != dem::CreepKind::scaled_time)
      return;
    if (!model.fracture.is_active)
      binder.reject("Creep law/Kind", "is scaled time, in which cracks grow, but Fracture/Grains break is false");
    for (std::size_t k = 0; k < stages.size(); ++k)
      if (!dem::is_held(stages[k]) && stages[k].duration > 0.)
        binder.reject(fmt::format("Stage {}/Duration", k + 1),
                      "is not allowed: scaled time passes in creep and relaxation; a load takes 0 s");
  }
} // namespace apps
