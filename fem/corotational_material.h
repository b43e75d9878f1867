#pragma once

#include "fem/constitutive_model.h"
#include "fem/kinematics.h"
#include "fem/state_archive.h"

#include <map>
#include <mpi.h>

namespace fem
{
  /** State of a point in the material's own axes, which the rotation turns into the solver's. */
  struct CorotationalState
  {
    dealii::Tensor<2, 3> rotation = dealii::Tensor<2, 3>(dealii::unit_symmetric_tensor<3>());
    dealii::SymmetricTensor<2, 3> stress;         ///< [Pa], tension-positive
    dealii::SymmetricTensor<2, 3> delayed_strain; ///< of the law, for example its Kelvin strain [-]
  };

  /** Stress and modulus in the material's own axes. */
  struct LocalAnswer
  {
    CorotationalState state;               ///< its rotation is the baseline's
    dealii::SymmetricTensor<4, 3> modulus; ///< d stress / d strain increment [Pa]
  };

  /**
   * A material whose points never rotate in their own axes. With Q0 the baseline's rotation and dF = dR dU:
   * strain increment log(Q0^T dU Q0), Q = dR Q0, stress = Q s Q^T; so evaluate(R dF) = R evaluate(dF) R^T.
   * Small kinematics: strain increment sym(dF) - I and Q = I.
   *
   * A law derives from this and says how a point answers to a strain increment and what time does to it.
   */
  class CorotationalMaterial : public ConstitutiveModel
  {
  public:
    /** @param communicator  that of the problem: its ranks share the points */
    CorotationalMaterial(Kinematics kinematics, MPI_Comm communicator)
        : kinematics_(kinematics), communicator_(communicator)
    {}

    void initialise(std::span<const PointSite> sites) override;
    double compute_time_to_next_event(unsigned int) const override { return std::numeric_limits<double>::infinity(); }
    bool can_cut_events(unsigned int) const override { return false; }
    Status begin_step(double dt) override;
    void evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                  bool with_tangent) override;
    Settlement settle(bool accept_excess) override;
    void commit() override;
    void revert() override;
    void save(const std::string &file) const override;
    void load(const std::string &file) override;
    void restart(std::span<const PointId> ids) override;

    /** Where save() and load() keep the states: "/material" unless several such materials share a file. */
    void set_archive_group(const std::string &group) { archive_group_ = group; }

  protected:
    /** Answer to a strain increment [-] since the baseline, in the material's axes. */
    virtual LocalAnswer respond(const CorotationalState &baseline,
                                const dealii::SymmetricTensor<2, 3> &strain_increment) const = 0;

    /** A step of dt [s] begins: the law may from now on answer for its end. */
    virtual void announce(double /*dt*/) {}

    /** The step's time has been used: the baseline now stands at its end. */
    virtual void end_time() {}

  private:
    struct Point
    {
      CorotationalState committed, baseline, trial;
    };

    StateArchive make_archive() const;

    std::map<PointId, Point> points_;
    Kinematics kinematics_;
    MPI_Comm communicator_;
    std::string archive_group_ = "/material";
  };
} // namespace fem
