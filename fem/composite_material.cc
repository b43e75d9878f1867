#include "fem/composite_material.h"

#include <deal.II/base/mpi.h>

#include <fmt/format.h>

#include <algorithm>

namespace fem
{
  ConstitutiveModel &CompositeMaterial::add(std::unique_ptr<ConstitutiveModel> part, const std::vector<Region> &regions)
  {
    for (const Region region : regions)
      part_of_region_.try_emplace(region, parts_.size());
    parts_.push_back(std::move(part));
    return *parts_.back();
  }

  void CompositeMaterial::initialise(std::span<const PointSite> sites)
  {
    std::vector<std::vector<PointSite>> sites_of_part(parts_.size());
    std::map<PointId, Region> regions_here;
    for (const PointSite &site : sites)
      {
        const auto found = part_of_region_.find(site.region);
        if (found == part_of_region_.end())
          throw std::invalid_argument(fmt::format("region {} of the mesh: no material was named for it", site.region));
        regions_here[site.id] = site.region;
        sites_of_part[found->second].push_back(site);
      }
    homes_.clear();
    for (const auto &regions : dealii::Utilities::MPI::all_gather(communicator_, regions_here))
      for (const auto &[id, region] : regions)
        homes_[id] = {part_of_region_.at(region), region};
    for (std::size_t p = 0; p < parts_.size(); ++p)
      parts_[p]->initialise(sites_of_part[p]);
  }

  double CompositeMaterial::compute_time_to_next_event(unsigned int n_cuts) const
  {
    double earliest = std::numeric_limits<double>::infinity();
    for (const auto &part : parts_)
      earliest = std::min(earliest, part->compute_time_to_next_event(n_cuts));
    return earliest;
  }

  bool CompositeMaterial::can_cut_events(unsigned int n_cuts) const
  {
    bool can_cut = false;
    for (const auto &part : parts_)
      can_cut |= part->can_cut_events(n_cuts); // collective: every part is asked
    return can_cut;
  }

  Status CompositeMaterial::begin_step(double dt)
  {
    Status worst = Status::ok;
    for (const auto &part : parts_)
      worst = std::max(worst, part->begin_step(dt));
    return worst;
  }

  EventCount CompositeMaterial::count_events() const
  {
    EventCount all;
    for (const auto &part : parts_)
      {
        const EventCount count = part->count_events();
        all.n_events += count.n_events;
        all.n_points += count.n_points;
      }
    return all;
  }

  void CompositeMaterial::evaluate(std::span<const PointRequest> requests, std::span<PointResponse> responses,
                                   bool with_tangent)
  {
    std::vector<std::vector<PointRequest>> requests_of_part(parts_.size());
    std::vector<std::vector<std::size_t>> places(parts_.size());
    for (std::size_t i = 0; i < requests.size(); ++i)
      {
        const std::size_t part = homes_.at(requests[i].id).part;
        requests_of_part[part].push_back(requests[i]);
        places[part].push_back(i);
      }
    for (std::size_t p = 0; p < parts_.size(); ++p)
      {
        std::vector<PointResponse> answers(places[p].size());
        parts_[p]->evaluate(requests_of_part[p], answers, with_tangent);
        for (std::size_t i = 0; i < answers.size(); ++i)
          responses[places[p][i]] = answers[i];
      }
  }

  Settlement CompositeMaterial::settle(bool accept_excess)
  {
    Settlement all;
    for (const auto &part : parts_)
      {
        const Settlement settlement = part->settle(accept_excess);
        all.n_broken += settlement.n_broken;
        all.is_excessive |= settlement.is_excessive;
        all.status = std::max(all.status, settlement.status);
      }
    return all;
  }

  void CompositeMaterial::commit()
  {
    for (const auto &part : parts_)
      part->commit();
  }

  void CompositeMaterial::revert()
  {
    for (const auto &part : parts_)
      part->revert();
  }

  void CompositeMaterial::restart(std::span<const PointId> ids)
  {
    std::vector<std::vector<PointId>> ids_of_part(parts_.size());
    for (const PointId id : ids)
      ids_of_part[homes_.at(id).part].push_back(id);
    for (std::size_t p = 0; p < parts_.size(); ++p)
      if (!ids_of_part[p].empty())
        parts_[p]->restart(ids_of_part[p]);
  }

  std::vector<std::string> CompositeMaterial::get_field_names() const
  {
    std::vector<std::string> names = {"material [-]"};
    for (const auto &part : parts_)
      {
        const auto own = part->get_field_names();
        names.insert(names.end(), own.begin(), own.end());
      }
    return names;
  }

  std::vector<double> CompositeMaterial::compute_fields(PointId id) const
  {
    const Home home = homes_.at(id);
    std::vector<double> fields = {double(home.region)};
    for (std::size_t p = 0; p < parts_.size(); ++p)
      {
        const std::vector<double> own = p == home.part ? parts_[p]->compute_fields(id)
                                                       : std::vector<double>(parts_[p]->get_field_names().size(),
                                                                             std::numeric_limits<double>::quiet_NaN());
        fields.insert(fields.end(), own.begin(), own.end());
      }
    return fields;
  }

  void CompositeMaterial::save(const std::string &file) const
  {
    for (const auto &part : parts_)
      part->save(file);
  }

  void CompositeMaterial::load(const std::string &file)
  {
    for (const auto &part : parts_)
      part->load(file);
  }
} // namespace fem
