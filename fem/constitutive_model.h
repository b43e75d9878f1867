#pragma once

#include <deal.II/base/point.h>
#include <deal.II/base/symmetric_tensor.h>
#include <deal.II/base/tensor.h>
#include <deal.II/base/types.h>

#include <cstdint>
#include <limits>
#include <span>
#include <stdexcept>
#include <string>
#include <vector>

namespace fem
{
  /** Number of a Gauss point: number of its cell times points per cell plus the point's index in its cell. The same on
   *  any number of ranks. */
  using PointId = unsigned int;

  /** What an evaluation came to. `step_too_large` and `failed` both make the macro step shorter. */
  enum class Status
  {
    ok,
    step_too_large,
    failed
  };

  /** A Gauss point as the solver introduces it, once, before the first step. */
  struct PointSite
  {
    PointId id;
    dealii::Point<3> position;                    ///< [m]; axisymmetric: (r, z) stored as (x, 0, z)
    dealii::SymmetricTensor<2, 3> initial_stress; ///< [Pa], tension-positive
    dealii::types::material_id region = 0;        ///< what the mesh calls the cell's material
  };

  /** What the solver asks of one point. Always three-dimensional; z is axial, x radial and y hoop in axisymmetry. */
  struct PointRequest
  {
    PointId id;
    dealii::Tensor<2, 3> deformation_increment; ///< dF since the baseline [-]
  };

  /** What the point answers. Values not computed are NaN. */
  struct PointResponse
  {
    Status status = Status::ok;
    dealii::SymmetricTensor<2, 3> stress;  ///< Cauchy [Pa], tension-positive, in the solver's axes
    dealii::SymmetricTensor<4, 3> tangent; ///< d(Cauchy)/d(strain) in the current configuration [Pa]; minor symmetries,
                                           ///< not the major one; filled when asked for
    double unbalanced_ratio = std::numeric_limits<double>::quiet_NaN();
    double cost_s = 0.; ///< wall time [s]; never influences a decision that changes results
  };

  /** What happened when the material was settled at a macro equilibrium. */
  struct Settlement
  {
    unsigned int n_broken = 0; ///< grains split now, over all points; 0: the equilibrium stands
    bool is_excessive = false; ///< some point had more overstressed grains than one batch: halve if possible,
                               ///< otherwise settle again with accept_excess
    Status status = Status::ok;
  };

  /** Events, such as grains that broke, and the points that know of any. */
  struct EventCount
  {
    std::uint64_t n_events = 0;
    std::uint64_t n_points = 0;
  };

  /**
   * What a solver may ask of the material at its Gauss points, for all of them at once.
   *
   * Three states per point: committed (last accepted step), baseline (committed, moved on by ageing and by each
   * equilibrium accepted inside the step) and trial. `evaluate` starts at the baseline with the total increment since
   * it. All calls are collective over the ranks of the material; every rank returns the same status.
   */
  class ConstitutiveModel
  {
  public:
    virtual ~ConstitutiveModel() = default;

    /** Introduces the points of this rank's part of the mesh (all points when the mesh is on every rank). */
    virtual void initialise(std::span<const PointSite> sites) = 0;

    /** Time from now to the next event that a step must not jump over [s]; infinity: none. A step that was cut n times
     *  asks for the event of a batch 2^-n as large. */
    virtual double compute_time_to_next_event(unsigned int n_cuts) const = 0;

    /** True while a cut of level n_cuts still makes the next batch of events smaller. */
    virtual bool can_cut_events(unsigned int n_cuts) const = 0;

    /** Moves the baseline on by dt [s], dt >= 0, at held strain (ageing, viscous flow). `status` other than ok: revert.
     */
    virtual Status begin_step(double dt) = 0;

    /** What happened in the last begin_step(), over all points of all ranks. */
    virtual EventCount count_events() const { return {}; }

    /** Trial answers for the given points; the tangent only if asked for. @pre responses.size() == requests.size() */
    virtual void evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                          bool with_tangent) = 0;

    /** At a macro equilibrium: the last trial states become the baseline, then what is overstressed splits and relaxes
     *  at held strain. The solver's reference configuration moves with the baseline. With n_broken == 0 nothing was
     *  split. When is_excessive and not accept_excess: nothing was split, the caller reverts and cuts the step. */
    virtual Settlement settle(bool accept_excess) = 0;

    /** The baseline becomes history. */
    virtual void commit() = 0;

    /** Baseline and trial are dropped: back to the committed state. */
    virtual void revert() = 0;

    /** Points that enter the problem now: stress-free and unstrained in their present position, in all three states.
     *  Throws std::logic_error for a material that cannot. */
    virtual void restart(std::span<const PointId>) { throw std::logic_error("this material cannot begin anew"); }

    /** Scalar fields of a point for output, names with units such as "void ratio [-]". */
    virtual std::vector<std::string> get_field_names() const { return {}; }

    /** Values of those fields in the committed state, one a name; known on the rank that introduced the point. */
    virtual std::vector<double> compute_fields(PointId) const { return {}; }

    /** Appends the committed state to an existing HDF5 file, under the group "/material". */
    virtual void save(const std::string &file) const = 0;

    /** Reads what save() wrote. Throws std::runtime_error naming file and dataset. */
    virtual void load(const std::string &file) = 0;
  };
} // namespace fem
