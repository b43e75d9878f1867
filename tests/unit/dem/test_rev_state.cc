#include "dem/rev_state.h"

#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <string>

using dem::RevState;

namespace
{
  dem::Row draw_row(std::mt19937_64 &random)
  {
    std::normal_distribution<double> normal;
    return {normal(random), normal(random), normal(random), std::exp(normal(random))};
  }

  /** A state in which no two numbers are alike, so that no two fields can be exchanged unnoticed. */
  RevState make_state(const std::size_t n_grains)
  {
    std::mt19937_64 random(11);
    std::normal_distribution<double> normal;
    RevState state;
    state.cell.edges = dem::Matrix::NullaryExpr([&] { return normal(random); });
    state.cell.deformation = dem::Matrix::NullaryExpr([&] { return normal(random); });
    state.resize_grains(n_grains);
    for (std::size_t i = 0; i < n_grains; ++i)
      {
        state.grains.place[i] = draw_row(random);
        state.grains.velocity[i] = draw_row(random);
        state.grains.spin[i] = draw_row(random);
        state.grains.id[i] = random();
        state.grains.parent[i] = random();
        state.grains.generation[i] = static_cast<std::uint32_t>(random());
        state.grains.strength[i] = normal(random);
        state.grains.crack_half_length[i] = normal(random);
        state.grains.crack_velocity[i] = normal(random);
        state.grains.largest_contact_stress[i] = normal(random);
        state.add(dem::ContactMemory{static_cast<std::uint32_t>(i), static_cast<std::uint32_t>((i * 7 + 1) % n_grains),
                                     dem::Vector(normal(random), -0., 5e-324), i % 3 == 0});
      }
    state.stress = dem::Matrix::NullaryExpr([&] { return normal(random); });
    state.rotation = dem::Matrix::NullaryExpr([&] { return normal(random); });
    state.time = normal(random);
    state.unbalanced_ratio = std::numeric_limits<double>::quiet_NaN();
    state.initial_solid_volume = normal(random);
    state.counters = {random(), random(), random(), random()};
    return state;
  }

  std::string message_of(const std::vector<std::byte> &bytes)
  {
    try
      {
        dem::deserialise(bytes);
      }
    catch (const std::runtime_error &error)
      {
        return error.what();
      }
    return "accepted";
  }

  bool contains(const std::string &text, const std::string &part)
  {
    return text.find(part) != std::string::npos;
  }

  template <typename T>
  bool are_equal_bits(const T &x, const T &y)
  {
    return std::memcmp(&x, &y, sizeof(T)) == 0;
  }
} // namespace

// What comes back is what went in, to the bit: NaN, negative zero and denormal included.
TEST(RevState, RoundTripKeepsEveryBit)
{
  const RevState state = make_state(37);
  const RevState copy = dem::deserialise(dem::serialise(state));
  EXPECT_EQ(copy.cell.edges, state.cell.edges);
  EXPECT_EQ(copy.cell.deformation, state.cell.deformation);
  ASSERT_EQ(copy.grains.size(), state.grains.size());
  for (std::size_t i = 0; i < state.grains.size(); ++i)
    {
      EXPECT_TRUE(are_equal_bits(copy.grains.place[i], state.grains.place[i]));
      EXPECT_TRUE(are_equal_bits(copy.grains.velocity[i], state.grains.velocity[i]));
      EXPECT_TRUE(are_equal_bits(copy.grains.spin[i], state.grains.spin[i]));
      EXPECT_EQ(copy.contacts[i].a, state.contacts[i].a);
      EXPECT_EQ(copy.contacts[i].b, state.contacts[i].b);
      EXPECT_EQ(copy.contacts[i].is_sliding, state.contacts[i].is_sliding);
      EXPECT_TRUE(are_equal_bits(copy.contacts[i].shear_force, state.contacts[i].shear_force));
    }
  EXPECT_EQ(copy.grains.id, state.grains.id);
  EXPECT_EQ(copy.grains.parent, state.grains.parent);
  EXPECT_EQ(copy.grains.generation, state.grains.generation);
  EXPECT_EQ(copy.grains.strength, state.grains.strength);
  EXPECT_EQ(copy.grains.crack_half_length, state.grains.crack_half_length);
  EXPECT_EQ(copy.grains.crack_velocity, state.grains.crack_velocity);
  EXPECT_EQ(copy.grains.largest_contact_stress, state.grains.largest_contact_stress);
  EXPECT_EQ(copy.stress, state.stress);
  EXPECT_EQ(copy.rotation, state.rotation);
  EXPECT_EQ(copy.time, state.time);
  EXPECT_TRUE(are_equal_bits(copy.unbalanced_ratio, state.unbalanced_ratio));
  EXPECT_EQ(copy.initial_solid_volume, state.initial_solid_volume);
  EXPECT_TRUE(are_equal_bits(copy.counters, state.counters));
  EXPECT_EQ(dem::serialise(copy), dem::serialise(state));
}

// An empty state is a state.
TEST(RevState, EmptyRoundTrip)
{
  const RevState copy = dem::deserialise(dem::serialise(RevState{}));
  EXPECT_EQ(copy.grains.size(), 0u);
  EXPECT_TRUE(copy.contacts.empty());
}

// Bytes that are not a whole state of this version are refused, each for its own reason.
TEST(RevState, RefusesWhatIsNotAState)
{
  const std::vector<std::byte> good = dem::serialise(make_state(5));
  std::vector<std::byte> bytes = good;
  for (const std::size_t n : {std::size_t{0}, std::size_t{20}, std::size_t{48}, good.size() - 1})
    {
      bytes.assign(good.begin(), good.begin() + static_cast<std::ptrdiff_t>(n));
      EXPECT_TRUE(contains(message_of(bytes), "truncated")) << n << ": " << message_of(bytes);
    }
  bytes = good;
  bytes[0] = std::byte{'P'};
  EXPECT_TRUE(contains(message_of(bytes), "foreign")) << message_of(bytes);
  bytes = good;
  bytes[8] = std::byte{200};
  EXPECT_TRUE(contains(message_of(bytes), "wrong version: 200")) << message_of(bytes);
  bytes = good;
  bytes.push_back(std::byte{0});
  EXPECT_TRUE(contains(message_of(bytes), "lengths")) << message_of(bytes);
}

// What has crept at contacts goes with the state, every bit, and is as well guarded as the rest.
TEST(RevState, CarriesWhatHasCrept)
{
  RevState state = make_state(5);
  const std::size_t n_bytes = dem::serialise(state).size();
  state.add(dem::CreptContact{3, 7, 1e-7, -0., dem::Vector(5e-324, 2., -3.)});
  state.add(dem::CreptContact{3, ~std::uint64_t{0}, 4., 5., dem::Vector(6., 7., 8.)});
  const std::vector<std::byte> good = dem::serialise(state);
  EXPECT_EQ(good.size(), n_bytes + 2 * 56);
  const RevState copy = dem::deserialise(good);
  ASSERT_EQ(copy.crept_contacts.size(), 2u);
  for (std::size_t i = 0; i < 2; ++i)
    EXPECT_TRUE(are_equal_bits(copy.crept_contacts[i], state.crept_contacts[i]));
  std::vector<std::byte> bytes = good;
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit)
    {
      const std::byte mask = std::byte{1} << (bit % 8);
      bytes[bit / 8] ^= mask;
      ASSERT_NE(message_of(bytes), "accepted") << "bit " << bit;
      bytes[bit / 8] ^= mask;
    }
}

// No bit can flip unnoticed, wherever it is.
TEST(RevState, RefusesEveryFlippedBit)
{
  std::vector<std::byte> bytes = dem::serialise(make_state(3));
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit)
    {
      const std::byte mask = std::byte{1} << (bit % 8);
      bytes[bit / 8] ^= mask;
      ASSERT_NE(message_of(bytes), "accepted") << "bit " << bit;
      bytes[bit / 8] ^= mask;
    }
  EXPECT_EQ(message_of(bytes), "accepted");
}

// e = (V - Vs)/Vs; with fines, Vs is what it was before any grain split.
TEST(RevState, VoidRatiosOfACubeWithOneGrain)
{
  RevState state;
  state.cell.edges *= 2.;
  state.resize_grains(1);
  state.grains.place[0].w = 1.;
  state.initial_solid_volume = 5.;
  const double solids = 4. / 3. * std::numbers::pi;
  EXPECT_NEAR(compute_void_ratio(state), 8. / solids - 1., 1e-15); // rounding
  EXPECT_NEAR(compute_void_ratio_with_fines(state), 0.6, 1e-15);   // rounding
}
