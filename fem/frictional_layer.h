#pragma once

#include "fem/constitutive_model.h"
#include "fem/kinematics.h"
#include "fem/state_archive.h"

#include <map>

namespace fem
{
  /** Which way the faces of a layer look before it is deformed; of either side, it makes no difference. */
  enum class LayerNormal
  {
    radial, ///< horizontal, away from the z axis; x in two dimensions
    x,
    y,
    z
  };

  struct FrictionalLayerParameters
  {
    double normal_modulus = 1e9; ///< normal stress over logarithmic strain across the layer [Pa], > 0
    double shear_modulus = 4e8;  ///< shear stress over shear strain before it slips [Pa], > 0
    double friction = 0.5;       ///< tangent of the friction angle [-], >= 0
    LayerNormal normal = LayerNormal::radial;
    Kinematics kinematics = Kinematics::finite; ///< the problem's
  };

  /** A point of a layer. */
  struct LayerState
  {
    dealii::Tensor<1, 3> normal;            ///< of the faces, now [-]
    double strain = 0.;                     ///< across the layer, logarithmic, where no stress is 0; positive: open
    dealii::Tensor<1, 3> shear;             ///< stress on the faces, along them [Pa]
    dealii::SymmetricTensor<2, 3> in_plane; ///< stress along the layer, which only turns with it [Pa]
    double slip = 0.;                       ///< shear strain that friction has let go, summed up [-]
  };

  /**
   * A thin layer that slips by Coulomb's law between two bodies (docs/theory.md, Eqs. 10.4 and 10.5): what a penalty
   * does on a contact surface, with stiffness modulus over thickness, as a material of the cells between them.
   *
   * It answers to what its faces do to each other: approach (never tension) and slide, |shear| <= friction times the
   * normal pressure; slip changes no volume. Stretches along the layer it does not resist. Its normal is that of the
   * faces as they are carried along, so that slip may be many times the thickness.
   */
  class FrictionalLayer : public ConstitutiveModel
  {
  public:
    /** Throws std::invalid_argument naming parameter, value and range. */
    FrictionalLayer(const FrictionalLayerParameters &parameters, MPI_Comm communicator);

    void initialise(std::span<const PointSite> sites) override;
    double compute_time_to_next_event(unsigned int) const override { return std::numeric_limits<double>::infinity(); }
    bool can_cut_events(unsigned int) const override { return false; }
    Status begin_step(double) override { return Status::ok; }
    void evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                  bool with_tangent) override;
    Settlement settle(bool accept_excess) override;
    void commit() override;
    void revert() override;
    std::vector<std::string> get_field_names() const override { return {"slip [-]", "mobilised friction [-]"}; }
    std::vector<double> compute_fields(PointId id) const override;
    void save(const std::string &file) const override;
    void load(const std::string &file) override;

    void set_archive_group(const std::string &group) { archive_group_ = group; }

  private:
    struct Point
    {
      LayerState committed, baseline, trial;
    };

    /** What the faces do to each other between baseline and trial. */
    struct Motion
    {
      dealii::Tensor<1, 3> normal; ///< of the faces, now [-]
      double opening;              ///< thickness over that of the baseline [-]
      dealii::Tensor<1, 3> slide;  ///< over the baseline's thickness [-]
      dealii::Tensor<2, 3> turn;   ///< of what lies in the layer [-]
    };

    Motion compute_motion(const LayerState &start, const dealii::Tensor<2, 3> &increment) const;
    double compute_pressure(const LayerState &state) const;
    LayerState respond(const LayerState &start, const Motion &motion) const;
    dealii::SymmetricTensor<4, 3> compute_tangent(const LayerState &start, const Motion &motion,
                                                  const LayerState &now) const;
    StateArchive make_archive() const;

    FrictionalLayerParameters parameters_;
    MPI_Comm communicator_;
    std::map<PointId, Point> points_;
    std::string archive_group_ = "/material/frictional";
  };
} // namespace fem
