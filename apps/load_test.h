#pragma once

#include "apps/history_file.h"
#include "apps/parameter_binder.h"

#include "fem/load_stepping.h"

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace apps
{
  /** Load tests on a pile at chosen ages: its head is pushed down, and the run goes on as if it had not been. */
  struct LoadTestParameters
  {
    std::vector<double> ages;                                  ///< times of the run [s], ascending; empty: no test
    std::string head = "head", shaft = "shaft", base = "base"; ///< shaft, base: comma-separated names
    double displacement = 0.04;                                ///< of the head, downwards [m], > 0
    double rate = 0.;                                          ///< of the head [m/s]; 0: time stands still
    unsigned int n_increments = 20;
    double tolerance = 0.;            ///< of equilibrium, over reactions and loads [-]; 0: that of the run
    unsigned int max_evaluations = 0; ///< in one equilibrium; 0: that of the run
    std::size_t condition = -1ul;     ///< place of the head's condition among those of the problem
  };

  /** A point of a load test's curve. */
  struct LoadTestPoint
  {
    double head_displacement = 0.;            ///< downwards since the test began [m]
    double head_force = 0.;                   ///< that pushes the head down [N]
    double shaft_force = 0., base_force = 0.; ///< that the pile passes on there, downwards [N]
  };

  /** What a pile bears. */
  struct Capacity
  {
    double shaft = 0., base = 0.;  ///< largest forces of the test [N]
    double head_displacement = 0.; ///< at the largest shaft force [m]
    bool is_peak = false;  ///< the shaft's force fell again before the test ended, by a twentieth if that was early
    bool is_whole = false; ///< the head has gone all of its way
  };

  /** A shaft's capacity at its age. */
  struct AgedCapacity
  {
    double age;   ///< [s]
    double shaft; ///< [N]; NaN: the test ended early, its force still rising
  };

  /** The peaks of a curve. NaN without points. @param way  that the head is to go [m] */
  Capacity compute_capacity(const std::vector<LoadTestPoint> &curve, double way);

  /** Growth of a capacity per tenfold age, as a share of the earlier one: (late/early - 1) / log10(late age/early age)
   *  [-]. NaN where the earlier age is not positive, since no logarithm counts from there, or a capacity is not known.
   */
  double compute_growth_per_decade(const AgedCapacity &early, const AgedCapacity &late);

  /** Binds "Load tests". */
  void bind_load_tests(ParameterBinder &binder, LoadTestParameters &tests);

  /** Adds the head's condition, which no stage of the programme holds, and the ages to the outputs of the creep stages.
   *  Throws BadInput for ages that are no times of a creep. */
  void complete_load_tests(const ParameterBinder &binder, LoadTestParameters &tests,
                           std::vector<fem::BoundaryCondition> &conditions, std::vector<fem::Stage> &stages);

  /**
   * The load tests of a run. A test branches off a checkpoint: problem and material are written to a file, go through
   * the test, and are read back, bit by bit.
   *
   * Writes capacity.csv, one row a test, load_tests/AGE_s.csv, its curve, and load_tests/AGE_s_shaft.csv, the Gauss
   * points beside the shaft along it. Collective.
   */
  template <int dim>
  class LoadTests
  {
  public:
    /** What a test needs of the run that it belongs to. */
    struct Run
    {
      std::string folder;
      std::uint64_t seed = 1;
      bool is_first_rank = true;
      bool is_resumed = false;
      double time = 0.;          ///< of the checkpoint that a resumed run goes on from [s]
      double surface_level = 0.; ///< of the ground [m]
    };

    LoadTests(const LoadTestParameters &parameters, const Run &run, const fem::SteppingParameters &stepping);

    /** Runs the tests whose age has come: nothing happens where the programme is not in, or just before, a creep. */
    void run_due(fem::QuasiStaticProblem<dim> &problem, const std::vector<fem::Stage> &stages,
                 const fem::Progress &progress);

    /** Of the tests so far, by age; on the first rank. */
    const std::vector<AgedCapacity> &get_capacities() const { return capacities_; }

  private:
    std::vector<LoadTestPoint> push(fem::QuasiStaticProblem<dim> &problem, double age, double time,
                                    std::string &outcome) const;
    void write(double age, const std::vector<LoadTestPoint> &curve, const std::string &outcome);
    std::unique_ptr<HistoryFile> open_shaft_table(const fem::QuasiStaticProblem<dim> &problem, double age) const;

    LoadTestParameters parameters_;
    Run run_;
    fem::SteppingParameters stepping_;
    std::set<double> done_;                ///< ages
    std::vector<AgedCapacity> capacities_; ///< of the tests so far
    std::unique_ptr<HistoryFile> file_;    ///< on the first rank
  };
} // namespace apps
