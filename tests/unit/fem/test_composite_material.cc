#include "fem/composite_material.h"
#include "fem/hdf5_file.h"
#include "tests/support/pile_cases.h"
#include "tests/support/scratch_folder.h"

#include <gtest/gtest.h>

using namespace fem;
using namespace fem::cases;

namespace
{
  constexpr ElasticParameters stiff = {2e9, 0.2, Kinematics::finite}, soft = {1e9, 0.3, Kinematics::finite};

  std::vector<PointSite> get_sites()
  {
    std::vector<PointSite> sites(4);
    for (unsigned int i = 0; i < 4; ++i)
      {
        sites[i].id = i;
        sites[i].region = i % 2 == 0 ? ground_region : pile_region; // mixed, as the cells of a mesh may be
      }
    return sites;
  }

  std::vector<PointRequest> get_requests(double strain)
  {
    std::vector<PointRequest> requests;
    for (unsigned int i = 0; i < 4; ++i)
      {
        requests.push_back({i, dealii::Tensor<2, 3>(dealii::unit_symmetric_tensor<3>())});
        requests.back().deformation_increment[2][2] += strain * (i + 1.);
        requests.back().deformation_increment[0][2] += strain;
      }
    return requests;
  }
} // namespace

TEST(CompositeMaterial, EachPointIsAnsweredByTheMaterialOfItsRegion)
{
  // Law: the answer of a point is that of its own material alone, tangent included, to the last bit.
  const auto composite = make_elastic_pile(stiff, soft);
  ElasticMaterial pile(stiff, MPI_COMM_SELF), ground(soft, MPI_COMM_SELF);
  const auto sites = get_sites();
  composite->initialise(sites);
  pile.initialise(sites);
  ground.initialise(sites);
  const auto requests = get_requests(1e-3);
  std::vector<PointResponse> mixed(4), of_pile(4), of_ground(4);
  composite->evaluate(requests, mixed, true);
  pile.evaluate(requests, of_pile, true);
  ground.evaluate(requests, of_ground, true);
  for (unsigned int i = 0; i < 4; ++i)
    {
      const PointResponse &own = i % 2 == 0 ? of_ground[i] : of_pile[i];
      EXPECT_EQ(mixed[i].stress, own.stress);
      EXPECT_EQ(mixed[i].tangent, own.tangent);
    }
  EXPECT_NE(of_pile[0].stress, of_ground[0].stress);
}

TEST(CompositeMaterial, ThePartsSpeakWithOneVoice)
{
  // Law: the earliest event, the sum of what broke and the worst status are those of the whole.
  CompositeMaterial composite(MPI_COMM_SELF);
  auto first = std::make_unique<ScriptedMaterial>(), second = std::make_unique<ScriptedMaterial>();
  first->time_to_event = 5.;
  second->time_to_event = 3.;
  second->max_event_cuts = 2;
  first->on_settle = [](bool) { return Settlement{2, false, Status::ok}; };
  second->on_settle = [](bool) { return Settlement{5, true, Status::failed}; };
  composite.add(std::move(first), {pile_region});
  composite.add(std::move(second), {ground_region});
  composite.initialise(get_sites());
  EXPECT_EQ(composite.compute_time_to_next_event(0), 3.);
  EXPECT_TRUE(composite.can_cut_events(1));
  const Settlement settlement = composite.settle(true);
  EXPECT_EQ(settlement.n_broken, 7u);
  EXPECT_TRUE(settlement.is_excessive);
  EXPECT_EQ(settlement.status, Status::failed);
}

TEST(CompositeMaterial, ARegionWithoutAMaterialIsNamed)
{
  // Law: what the mesh holds and nobody answers for is an error that names it.
  CompositeMaterial composite(MPI_COMM_SELF);
  composite.add(std::make_unique<ElasticMaterial>(stiff, MPI_COMM_SELF), {pile_region});
  EXPECT_NE(get_error([&]() { composite.initialise(get_sites()); }).find("region 3"), std::string::npos);
}

TEST(CompositeMaterial, TwoPartsOfOneKindShareAFile)
{
  // Law: what is saved is loaded, each part its own, to the last bit.
  const ScratchFolder folder;
  const std::string file = folder.get_file("composite.h5");
  const bool is_first = dealii::Utilities::MPI::this_mpi_process(MPI_COMM_WORLD) == 0;
  const auto written = make_elastic_pile(stiff, soft), read = make_elastic_pile(stiff, soft);
  for (const auto *material : {&written, &read})
    (*material)->initialise(get_sites());
  std::vector<PointResponse> before(4), after(4);
  written->evaluate(get_requests(1e-2), before, false);
  written->settle(false);
  written->commit();
  if (is_first)
    Hdf5File(file, Hdf5File::Mode::create).close();
  written->save(file);
  MPI_Barrier(MPI_COMM_WORLD);
  read->load(file);
  written->evaluate(get_requests(0.), before, false);
  read->evaluate(get_requests(0.), after, false);
  for (unsigned int i = 0; i < 4; ++i)
    EXPECT_EQ(before[i].stress, after[i].stress);
  EXPECT_GT(after[1].stress.norm(), 1e6);
}

TEST(CompositeMaterial, APointThatEntersIsFreeOfStress)
{
  // Law: restart() leaves a point as if nothing had ever happened to it, and the others as they are.
  const auto composite = make_elastic_pile(stiff, soft);
  composite->initialise(get_sites());
  std::vector<PointResponse> responses(4);
  composite->evaluate(get_requests(1e-2), responses, false);
  const auto of_ground = responses[0].stress;
  composite->settle(false);
  composite->commit();
  const std::vector<PointId> entering = {1, 3};
  composite->restart(entering);
  composite->evaluate(get_requests(0.), responses, false);
  EXPECT_EQ(responses[1].stress.norm(), 0.);
  EXPECT_EQ(responses[3].stress.norm(), 0.);
  EXPECT_EQ(responses[0].stress, of_ground);
}

TEST(CompositeMaterial, FieldsOfOtherPartsAreNoNumber)
{
  // Law: every point has every field; those that its material does not know are NaN, never 0.
  const auto composite = make_elastic_pile(stiff, soft);
  composite->initialise(get_sites());
  EXPECT_EQ(composite->get_field_names(), std::vector<std::string>{"material [-]"});
  EXPECT_EQ(composite->compute_fields(1), std::vector<double>{1.});
  EXPECT_EQ(composite->compute_fields(2), std::vector<double>{3.});
}
