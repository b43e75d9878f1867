#pragma once

#include "fem/constitutive_model.h"

#include <map>
#include <memory>
#include <mpi.h>

namespace fem
{
  /**
   * Several materials in one mesh: the cell's material id says which of them answers at its Gauss points.
   *
   * Every part sees the whole contract with its own points alone, and every call reaches every part, whatever points
   * this rank has. Answers are put back in the order of the questions. What a part says of the whole is combined: the
   * worst status, the earliest event, the sum of what broke.
   */
  class CompositeMaterial : public ConstitutiveModel
  {
  public:
    using Region = dealii::types::material_id;

    /** @param communicator  that of the problem: its ranks share the points */
    explicit CompositeMaterial(MPI_Comm communicator) : communicator_(communicator) {}

    /** Adds a material for regions that have none yet. */
    ConstitutiveModel &add(std::unique_ptr<ConstitutiveModel> part, const std::vector<Region> &regions);

    /** Throws std::invalid_argument naming a region that no part was added for. */
    void initialise(std::span<const PointSite> sites) override;

    double compute_time_to_next_event(unsigned int n_cuts) const override;
    bool can_cut_events(unsigned int n_cuts) const override;
    Status begin_step(double dt) override;
    EventCount count_events() const override;
    void evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                  bool with_tangent) override;

    /** All parts settle, also beside one that is excessive: the caller reverts them then. */
    Settlement settle(bool accept_excess) override;
    void commit() override;
    void revert() override;
    void restart(std::span<const PointId> ids) override;

    /** "material [-]", the region's number, then the fields of the parts one after another. */
    std::vector<std::string> get_field_names() const override;

    /** NaN for the fields of other parts. */
    std::vector<double> compute_fields(PointId id) const override;

    void save(const std::string &file) const override;
    void load(const std::string &file) override;

  private:
    struct Home
    {
      std::size_t part;
      Region region;
    };

    std::vector<std::unique_ptr<ConstitutiveModel>> parts_;
    std::map<Region, std::size_t> part_of_region_;
    std::map<PointId, Home> homes_; ///< of all points
    MPI_Comm communicator_;
  };
} // namespace fem
