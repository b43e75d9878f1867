#pragma once

#include "apps/ground_parameters.h"
#include "apps/load_test.h"
#include "apps/pool_parameters.h"
#include "apps/rev_parameters.h"

#include "coupling/rev_material.h"

#include "fem/elastic_material.h"
#include "fem/load_stepping.h"
#include "fem/viscoelastic_material.h"

#include <string>
#include <vector>

namespace apps
{
  enum class MaterialKind
  {
    rev,
    elastic,
    viscoelastic
  };

  /** A place whose stress and strain are written at every step. */
  struct Probe
  {
    std::string name;
    dealii::Point<3> position; ///< initial [m]; the nearest Gauss point answers
  };

  struct BvpOutput
  {
    unsigned int checkpoint_interval = 20; ///< committed steps between checkpoints
    bool writes_fields = true;
    bool writes_snapshots = true;
    bool writes_points = true;
    std::string probes_text; ///< "NAME: x, y, z; ..."; empty: every Gauss point if there are at most 64
    std::vector<Probe> probes;
  };

  /** A boundary-value problem as its parameter file tells it. */
  struct BvpCase
  {
    MaterialKind material = MaterialKind::rev;
    fem::MeshParameters mesh;
    fem::ProblemParameters problem;
    bool is_distributed = false; ///< the mesh is spread over the ranks instead of being on each of them
    dealii::SymmetricTensor<2, 3> initial_stress; ///< [Pa], tension-positive; of ground that is not geostatic
    GroundParameters ground;
    PileParameters pile;
    InterfaceParameters interface;
    LoadTestParameters load_tests;
    std::vector<fem::BoundaryCondition> conditions;
    std::vector<fem::Stage> stages;
    fem::SteppingParameters stepping;
    RevParameters rev;
    coupling::RevMaterialParameters rev_material;
    PoolParameters pool;
    fem::ElasticParameters elastic;
    fem::BurgersParameters burgers;
    BvpOutput output;

    std::string parameters; ///< all of them as used, a file that can be read again
  };

  /**
   * Reads a case. Throws BadInput naming file, line, parameter, value and allowed range.
   *
   * @param binder  knows all parameters afterwards, for check_bvp_case(); it refers to `bvp`
   */
  void read_bvp_case(const ParameterFile &file, ParameterBinder &binder, BvpCase &bvp);

  /** Stress of the untouched ground [Pa], tension-positive. */
  dealii::SymmetricTensor<2, 3> compute_initial_stress(const BvpCase &bvp, const dealii::Point<3> &place);

  /** What only the mesh can tell: that it can be made, and that each condition's boundary is there. Throws BadInput. */
  void check_bvp_case(const ParameterBinder &binder, const BvpCase &bvp);
} // namespace apps
