#pragma once

#include "apps/parameter_binder.h"

#include "fem/elastic_material.h"
#include "fem/frictional_layer.h"
#include "fem/geostatic_stress.h"

#include <map>
#include <string>
#include <vector>

namespace apps
{
  /** What the ground is like before anything is done to it, and which regions of the mesh are of another material. */
  struct GroundParameters
  {
    bool is_geostatic = false; ///< else the initial stress is one tensor everywhere
    fem::GeostaticParameters geostatic;
    std::string elastic_regions, viscoelastic_regions; ///< names of the mesh, comma-separated
  };

  /** An elastic body in the ground. */
  struct PileParameters
  {
    std::string regions;    ///< names of the mesh, comma-separated; empty: no pile
    bool is_absent = false; ///< before a stage places it
    fem::ElasticParameters elastic = {30e9, 0.2};
  };

  /** Layers that slip between pile and ground. */
  struct InterfaceParameters
  {
    std::string regions; ///< names of the mesh, comma-separated; empty: pile and ground are bonded
    fem::FrictionalLayerParameters layer;
  };

  /** The mesh's numbers of the regions that each material answers for. */
  struct RegionMaterials
  {
    using Regions = std::vector<dealii::types::material_id>;

    Regions pile, frictional, elastic, viscoelastic;
    Regions rest; ///< of the case's material

    bool has_several() const
    {
      return !(pile.empty() && frictional.empty() && elastic.empty() && viscoelastic.empty());
    }
  };

  /** Binds "Ground" and "Pile". */
  void bind_ground(ParameterBinder &binder, GroundParameters &ground, PileParameters &pile);

  /** Binds "Interface". */
  void bind_interface(ParameterBinder &binder, InterfaceParameters &interface);

  /** Deals out a mesh's regions. Throws BadInput naming the parameter, and the regions there are, for a name that the
   * mesh does not have or that is written twice. */
  RegionMaterials assign_regions(const GroundParameters &ground, const PileParameters &pile,
                                 const InterfaceParameters &interface,
                                 const std::map<std::string, dealii::types::material_id> &region_ids);
} // namespace apps
