#include "coupling/initial_state.h"
#include "coupling/tensor_conversion.h"
#include "tests/unit/coupling/rev_sample.h"

#include <gtest/gtest.h>

namespace coupling
{
  namespace
  {
    /** Geostatic stress with K0 = 0.5 [Pa], tension-positive. */
    dem::Matrix make_stress(const double vertical)
    {
      return dem::Vector(-0.5 * vertical, -0.5 * vertical, -vertical).asDiagonal();
    }

    std::vector<dem::Matrix> make_column()
    {
      std::vector<dem::Matrix> stresses;
      for (const double vertical : {4e6, 1e6, 2e6, 1.4e6, 2.8e6, 1e6})
        stresses.push_back(make_stress(vertical));
      return stresses;
    }

    /** Points in a column of ground, each with its own stress. */
    std::vector<fem::PointSite> make_column_sites()
    {
      std::vector<fem::PointSite> sites;
      for (const dem::Matrix &stress : make_column())
        sites.push_back({static_cast<PointId>(sites.size()), {}, to_symmetric_tensor(stress)});
      return sites;
    }
  } // namespace

  TEST(PackingLibrary, LevelsGoFromTheLeastToTheLargestStressInEqualRatios)
  {
    // Law: levels are stresses of points; ends included; doubles and the order of the points do not count.
    const auto levels = choose_levels(make_column(), 3);
    ASSERT_EQ(levels.size(), 3u);
    EXPECT_EQ(levels[0], make_stress(1e6));
    EXPECT_EQ(levels[1], make_stress(2e6));
    EXPECT_EQ(levels[2], make_stress(4e6));
    auto reversed = make_column();
    std::reverse(reversed.begin(), reversed.end());
    EXPECT_EQ(choose_levels(reversed, 3), levels);
    EXPECT_EQ(choose_levels({make_stress(1e6), make_stress(1e6)}, 4).size(), 1u);
  }

  TEST(PackingLibrary, APointStartsFromTheNearestLevel)
  {
    // Law: nearest in the norm of the difference of stresses.
    const auto levels = choose_levels(make_column(), 3);
    EXPECT_EQ(find_nearest_level(levels, make_stress(1.4e6)), 0u);
    EXPECT_EQ(find_nearest_level(levels, make_stress(2.8e6)), 1u);
    EXPECT_EQ(find_nearest_level(levels, make_stress(9e6)), 2u);
  }

  TEST(PackingLibrary, EachPointComesToItsOwnStress)
  {
    // Law: each REV stands at its own point's stress within 0.1 % of the largest component, whatever level it came
    // from.
    RevMaterialParameters parameters = rev_sample::make_parameters();
    parameters.packing.n_packings = 2;
    parameters.packing.n_levels = 2;
    parameters.consolidation.stress_tolerance = 1e-3;
    RevMaterial material(parameters, rev_sample::make_pool());
    material.initialise(make_column_sites());
    const auto stresses = material.collect_stresses();
    for (const fem::PointSite &site : make_column_sites())
      {
        const auto error = stresses.at(site.id) - site.initial_stress;
        for (unsigned int i = 0; i < 3; ++i)
          for (unsigned int j = i; j < 3; ++j)
            EXPECT_LT(std::abs(error[i][j]), 1e-3 * std::abs(site.initial_stress[2][2])) << site.id;
      }
  }

  TEST(PackingLibrary, AStricterToleranceIsForTheConsolidationAlone)
  {
    // Law: afterwards the REV comes to rest by its own rule again.
    const dem::RevModel model = rev_sample::make_model();
    ConsolidationRule rule;
    rule.stress_tolerance = 1e-4;
    const dem::Rev rev = consolidate(rev_sample::make_rev(model), make_stress(2e6), rule);
    EXPECT_EQ(rev.get_model().equilibrium.stress_tolerance, model.equilibrium.stress_tolerance);
    EXPECT_NEAR(rev.get_committed().stress(2, 2), -2e6, 1e-4 * 2e6);
    EXPECT_NEAR(rev.get_committed().stress(0, 0), -1e6, 1e-4 * 2e6);
  }
} // namespace coupling
