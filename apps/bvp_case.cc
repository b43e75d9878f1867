#include "apps/bvp_case.h"

#include "apps/command_line.h"
#include "apps/name_list.h"
#include "apps/stage_parameters.h"

#include <fmt/format.h>

#include <sstream>

namespace apps
{
  namespace
  {
    /** Values as they are written in the file, before they become what the rooms understand. */
    struct WrittenValues
    {
      std::vector<double> initial_stress = {100e3, 100e3, 100e3, 0., 0., 0.};
      std::vector<double> size = {1., 1., 1.};
      std::vector<double> n_cells = {1., 1., 1.};
    };

    void bind_problem(ParameterBinder &binder, BvpCase &bvp, WrittenValues &written)
    {
      binder.bind_choice<MaterialKind>("Material", bvp.material,
                                       {{"rev", MaterialKind::rev},
                                        {"elastic", MaterialKind::elastic},
                                        {"viscoelastic", MaterialKind::viscoelastic}},
                                       "What answers at the Gauss points. Units: none.");
      binder.enter("Problem");
      binder.bind_choice<fem::Geometry>("Kind", bvp.problem.geometry,
                                        {{"axisymmetric", fem::Geometry::axisymmetric},
                                         {"plane strain", fem::Geometry::plane_strain},
                                         {"3D", fem::Geometry::three_dimensional}},
                                        "A 2-D mesh lies in x (radial) and z (axial, vertical). Units: none.");
      binder.bind_choice<fem::Kinematics>("Kinematics", bvp.problem.kinematics,
                                          {{"finite", fem::Kinematics::finite}, {"small", fem::Kinematics::small}},
                                          "Updated Lagrangian, or strains and rotations that are small. Units: none.");
      binder.bind("Degree", bvp.problem.degree, {1., 2.}, "Of the elements. Units: [-].");
      binder.bind_choice<fem::ElementKind>(
          "Element", bvp.problem.element,
          {{"lagrange", fem::ElementKind::lagrange}, {"serendipity", fem::ElementKind::serendipity}},
          "lagrange: nodes inside as well, 27 in a hexahedron of degree 2; serendipity: degree 2, nodes at corners and "
          "edges alone, 20 in a hexahedron. Units: none.");
      binder.bind("Gauss points", bvp.problem.n_gauss_points, {0., 3.},
                  "Along each direction of an element; 0: degree + 1. Serendipity elements may have 2. Units: [-].");
      binder.bind_choice<fem::Dilatation>(
          "Dilatation", bvp.problem.dilatation,
          {{"point", fem::Dilatation::point}, {"cell mean", fem::Dilatation::cell_mean}},
          "Change of volume that a Gauss point is given: its own, or its cell's, which keeps elements of degree 1 from "
          "locking "
          "where volume hardly changes. Units: none.");
      binder.bind(
          "Is distributed", bvp.is_distributed,
          "Mesh spread over the ranks with an iterative solver; false: on every rank, with a direct solver, and "
          "results that do not depend on the number of ranks. Units: none.");
      binder.bind_list("Initial stress", written.initial_stress, 6,
                       "xx, yy, zz, xy, yz, xz, compression-positive. Units: [Pa].");
      binder.leave();
    }

    void bind_mesh(ParameterBinder &binder, fem::MeshParameters &mesh, WrittenValues &written)
    {
      binder.enter("Mesh");
      binder.bind_choice<fem::MeshKind>(
          "Kind", mesh.kind,
          {{"box", fem::MeshKind::box}, {"cylinder", fem::MeshKind::cylinder}, {"file", fem::MeshKind::file}},
          "Boundaries of a box: left, right, front, back (3D), bottom, top; of a cylinder: axis or inner, outer, "
          "bottom, "
          "top; of a file: its physical names. Units: none.");
      binder.bind("File", mesh.file, "A gmsh .msh file, version 2.2 or 4.1. Units: [m].");
      binder.bind_list("Size", written.size, 3, "Of a box along x, y, z; 2-D ignores y. Units: [m].");
      binder.bind("Inner radius", mesh.inner_radius, non_negative, "Of a cylinder; 0: solid. Units: [m].");
      binder.bind("Outer radius", mesh.outer_radius, positive, "Of a cylinder. Units: [m].");
      binder.bind("Height", mesh.height, positive, "Of a cylinder. Units: [m].");
      binder.bind_list("Cells", written.n_cells, 3,
                       "Of a box along x, y, z (2-D ignores y); of a cylinder radially, around, axially. Units: [-].");
      binder.bind("Refinements", mesh.n_refinements, {0., 20.}, "Uniform halvings after that. Units: [-].");
      binder.leave();
    }

    void bind_newton(ParameterBinder &binder, fem::NewtonParameters &newton)
    {
      binder.enter("Newton");
      binder.bind("Tolerance", newton.tolerance, {0., 1., true, true},
                  "Norm of the residual over that of reactions and loads. Units: [-].");
      binder.bind("Force floor", newton.force_floor, positive, "Smallest force scale. Units: [N].");
      binder.bind("Most evaluations", newton.max_evaluations, at_least_one,
                  "Of the material in one equilibrium; beyond it the step is cut. Units: [-].");
      binder.bind_choice<fem::RefreshPolicy>(
          "Tangent at", newton.refresh,
          {{"each equilibrium", fem::RefreshPolicy::each_equilibrium}, {"each step", fem::RefreshPolicy::each_step}},
          "When the material's tangent is asked for anew. Units: none.");
      binder.bind_choice<fem::SecantKind>("Secant", newton.secant.kind,
                                          {{"none", fem::SecantKind::none},
                                           {"broyden", fem::SecantKind::broyden},
                                           {"anderson", fem::SecantKind::anderson}},
                                          "How the tangent is corrected by what was seen. Units: none.");
      binder.bind("Secant pairs", newton.secant.max_pairs, at_least_one, "Kept within an equilibrium. Units: [-].");
      binder.bind("Carried pairs", newton.secant.n_carried, non_negative, "Kept between equilibria. Units: [-].");
      binder.leave();
    }

    void bind_step_control(ParameterBinder &binder, fem::StepControl &control)
    {
      binder.enter("Control");
      binder.bind(
          "Is active", control.is_active,
          "Whether scheduled steps of creep are shortened as below; needs REVs/Ageing = schedule. Units: none.");
      binder.bind("Fractures a REV", control.target.fractures, positive,
                  "In a step while REVs age, mean over all of them: shorter steps from there on. Units: [-].");
      binder.bind("Strain", control.target.strain, positive,
                  "Of any Gauss point of the ground in a step: shorter steps from there on. Units: [-].");
      binder.bind("Stress change", control.target.stress_change, positive,
                  "Of any Gauss point of the ground in a step, over its stress or the mean of all, whichever is more: "
                  "shorter steps from there on. Units: [-].");
      binder.bind("Hard limit", control.hard_limit, {1., 1e6, true, false},
                  "Multiple of these beyond which a step is taken back and repeated half as long. Units: [-].");
      binder.bind(
          "Smallest share", control.smallest_share, {0., 1., true, false},
          "Of the way to the next scheduled time: no shorter step is asked for; at least Stepping/Smallest step "
          "share. Units: [-].");
      binder.bind("Largest growth", control.largest_growth, {1., 1000., true, false},
                  "Of that share from one step to the next. Units: [-].");
      binder.leave();
    }

    void complete_step_control(const ParameterBinder &binder, const BvpCase &bvp)
    {
      const fem::StepControl &control = bvp.stepping.control;
      if (!control.is_active)
        return;
      if (bvp.material == MaterialKind::rev && bvp.rev_material.ageing.mode == coupling::AgeingMode::events)
        binder.reject("Stepping/Control/Is active", "is true, but steps end at events of the REVs; allowed: with "
                                                    "REVs/Ageing = schedule");
      if (control.smallest_share < bvp.stepping.smallest_step_share)
        binder.reject("Stepping/Control/Smallest share", "is below Stepping/Smallest step share");
    }

    void bind_solver(ParameterBinder &binder, BvpCase &bvp)
    {
      bind_newton(binder, bvp.problem.newton);
      fem::LinearSolverParameters &linear = bvp.problem.linear_solver;
      binder.enter("Linear solver");
      binder.bind_choice<fem::LinearSolverKind>("Kind", linear.kind,
                                                {{"automatic", fem::LinearSolverKind::automatic},
                                                 {"direct", fem::LinearSolverKind::direct},
                                                 {"cg", fem::LinearSolverKind::cg},
                                                 {"gmres", fem::LinearSolverKind::gmres}},
                                                "automatic: direct on one rank; on several gmres, and direct for a matrix where it fails. Units: none.");
      binder.bind("Tolerance", linear.tolerance, {0., 1., true, true}, "Of the iterative ones. Units: [-].");
      binder.bind("Most iterations", linear.max_iterations, at_least_one, "Of the iterative ones. Units: [-].");
      binder.leave();
      binder.enter("Stepping");
      binder.bind("Smallest step share", bvp.stepping.smallest_step_share, {0., 1., true, false},
                  "Of an increment; below it the run gives up. Units: [-].");
      binder.bind("Most avalanche rounds", bvp.stepping.max_avalanche_rounds, at_least_one,
                  "Equilibria in one step; beyond it: rupture. Units: [-].");
      binder.bind("Most cuts", bvp.stepping.max_cuts, at_least_one, "Within one increment. Units: [-].");
      binder.bind("Most idle steps", bvp.stepping.max_idle_steps, at_least_one,
                  "In a row during which no time passes. Units: [-].");
      bind_step_control(binder, bvp.stepping.control);
      binder.leave();
    }

    void bind_coupling(ParameterBinder &binder, coupling::RevMaterialParameters &material)
    {
      binder.enter("REVs");
      binder.bind("Packings", material.packing.n_packings, {0., 1e6},
                  "Different packings, dealt out to the Gauss points in turn; 0: one a point. Strengths and cracks are "
                  "each point's own in any case. Units: [-].");
      binder.bind(
          "Library levels", material.packing.n_levels, {0., 1000.},
          "Stresses between the least and the largest of the Gauss points that each packing is brought to in "
          "advance, nothing breaking; a point starts from the nearest one. 0: all start from the packing. Needs "
          "Packings > 0. Units: [-].");
      binder.bind("Consolidation tolerance", material.consolidation.stress_tolerance, {0., 0.1},
                  "Of the initial stress, over its largest component; 0: Equilibrium/Stress tolerance. Units: [-].");
      binder.bind_choice<coupling::AgeingMode>(
          "Ageing", material.ageing.mode,
          {{"events", coupling::AgeingMode::events}, {"schedule", coupling::AgeingMode::schedule}},
          "events: a step ends at the earliest batch of fractures of any REV; schedule: steps as the stage says, each "
          "REV "
          "going through its batches at held strain. Units: none.");
      binder.bind("Most rounds", material.ageing.round_cap, at_least_one,
                  "Batches and avalanche rounds of one REV within a step. Units: [-].");
      binder.bind_choice<dem::TangentKind>(
          "Tangent", material.point.tangent,
          {{"condensed", dem::TangentKind::condensed}, {"affine", dem::TangentKind::affine}},
          "Of the contact network, grains at rest again or following the mean strain. Units: none.");
      binder.bind("Largest stretch", material.point.largest_stretch, {0., 1., true, false},
                  "Largest strain of a REV in one question; beyond it the step is cut. Units: [-].");
      binder.bind(
          "Lazy tolerance", material.point.lazy_tolerance, {0., 0.1},
          "A REV answers from its tangent, its grains at rest, while the bound of that answer's error over its stress "
          "is below this; its grains follow at the latest when one of them breaks. Keep it below Newton/Tolerance. 0: "
          "never. Units: [-].");
      binder.bind("Consolidation ratio", material.consolidation.stress_ratio, {1., 100., true, false},
                  "Largest growth of stress in one increment on the way to the initial stress. Units: [-].");
      binder.bind("Failure files", material.n_failure_files, {0., 1e6},
                  "Of one failed REV at most, in failures/ of the run folder. Units: [-].");
      binder.leave();
    }

    void bind_reference_materials(ParameterBinder &binder, BvpCase &bvp)
    {
      binder.enter("Elastic");
      binder.bind("Young's modulus", bvp.elastic.youngs_modulus, positive, "Units: [Pa].");
      binder.bind("Poisson's ratio", bvp.elastic.poissons_ratio, {-1., 0.5, true, true}, "Units: [-].");
      binder.leave();
      binder.enter("Viscoelastic");
      binder.bind("Bulk modulus", bvp.burgers.bulk_modulus, positive, "Units: [Pa].");
      binder.bind("Maxwell modulus", bvp.burgers.maxwell_modulus, positive, "Shear. Units: [Pa].");
      binder.bind("Maxwell viscosity", bvp.burgers.maxwell_viscosity, positive, "Shear. Units: [Pa s].");
      binder.bind("Kelvin modulus", bvp.burgers.kelvin_modulus, positive, "Shear. Units: [Pa].");
      binder.bind("Kelvin viscosity", bvp.burgers.kelvin_viscosity, positive, "Shear. Units: [Pa s].");
      binder.leave();
    }

    void bind_output(ParameterBinder &binder, BvpOutput &output)
    {
      binder.enter("Output");
      binder.bind("Checkpoint interval", output.checkpoint_interval, at_least_one,
                  "Committed steps between checkpoints; one more at each stage's end. Units: [-].");
      binder.bind("Fields", output.writes_fields, "Whether to write fields/ for Paraview. Units: none.");
      binder.bind("Snapshots", output.writes_snapshots,
                  "Whether to write each REV at the beginning of creep and at the end. Units: none.");
      binder.bind("Points", output.writes_points,
                  "Whether to write points.csv and shaft.csv, all Gauss points and those beside Load tests/Shaft, at "
                  "each output. Units: none.");
      binder.bind("Probes", output.probes_text,
                  "'NAME: x, y, z; ...': places whose nearest Gauss point is written at every step; empty: every Gauss "
                  "point if there are at most 64. Units: [m].");
      binder.leave();
    }

    std::vector<Probe> parse_probes(const ParameterBinder &binder, const std::string &text)
    {
      std::vector<Probe> probes;
      std::string part;
      for (std::istringstream stream(text); std::getline(stream, part, ';');)
        {
          std::replace(part.begin(), part.end(), ',', ' ');
          const auto colon = part.find(':');
          std::istringstream name(part.substr(0, colon));
          std::istringstream numbers(colon == std::string::npos ? "" : part.substr(colon + 1));
          Probe probe;
          name >> probe.name;
          numbers >> probe.position[0] >> probe.position[1] >> probe.position[2];
          if (!numbers || probe.name.empty() || !(numbers >> std::ws).eof())
            binder.reject("Output/Probes", "is not allowed; allowed: 'NAME: x, y, z; ...'");
          probes.push_back(probe);
        }
      return probes;
    }

    void complete_mesh(const ParameterBinder &binder, const WrittenValues &written, BvpCase &bvp)
    {
      for (int axis = 0; axis < 3; ++axis)
        {
          if (!(written.size[axis] > 0.))
            binder.reject("Mesh/Size", "is not allowed; allowed: three numbers > 0");
          const double n = written.n_cells[axis];
          if (!(n >= 1. && n <= 1e6 && n == std::floor(n)))
            binder.reject("Mesh/Cells", "is not allowed; allowed: three integers >= 1");
          bvp.mesh.size[axis] = written.size[axis];
          bvp.mesh.n_cells[axis] = static_cast<unsigned int>(n);
        }
      if (bvp.mesh.kind == fem::MeshKind::cylinder && bvp.mesh.inner_radius >= bvp.mesh.outer_radius)
        binder.reject("Mesh/Inner radius", "must be smaller than Mesh/Outer radius");
    }

    // What people write is compression-positive; from here on it is tension-positive.
    void complete_initial_stress(const ParameterBinder &binder, const WrittenValues &written, BvpCase &bvp)
    {
      for (int m = 0; m < 6; ++m)
        bvp.initial_stress[dem::tangent_index[m][0]][dem::tangent_index[m][1]] = -written.initial_stress[m];
      if (bvp.material == MaterialKind::rev && !bvp.ground.is_geostatic &&
          !(dealii::eigenvalues(bvp.initial_stress)[0] < 0.))
        binder.reject("Problem/Initial stress", "holds a tension, which grains cannot bear; allowed: all principal "
                                                "stresses > 0 (compression)");
    }
    // A name that is written twice, or phases that contradict one another, are found before any mesh is made.
    void complete_pile(const ParameterBinder &binder, BvpCase &bvp)
    {
      for (fem::BoundaryCondition &condition : bvp.conditions)
        condition.is_held |= condition.kind != fem::ConditionKind::displacement;
      if (bvp.pile.is_absent && bvp.pile.regions.find_first_not_of(" ,") == std::string::npos)
        binder.reject("Pile/Is absent at first", "needs a pile: Pile/Regions is empty");
      complete_load_tests(binder, bvp.load_tests, bvp.conditions, bvp.stages);
      fem::Phase first;
      first.is_pile_absent = bvp.pile.is_absent;
      for (const fem::BoundaryCondition &condition : bvp.conditions)
        first.is_held.push_back(condition.is_held);
      for (std::size_t n = 1; n <= bvp.stages.size(); ++n)
        try
          {
            fem::resolve_phases(bvp.conditions, {bvp.stages.begin(), bvp.stages.begin() + static_cast<long>(n)}, first);
          }
        catch (const std::invalid_argument &error)
          {
            binder.reject(fmt::format("Loading/Stage {}/Name", n),
                          fmt::format("stands for a contradiction: {}", std::string(error.what())));
          }
      bvp.pile.elastic.kinematics = bvp.interface.layer.kinematics = bvp.problem.kinematics;
      bvp.problem.unit_weight = bvp.ground.geostatic.unit_weight;
      bvp.problem.is_pile_absent = bvp.pile.is_absent;
    }
  } // namespace

  dealii::SymmetricTensor<2, 3> compute_initial_stress(const BvpCase &bvp, const dealii::Point<3> &place)
  {
    return bvp.ground.is_geostatic ? fem::compute_geostatic_stress(bvp.ground.geostatic, place) : bvp.initial_stress;
  }

  void read_bvp_case(const ParameterFile &file, ParameterBinder &binder, BvpCase &bvp)
  {
    WrittenValues written;
    StageTexts stages;
    bvp.mesh.size = {1., 1., 1.};
    // A carried Broyden pair can mislead after a fracture; finding out costs evaluations (seen at 21.7 MPa).
    bvp.problem.newton.secant.kind = fem::SecantKind::anderson;
    bind_problem(binder, bvp, written);
    bind_mesh(binder, bvp.mesh, written);
    std::vector<std::string> profiles;
    bind_conditions(file, binder, bvp.conditions, profiles);
    bind_stages(file, binder, bvp.stages, stages);
    bind_ground(binder, bvp.ground, bvp.pile);
    bind_interface(binder, bvp.interface);
    bind_load_tests(binder, bvp.load_tests);
    bind_output(binder, bvp.output);
    bind_coupling(binder, bvp.rev_material);
    bind_pool(binder, bvp.pool);
    bind_rev_parameters(binder, bvp.rev);
    bind_breakage(binder, bvp.rev_material.breakage);
    bind_reference_materials(binder, bvp);
    bind_solver(binder, bvp);
    binder.read(file);

    complete_mesh(binder, written, bvp);
    complete_initial_stress(binder, written, bvp);
    complete_rev_parameters(binder, bvp.rev);
    complete_conditions(binder, profiles, bvp.conditions);
    complete_stages(binder, stages, bvp.conditions, bvp.stages);
    complete_pile(binder, bvp);
    bvp.output.probes = parse_probes(binder, bvp.output.probes_text);
    if (bvp.rev_material.point.is_lazy() && bvp.rev.model.dynamics.motion.has_true_masses)
      binder.reject("REVs/Lazy tolerance", "needs grains at rest between questions, but Motion/Masses are true is "
                                           "true; allowed: 0");
    bvp.rev_material.model = bvp.rev.model;
    bvp.rev_material.packing.rule = bvp.rev.packing;
    bvp.rev_material.packing.file = bvp.rev.packing_file;
    bvp.rev_material.point.kinematics = bvp.elastic.kinematics = bvp.burgers.kinematics = bvp.problem.kinematics;
    complete_step_control(binder, bvp);
    std::ostringstream text;
    binder.print(text);
    bvp.parameters = text.str();
  }

  void check_bvp_case(const ParameterBinder &binder, const BvpCase &bvp)
  {
    std::map<std::string, dealii::types::material_id> regions;
    const auto get_names = [&]() {
      std::vector<std::string> names;
      const auto collect = [&](const auto &mesh) {
        for (const auto &[name, id] : mesh.boundary_ids)
          names.push_back(name);
        for (const auto &[name, id] : mesh.interface_ids)
          names.push_back(name);
        regions = mesh.region_ids;
      };
      if (bvp.problem.geometry == fem::Geometry::three_dimensional)
        collect(fem::create_mesh<3>(bvp.mesh, bvp.problem.geometry, MPI_COMM_SELF));
      else
        collect(fem::create_mesh<2>(bvp.mesh, bvp.problem.geometry, MPI_COMM_SELF));
      return names;
    };
    const auto names = as_bad_input(get_names);
    assign_regions(bvp.ground, bvp.pile, bvp.interface, regions);
    std::string known;
    for (const std::string &name : names)
      known += (known.empty() ? "" : ", ") + name;
    for (std::size_t i = 0; i < bvp.conditions.size(); ++i)
      if (std::find(names.begin(), names.end(), bvp.conditions[i].boundary) == names.end())
        binder.reject(i < bvp.load_tests.condition ? fmt::format("Boundary conditions/Condition {}/Boundary", i + 1)
                                                   : "Load tests/Head",
                      fmt::format("is no boundary of the mesh; allowed: {}", known));
    if (!bvp.load_tests.ages.empty())
      for (const auto &[path, name] :
           {std::pair("Load tests/Shaft", bvp.load_tests.shaft), std::pair("Load tests/Base", bvp.load_tests.base)})
        for (const std::string &one : split_names(name))
          if (std::find(names.begin(), names.end(), one) == names.end())
            binder.reject(path, fmt::format("names '{}', which is no boundary of the mesh; allowed: {}", one, known));
  }
} // namespace apps
