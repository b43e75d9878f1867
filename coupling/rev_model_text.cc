#include "coupling/rev_model_text.h"

#include <fmt/format.h>

#include <map>
#include <sstream>
#include <stdexcept>

namespace coupling
{
  namespace
  {
    void visit_material(auto &material, auto &visit)
    {
      visit("shear_modulus", material.shear_modulus);
      visit("poisson_ratio", material.poisson_ratio);
      visit("friction", material.friction);
      visit("roughness", material.roughness);
      visit("roughness_rule", material.roughness_rule);
      visit("n1", material.n1);
      visit("n2", material.n2);
    }

    void visit_fracture(auto &fracture, auto &visit)
    {
      visit("is_active", fracture.is_active);
      visit("comminution_diameter", fracture.comminution_diameter);
      visit("batch_limit", fracture.batch_limit);
      visit("batch_share", fracture.batch_share);
      visit("reference_strength", fracture.strength.reference_strength);
      visit("reference_diameter", fracture.strength.reference_diameter);
      visit("size_exponent", fracture.strength.size_exponent);
      visit("variation", fracture.strength.variation);
      visit("truncation", fracture.strength.truncation);
      visit("reference_velocity", fracture.crack.reference_velocity);
      visit("exponent", fracture.crack.exponent);
      visit("smallest_crack_share", fracture.crack.smallest_crack_share);
      visit("largest_crack_share", fracture.crack.largest_crack_share);
    }

    /** Shows every parameter with its name to `visit`: writing and reading cannot differ. */
    void visit_model(auto &model, auto &visit)
    {
      visit_material(model.material, visit);
      visit_fracture(model.fracture, visit);
      visit("is_rotation_free", model.dynamics.motion.is_rotation_free);
      visit("has_true_masses", model.dynamics.motion.has_true_masses);
      visit("density", model.dynamics.motion.density);
      visit("local_damping", model.dynamics.motion.local_damping);
      visit("time_step_share", model.dynamics.motion.time_step_share);
      visit("skin_share", model.dynamics.skin_share);
      visit("precision", model.dynamics.precision);
      visit("unbalanced_ratio", model.equilibrium.unbalanced_ratio);
      visit("stress_tolerance", model.equilibrium.stress_tolerance);
      visit("fixed_cycles", model.equilibrium.fixed_cycles);
      visit("cycle_cap", model.equilibrium.cycle_cap);
      visit("strain_per_cycle", model.equilibrium.strain_per_cycle);
      visit("servo_gain", model.equilibrium.servo_gain);
      visit("seed", model.identity.seed);
      visit("rev", model.identity.rev);
    }
  } // namespace

  std::string write_model_text(const dem::RevModel &model)
  {
    std::string text;
    const auto write = [&](const char *name, const auto &value) {
      if constexpr (std::is_floating_point_v<std::decay_t<decltype(value)>>)
        text += fmt::format("{} = {:.17g}\n", name, value);
      else
        text += fmt::format("{} = {}\n", name, static_cast<std::uint64_t>(value));
    };
    visit_model(model, write);
    return text;
  }

  dem::RevModel read_model_text(const std::string &text)
  {
    std::map<std::string, std::string> values;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);)
      if (const auto middle = line.find(" = "); middle != std::string::npos)
        values[line.substr(0, middle)] = line.substr(middle + 3);
    dem::RevModel model;
    const auto read = [&](const char *name, auto &value) {
      using Value = std::decay_t<decltype(value)>;
      const auto found = values.find(name);
      if (found == values.end())
        throw std::runtime_error(fmt::format("parameters of a REV: '{}' is missing", name));
      try
        {
          if constexpr (std::is_floating_point_v<Value>)
            value = std::stod(found->second);
          else
            value = static_cast<Value>(std::stoull(found->second));
        }
      catch (const std::logic_error &)
        {
          throw std::runtime_error(
              fmt::format("parameters of a REV: '{}' = '{}' is not a number", name, found->second));
        }
    };
    visit_model(model, read);
    return model;
  }
} // namespace coupling
