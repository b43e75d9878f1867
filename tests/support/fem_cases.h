#pragma once

#include "fem/elastic_material.h"
#include "fem/load_stepping.h"

#include <exception>
#include <functional>
#include <string>

/** Small boundary value problems and materials with known answers, shared by the tests of the macro scale. */
namespace fem::cases
{
  /** What a piece of work throws says; empty if it throws nothing. */
  inline std::string get_error(const std::function<void()> &work)
  {
    try
      {
        work();
      }
    catch (const std::exception &error)
      {
        return error.what();
      }
    return "";
  }

  constexpr double youngs_modulus = 1e9;
  constexpr double poissons_ratio = 0.25;

  /** E (1 - nu) / ((1 + nu)(1 - 2 nu)): the stiffness of an oedometer [Pa]. */
  constexpr double oedometer_modulus =
      youngs_modulus * (1. - poissons_ratio) / ((1. + poissons_ratio) * (1. - 2. * poissons_ratio));

  inline ElasticParameters get_elastic_parameters(Kinematics kinematics)
  {
    return {youngs_modulus, poissons_ratio, kinematics};
  }

  /** Parameters for materials that answer exactly: equilibrium to rounding. */
  inline ProblemParameters get_exact_parameters(Geometry geometry, Kinematics kinematics, unsigned int degree = 1)
  {
    ProblemParameters parameters;
    parameters.geometry = geometry;
    parameters.kinematics = kinematics;
    parameters.degree = degree;
    parameters.newton.tolerance = 1e-10;
    parameters.newton.force_floor = 1e-3; // loads are of the order of meganewtons
    return parameters;
  }

  /** Cylinder of radius 1 m and height 2 m in a smooth rigid ring; the last condition presses on its top. */
  inline std::vector<BoundaryCondition> get_oedometer_conditions(AreaMeasure area = AreaMeasure::current)
  {
    return {{"axis", ConditionKind::displacement, "x"},
            {"outer", ConditionKind::displacement, "x"},
            {"bottom", ConditionKind::displacement, "z"},
            {"top", ConditionKind::pressure, "", 0., area}};
  }

  inline Mesh<2> create_oedometer_mesh(unsigned int n_radial, unsigned int n_axial, MPI_Comm communicator)
  {
    MeshParameters mesh;
    mesh.kind = MeshKind::cylinder;
    mesh.height = 2.;
    mesh.n_cells = {{n_radial, 1, n_axial}};
    return create_mesh<2>(mesh, Geometry::axisymmetric, communicator);
  }

  inline Stage get_load_stage(double pressure, unsigned int n_increments = 1)
  {
    Stage stage;
    stage.name = "load";
    stage.n_increments = n_increments;
    stage.targets = {{"top", ConditionKind::pressure, "", pressure}};
    return stage;
  }

  inline Stage get_creep_stage(double duration, double outputs_per_decade)
  {
    Stage stage;
    stage.name = "creep";
    stage.kind = StageKind::creep;
    stage.duration = duration;
    stage.outputs_per_decade = outputs_per_decade;
    return stage;
  }

  /** Elastic material with its answers taken by share of the stiffness that its tangent claims, and with events, damage
   *  and refusals as a test writes them. */
  class ScriptedMaterial : public ElasticMaterial
  {
  public:
    explicit ScriptedMaterial(Kinematics kinematics = Kinematics::small, MPI_Comm communicator = MPI_COMM_SELF)
        : ElasticMaterial(get_elastic_parameters(kinematics), communicator)
    {}

    double true_share = 1.;         ///< true stiffness over that of the tangent
    unsigned int n_evaluations = 0; ///< calls without tangent
    unsigned int n_commits = 0, n_reverts = 0;
    double time_to_event = std::numeric_limits<double>::infinity();
    unsigned int max_event_cuts = 0;
    std::vector<double> steps; ///< every dt that began
    std::function<Settlement(bool accept_excess)> on_settle;
    std::function<Status(unsigned int n_evaluations)> on_evaluate;

    double compute_time_to_next_event(unsigned int n_cuts) const override { return time_to_event / (1u << n_cuts); }
    bool can_cut_events(unsigned int n_cuts) const override { return n_cuts < max_event_cuts; }

    Status begin_step(double dt) override
    {
      steps.push_back(dt);
      return ElasticMaterial::begin_step(dt);
    }

    void evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                  bool with_tangent) override
    {
      ElasticMaterial::evaluate(requests, responses, with_tangent);
      const bool is_zero =
          requests.front().deformation_increment == dealii::Tensor<2, 3>(dealii::unit_symmetric_tensor<3>());
      if (with_tangent || is_zero)
        return;
      ++n_evaluations;
      if (on_evaluate)
        responses.front().status = on_evaluate(n_evaluations);
    }

    Settlement settle(bool accept_excess) override
    {
      const Settlement settlement = on_settle ? on_settle(accept_excess) : Settlement();
      if (!settlement.is_excessive || accept_excess)
        ElasticMaterial::settle(accept_excess);
      return settlement;
    }

    void commit() override
    {
      ++n_commits;
      ElasticMaterial::commit();
    }

    void revert() override
    {
      ++n_reverts;
      ElasticMaterial::revert();
    }

  protected:
    LocalAnswer respond(const CorotationalState &baseline,
                        const dealii::SymmetricTensor<2, 3> &strain_increment) const override
    {
      return {ElasticMaterial::respond(baseline, true_share * strain_increment).state,
              ElasticMaterial::respond(baseline, strain_increment).modulus};
    }
  };

  /** The oedometer on one cell or more, with a scripted material. */
  struct Oedometer
  {
    explicit Oedometer(ProblemParameters parameters = get_exact_parameters(Geometry::axisymmetric, Kinematics::small),
                       unsigned int n_cells = 1, MPI_Comm communicator = MPI_COMM_SELF)
        : material(parameters.kinematics, communicator), problem(create_oedometer_mesh(n_cells, n_cells, communicator),
                                                                 get_oedometer_conditions(), parameters, material)
    {}

    /** Downward displacement of the top over the height [-]. */
    double compute_strain() const { return -find_boundary("top").displacement[2] / 2.; }

    BoundaryResponse find_boundary(const std::string &name) const
    {
      for (const BoundaryResponse &response : problem.compute_boundary_responses())
        if (response.name == name)
          return response;
      throw std::logic_error(name);
    }

    ScriptedMaterial material;
    QuasiStaticProblem<2> problem;
  };
} // namespace fem::cases
