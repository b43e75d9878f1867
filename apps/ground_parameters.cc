#include "apps/ground_parameters.h"

#include "apps/name_list.h"

#include <fmt/format.h>

namespace apps
{
  namespace
  {
    using RegionIds = std::map<std::string, dealii::types::material_id>;

    /** The numbers of the names in a parameter, which are taken out of those that are left. */
    RegionMaterials::Regions take_regions(const std::string &path, const std::string &text, RegionIds &left,
                                          const RegionIds &all)
    {
      std::string known;
      for (const auto &[name, id] : all)
        known += (known.empty() ? "" : ", ") + name;
      RegionMaterials::Regions regions;
      for (const std::string &name : split_names(text))
        {
          const auto found = left.find(name);
          if (found == left.end())
            throw BadInput(fmt::format("parameter '{}' = '{}': '{}' {}; regions of the mesh: {}", path, text, name,
                                       all.contains(name) ? "is named twice" : "is no region of the mesh", known));
          regions.push_back(found->second);
          left.erase(found);
        }
      return regions;
    }
  } // namespace

  void bind_ground(ParameterBinder &binder, GroundParameters &ground, PileParameters &pile)
  {
    binder.enter("Ground");
    binder.bind_choice<bool>(
        "Initial state", ground.is_geostatic, {{"uniform", false}, {"geostatic", true}},
        "uniform: Problem/Initial stress everywhere; geostatic: from unit weight, K0 and surcharge. "
        "Units: none.");
    binder.bind("Unit weight", ground.geostatic.unit_weight, non_negative,
                "Of everything that is present, pile included: it weighs what the ground in its place would. "
                "Downwards along z. Units: [N/m^3].");
    binder.bind("K0", ground.geostatic.lateral_ratio, positive,
                "Geostatic: horizontal over vertical stress. Units: [-].");
    binder.bind("Surcharge", ground.geostatic.surcharge, non_negative,
                "Geostatic: pressure on the surface; it takes a condition of that pressure to keep it. Units: [Pa].");
    binder.bind("Surface level", ground.geostatic.surface_level, any_number,
                "Geostatic: z of the ground's surface. Units: [m].");
    binder.bind("Elastic regions", ground.elastic_regions,
                "Names of the mesh, comma-separated, that are Elastic whatever Material says. Units: none.");
    binder.bind("Viscoelastic regions", ground.viscoelastic_regions,
                "Names of the mesh, comma-separated, that are Viscoelastic whatever Material says. Units: none.");
    binder.leave();
    binder.enter("Pile");
    binder.bind("Regions", pile.regions,
                "Names of the mesh, comma-separated, that are pile; empty: none. Units: none.");
    binder.bind("Is absent at first", pile.is_absent,
                "Until a stage places it; its hole must be held by displacement conditions. Units: none.");
    binder.bind("Young's modulus", pile.elastic.youngs_modulus, positive, "Units: [Pa].");
    binder.bind("Poisson's ratio", pile.elastic.poissons_ratio, {-1., 0.5, true, true}, "Units: [-].");
    binder.leave();
  }

  void bind_interface(ParameterBinder &binder, InterfaceParameters &interface)
  {
    binder.enter("Interface");
    binder.bind("Regions", interface.regions,
                "Names of the mesh, comma-separated: thin layers between pile and ground that slip by Coulomb's law; "
                "empty: pile and ground are bonded. Units: none.");
    binder.bind("Friction coefficient", interface.layer.friction, non_negative,
                "Tangent of the friction angle: largest shear stress over normal pressure. Units: [-].");
    binder.bind("Normal modulus", interface.layer.normal_modulus, positive,
                "Normal stress over logarithmic strain across the layer; over its thickness it is the penalty "
                "stiffness. Units: [Pa].");
    binder.bind("Shear modulus", interface.layer.shear_modulus, positive,
                "Shear stress over shear strain before the layer slips. Units: [Pa].");
    binder.bind_choice<fem::LayerNormal>("Normal", interface.layer.normal,
                                         {{"radial", fem::LayerNormal::radial},
                                          {"x", fem::LayerNormal::x},
                                          {"y", fem::LayerNormal::y},
                                          {"z", fem::LayerNormal::z}},
                                         "Of the layer's faces at first; radial: horizontal, away from x = y = 0, "
                                         "which is x in two dimensions. Units: none.");
    binder.leave();
  }

  RegionMaterials assign_regions(const GroundParameters &ground, const PileParameters &pile,
                                 const InterfaceParameters &interface, const RegionIds &region_ids)
  {
    RegionMaterials materials;
    RegionIds left = region_ids;
    materials.pile = take_regions("Pile/Regions", pile.regions, left, region_ids);
    materials.frictional = take_regions("Interface/Regions", interface.regions, left, region_ids);
    materials.elastic = take_regions("Ground/Elastic regions", ground.elastic_regions, left, region_ids);
    materials.viscoelastic = take_regions("Ground/Viscoelastic regions", ground.viscoelastic_regions, left, region_ids);
    for (const auto &[name, id] : left)
      materials.rest.push_back(id);
    return materials;
  }
} // namespace apps
