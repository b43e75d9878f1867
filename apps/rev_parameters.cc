#include "apps/rev_parameters.h"

#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <sstream>

namespace apps
{
  namespace
  {
    void bind_grains(ParameterBinder &binder, RevParameters &parameters)
    {
      dem::GrainMaterial &material = parameters.model.material;
      dem::MotionRule &motion = parameters.model.dynamics.motion;
      binder.enter("Grains");
      binder.bind("Shear modulus", material.shear_modulus, positive, "G of the mineral. Units: [Pa].");
      binder.bind("Poisson ratio", material.poisson_ratio, {0., 0.5}, "nu of the mineral. Units: [-].");
      binder.bind("Friction", material.friction, non_negative, "mu between grains. Units: [-].");
      binder.bind("Roughness", material.roughness, non_negative, "S_q; 0: smooth grains, plain Hertz. Units: [m].");
      binder.bind_choice<dem::RoughnessRule>(
          "Roughness rule", material.roughness_rule,
          {{"combined", dem::RoughnessRule::combined}, {"per grain", dem::RoughnessRule::per_grain}},
          "Whether S_q is the roughness of a pair or of each of its grains, S = sqrt(Sq_a^2 + Sq_b^2). Units: none.");
      binder.bind("Roughness parameter n1", material.n1, non_negative, "First of the three-stage contact. Units: [-].");
      binder.bind("Roughness parameter n2", material.n2, non_negative,
                  "Second of the three-stage contact. Units: [-].");
      binder.bind("Density", motion.density, positive, "Of the mineral. Units: [kg/m3].");
      binder.bind("Rotation is free", motion.is_rotation_free,
                  "Whether grains can turn; blocked rotation stands for the interlock of angular grains. Units: none.");
      binder.leave();
    }

    void bind_laws(ParameterBinder &binder, dem::FractureRule &fracture)
    {
      binder.enter("Strength");
      binder.bind("Reference strength", fracture.strength.reference_strength, positive,
                  "sigma_lim0: contact stress at which a grain of the reference diameter splits. Units: [Pa].");
      binder.bind("Reference diameter", fracture.strength.reference_diameter, positive, "d0. Units: [m].");
      binder.bind("Size exponent", fracture.strength.size_exponent, positive,
                  "m: strength falls as (d/d0)^(-3/m). Units: [-].");
      binder.bind("Variation", fracture.strength.variation, {0., 1., false, true},
                  "var: scatter of strength, f = 1 + var X. Units: [-].");
      binder.bind("Truncation", fracture.strength.truncation, positive,
                  "Largest |X|; variation times truncation stays below 1. Units: [-].");
      binder.leave();
      binder.enter("Crack growth");
      binder.bind("Reference velocity", fracture.crack.reference_velocity, non_negative,
                  "v0 in v = v0 (sigma/sigma_lim)^n. Units: [m/s].");
      binder.bind("Exponent", fracture.crack.exponent, positive, "n of Charles' law. Units: [-].");
      binder.bind("Smallest initial crack", fracture.crack.smallest_crack_share, {0., 0.5},
                  "Half-length over the grain's diameter. Units: [-].");
      binder.bind("Largest initial crack", fracture.crack.largest_crack_share, {0., 0.5},
                  "Half-length over the grain's diameter. Units: [-].");
      binder.leave();
    }

    void bind_fracture(ParameterBinder &binder, dem::FractureRule &fracture)
    {
      binder.enter("Fracture");
      binder.bind("Grains break", fracture.is_active, "Whether grains break at all. Units: none.");
      binder.bind("Comminution limit", fracture.comminution_diameter, non_negative,
                  "d_c: smaller grains never break, and fines lie below it. Units: [m].");
      binder.bind("Batch limit", fracture.batch_limit, non_negative,
                  "N_max: grains that break at once at most; 0: by share. Units: [-].");
      binder.bind("Batch share", fracture.batch_share, {0., 1., true, false},
                  "N_max over the number of grains, at least one grain. Units: [-].");
      binder.leave();
    }

    void bind_motion(ParameterBinder &binder, dem::RevModel &model)
    {
      dem::MotionRule &motion = model.dynamics.motion;
      binder.enter("Motion");
      binder.bind("Masses are true", motion.has_true_masses,
                  "True masses and seconds, or masses scaled by the contact stiffness. Units: none.");
      binder.bind("Local damping", motion.local_damping, {0., 1., false, true},
                  "Share of a force that is taken away where it drives. Units: [-].");
      binder.bind("Time step share", motion.time_step_share, {0., 1., true, false},
                  "Time step over the critical one, with true masses. Units: [-].");
      binder.bind_choice<dem::Precision>(
          "Precision", model.dynamics.precision, {{"double", dem::Precision::full}, {"single", dem::Precision::single}},
          "Of grains and contacts in motion. single: sixteen contacts at a time instead of eight; places are multiples "
          "of 2^-32 of the cell's edges; a periodic boundary and an unbalanced ratio of at least 1e-6 alone. Units: "
          "none.");
      binder.bind("Skin share", model.dynamics.skin_share, {0., 1., true, false},
                  "Skin of the contact network over the mean radius. Units: [-].");
      binder.leave();
      dem::EquilibriumRule &rule = model.equilibrium;
      binder.enter("Equilibrium");
      binder.bind("Unbalanced ratio", rule.unbalanced_ratio, {0., 1., true, false},
                  "Mean resultant on a grain over mean normal contact force, at rest below this. Units: [-].");
      binder.bind("Stress tolerance", rule.stress_tolerance, {0., 1., true, false},
                  "Of the controlled stress, over the largest target. Units: [-].");
      binder.bind("Fixed cycles", rule.fixed_cycles, non_negative,
                  "Run just so many cycles each time (the paper: 150000); 0: by the criterion. Units: [-].");
      binder.bind("Cycle cap", rule.cycle_cap, at_least_one,
                  "A REV that is not at rest by then has failed. Units: [-].");
      binder.bind("Strain per cycle", rule.strain_per_cycle, {0., 0.01, true, false},
                  "Largest strain of the cell in one cycle. Units: [-].");
      binder.bind("Servo gain", rule.servo_gain, {0., 10., true, false},
                  "Share of the stress error that one cycle takes away, of a REV as stiff as its contacts; above 1 it "
                  "may never rest. Units: [-].");
      binder.leave();
    }

    void bind_packing(ParameterBinder &binder, RevParameters &parameters)
    {
      dem::PackingRule &packing = parameters.packing;
      binder.enter("Packing");
      binder.bind(
          "File", parameters.packing_file,
          "Text file '# cell Lx Ly Lz', then 'x y z radius' a line, to start from; empty: generate. Units: [m].");
      binder.bind("Grains", packing.n_grains, {10., 1e7}, "Number of grains of a REV. Units: [-].");
      binder.bind("Grading", parameters.grading,
                  "NE34, or 'diameter:passing, ...' from passing 0 to 1, or a CSV file with the columns "
                  "diameter_m,passing. Units: [m], [-].");
      binder.bind("Void ratio", packing.void_ratio, {0.2, 2.}, "e0 at the pressure below. Units: [-].");
      binder.bind("Void ratio tolerance", packing.tolerance, positive, "Of e0. Units: [-].");
      binder.bind("Pressure", packing.pressure, positive, "Isotropic, compression-positive. Units: [Pa].");
      binder.bind("Friction", packing.friction, {-1., 10.},
                  "During generation; negative: searched for until the void ratio is met. Units: [-].");
      binder.bind("Search cap", packing.search_cap, at_least_one,
                  "Frictions tried for one set of positions. Units: [-].");
      binder.bind("Positions cap", packing.positions_cap, {1., 999.}, "Sets of first positions tried. Units: [-].");
      binder.leave();
    }

    /** What single precision cannot do. */
    void check_precision(const ParameterBinder &binder, const RevParameters &parameters)
    {
      if (parameters.model.dynamics.precision != dem::Precision::single)
        return;
      if (parameters.packing.cell_kind == dem::CellKind::rigid)
        binder.reject("Motion/Precision", "is 'single' where Boundary/Kind is 'walls'; allowed: double");
      if (const double ratio = parameters.model.equilibrium.unbalanced_ratio; ratio < dem::finest_single_ratio)
        binder.reject("Equilibrium/Unbalanced ratio",
                      fmt::format("is {:g} with Motion/Precision 'single', which does not rest as quietly; allowed: >= "
                                  "{:g} and <= 1",
                                  ratio, dem::finest_single_ratio));
    }

    double parse_part(const ParameterBinder &binder, const std::string &text, const std::string &whole)
    {
      std::size_t end = 0;
      double number = 0.;
      try
        {
          number = std::stod(text, &end);
        }
      catch (const std::exception &)
        {
          end = 0;
        }
      if (end == 0 || text.find_first_not_of(" \t\r", end) != std::string::npos)
        binder.reject("Packing/Grading", fmt::format("holds '{}', which is not two numbers; allowed: NE34, "
                                                     "'diameter:passing, ...' or a CSV file",
                                                     whole));
      return number;
    }

    dem::GradingPoint parse_point(const ParameterBinder &binder, const std::string &text, const char separator)
    {
      const auto middle = text.find(separator);
      if (middle == std::string::npos)
        binder.reject("Packing/Grading", fmt::format("holds '{}', which is not two numbers; allowed: NE34, "
                                                     "'diameter:passing, ...' or a CSV file",
                                                     text));
      return {parse_part(binder, text.substr(0, middle), text), parse_part(binder, text.substr(middle + 1), text)};
    }

    dem::Grading parse_grading(const ParameterBinder &binder, const std::string &text)
    {
      if (text == "NE34")
        return dem::make_ne34_grading();
      dem::Grading grading;
      std::string part;
      if (text.find(':') != std::string::npos)
        for (std::istringstream stream(text); std::getline(stream, part, ',');)
          grading.push_back(parse_point(binder, part, ':'));
      else
        {
          std::ifstream stream(text);
          if (!stream || std::filesystem::is_directory(text))
            binder.reject("Packing/Grading",
                          "is neither NE34, nor 'diameter:passing, ...', nor a file that can be read");
          std::getline(stream, part); // the header
          while (std::getline(stream, part))
            if (!part.empty())
              grading.push_back(parse_point(binder, part, ','));
        }
      return grading;
    }
  } // namespace

  void bind_rev_parameters(ParameterBinder &binder, RevParameters &parameters)
  {
    binder.bind("Seed", parameters.seed, non_negative, "Of all random numbers. Units: [-].");
    bind_grains(binder, parameters);
    bind_laws(binder, parameters.model.fracture);
    bind_fracture(binder, parameters.model.fracture);
    bind_motion(binder, parameters.model);
    bind_packing(binder, parameters);
  }

  void bind_breakage(ParameterBinder &binder, dem::BreakageScale &scale)
  {
    binder.enter("Breakage measures");
    binder.bind("Silt diameter", scale.silt_diameter, positive,
                "Hardin: finer mass has no potential to break. Units: [m].");
    binder.bind("Fractal dimension", scale.fractal_dimension, {0., 3., false, true},
                "Einav: alpha of the ultimate grading. Units: [-].");
    binder.bind("Smallest diameter", scale.smallest_diameter, positive,
                "Einav: d_m of the ultimate grading; finer mass counts as d_m. Units: [m].");
    binder.leave();
  }

  void complete_rev_parameters(const ParameterBinder &binder, RevParameters &parameters)
  {
    const dem::FractureRule &fracture = parameters.model.fracture;
    if (!(fracture.strength.variation * fracture.strength.truncation < 1.))
      binder.reject("Strength/Truncation", "times Strength/Variation must stay below 1: strengths must be positive");
    if (fracture.crack.smallest_crack_share > fracture.crack.largest_crack_share)
      binder.reject("Crack growth/Smallest initial crack", "exceeds Crack growth/Largest initial crack");
    check_precision(binder, parameters);
    if (!parameters.packing_file.empty() && !std::filesystem::is_regular_file(parameters.packing_file))
      binder.reject("Packing/File", "is not a file that can be read");
    parameters.packing.grading = parse_grading(binder, parameters.grading);
    try
      {
        dem::check_grading(parameters.packing.grading);
      }
    catch (const std::invalid_argument &error)
      {
        binder.reject("Packing/Grading", fmt::format("is not a grading: {}", std::string(error.what())));
      }
    parameters.packing.seed = parameters.seed;
    parameters.model.identity.seed = parameters.seed;
  }
} // namespace apps
