#include "dem/skins.h"

#include "dem/network_builder.h"

#include "tests/support/rev_cases.h"

#include <gtest/gtest.h>

#include <limits>

// Grains in a wide cell: the second twice as large as the others, the third the one that moves.
namespace
{
  using namespace dem;
  using namespace dem::cases;

  constexpr double skin = 0.2 * radius;

  struct Scene
  {
    Scene()
    {
      state.grains.place[1].w = 2. * radius;
      skins.set_alike(state.grains, skin);
      build();
    }

    void build()
    {
      builder.build(state, skins.get_values(), team, network);
      skins.begin(network);
    }

    void move(const std::size_t grain, const double way)
    {
      state.grains.place[grain].z += way / state.cell.edges(2, 2);
    }

    SkinUse compute_use() const { return compute_skin_use(network, state.cell, state.grains, 0, state.grains.size()); }

    RevState state = make_state({{0., 0., 0.}, {4. * radius, 0., 0.}, {0., 4. * radius, 0.}}, 20. * radius);
    Skins skins;
    Team team{1};
    NetworkBuilder builder;
    ContactNetwork network;
  };

  TEST(Skins, AGrainUsesItsWayAndHalfOfTheStrain)
  {
    // Law: what a grain has used is its way, and the strain's norm times half of the reach. Tolerance: rounding.
    Scene scene;
    EXPECT_LT(scene.compute_use().share, 1e-13);
    scene.move(2, 0.03 * radius);
    EXPECT_NEAR(scene.compute_use().share, 0.3, 1e-13);
    EXPECT_NEAR(scene.compute_use().rest, 0.07 * radius, 1e-13 * radius);
    scene.move(2, -0.03 * radius);
    scene.state.cell.deform(Vector(1., 1., 0.99).asDiagonal().toDenseMatrix());
    EXPECT_NEAR(scene.compute_use().share, 0.01 * 2.1 / 0.1, 1e-12); // reach: twice 2.1 radii
  }

  TEST(Skins, BoundsCallForALookBeforeAnyGrainIsThrough)
  {
    // Law: a block is in doubt once its steps and the strain add up to the smallest of its skins, and a look sets the
    // bound to what is really left; a new network is due at four fifths.
    Scene scene;
    const std::vector<double> steps = {0.04 * radius};
    for (int cycle = 0; cycle < 2; ++cycle)
      scene.skins.add_cycle(scene.network, steps, 0.);
    EXPECT_FALSE(scene.skins.is_in_doubt(0)); // 0.08 of 0.1
    scene.skins.add_cycle(scene.network, steps, 0.);
    EXPECT_TRUE(scene.skins.is_in_doubt(0));
    scene.move(2, 0.07 * radius);
    EXPECT_FALSE(scene.skins.look(0, scene.network, scene.state.cell, scene.state.grains));
    EXPECT_FALSE(scene.skins.is_in_doubt(0));
    scene.skins.add_cycle(scene.network, steps, 0.);
    EXPECT_TRUE(scene.skins.is_in_doubt(0)); // 0.11 of 0.1
    scene.move(2, 0.02 * radius);
    EXPECT_TRUE(scene.skins.look(0, scene.network, scene.state.cell, scene.state.grains));
  }

  TEST(Skins, AFastGrainHasALargerOneNextTime)
  {
    // Law: two hundred cycles of its speed, and no farther than the largest grain reaches; half of it stays when the
    // grain is slow; all others keep theirs. Tolerance: rounding.
    Scene scene;
    const auto pass = [&](const double way, const int n_cycles) {
      scene.move(2, way);
      for (int cycle = 0; cycle < n_cycles; ++cycle)
        scene.skins.add_cycle(scene.network, std::vector<double>{way}, 0.);
      scene.skins.adapt(scene.network, scene.state.cell, scene.state.grains);
      scene.build();
      return scene.skins.get_values()[2];
    };
    const double usual = 0.5 * skin;
    EXPECT_EQ(pass(0.01 * radius, 100), usual); // 0.02 in two hundred
    EXPECT_NEAR(pass(0.09 * radius, 100), 0.18 * radius, 1e-12 * radius);
    EXPECT_NEAR(pass(0.09 * radius, 2), radius + usual, 1e-12 * radius); // the largest reaches 2.1 radii
    EXPECT_NEAR(pass(0., 50), 0.5 * (radius + usual), 1e-12 * radius);
    EXPECT_EQ(scene.skins.get_values()[0], usual);
    EXPECT_EQ(scene.skins.get_values()[1], usual);
    EXPECT_NEAR(scene.network.reach, 4.2 * radius, 1e-12 * radius);
  }

  TEST(Skins, AGrainThatIsNowhereHasTheUsualOne)
  {
    // Law: a place that is not a number calls for nothing; whoever runs the cycles is told by is_finite().
    Scene scene;
    scene.state.grains.place[2].x = std::numeric_limits<double>::quiet_NaN();
    EXPECT_FALSE(scene.skins.look(0, scene.network, scene.state.cell, scene.state.grains));
    scene.skins.adapt(scene.network, scene.state.cell, scene.state.grains);
    EXPECT_EQ(scene.skins.get_values()[2], 0.5 * skin);
  }
} // namespace
