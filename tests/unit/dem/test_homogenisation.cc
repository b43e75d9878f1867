#include "dem/homogenisation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>

#include <cmath>
#include <gtest/gtest.h>
#include <vector>

using dem::Contact;
using dem::Matrix;
using dem::Tangent;
using dem::Vector;

namespace
{
  constexpr double kn = 3e6, kt = 2e6, force = 4e3;

  Contact make_contact(const std::uint32_t a, const std::uint32_t b, const Vector &branch)
  {
    Contact contact;
    contact.a = a;
    contact.b = b;
    contact.branch = branch;
    contact.normal = branch.normalized();
    contact.shear_force = Vector::Zero();
    contact.normal_stiffness = kn;
    contact.shear_stiffness = kt;
    return contact;
  }

  /** One grain that touches its own images at the given branches. */
  std::vector<Contact> make_lattice(const std::vector<Vector> &branches)
  {
    std::vector<Contact> contacts;
    for (const Vector &branch : branches)
      {
        contacts.push_back(make_contact(0, 0, branch));
        contacts.back().normal_force = force;
      }
    return contacts;
  }

  Tangent make_cubic(const double c11, const double c12, const double c44)
  {
    Tangent c = Tangent::Zero();
    c.topLeftCorner<3, 3>().setConstant(c12);
    c.diagonal() << c11, c11, c11, c44, c44, c44;
    return c;
  }

  const std::vector<double> one_radius = {0.5e-3};
} // namespace

// Stress is force on a times branch over volume: a compressed contact gives pressure, a shear force the row it acts in.
TEST(Homogenisation, StressOfOneContact)
{
  Contact contact = make_contact(0, 1, {2., 0., 0.});
  contact.normal_force = 3.;
  contact.shear_force = {0., 5., 0.};
  Matrix expected = Matrix::Zero();
  expected(0, 0) = -3. * 2. / 8.;
  expected(1, 0) = 5. * 2. / 8.;
  EXPECT_EQ(dem::compute_stress({&contact, 1}, 8.), expected);
}

// Fabric is the mean of n x n: trace 1, a third of the unit for contacts along three axes, zero without contacts.
TEST(Homogenisation, FabricOfThreeAxes)
{
  const auto contacts = make_lattice({{1., 0., 0.}, {0., 2., 0.}, {0., 0., 3.}});
  EXPECT_LT((dem::compute_fabric(contacts) - Matrix::Identity() / 3.).norm(), 1e-15); // rounding
  EXPECT_EQ(dem::compute_fabric({}), Matrix::Zero());
}

// Every contact counts for two grains; grains with fewer contacts than can hold them are left out of the second mean.
TEST(Homogenisation, CoordinationWithAndWithoutRattlers)
{
  std::vector<Contact> contacts; // a tetrahedron 0..3, each grain with three contacts; 4 hangs on 0, 5 is loose
  for (std::uint32_t a = 0; a < 4; ++a)
    for (std::uint32_t b = a + 1; b < 4; ++b)
      contacts.push_back(make_contact(a, b, {1., 0., 0.}));
  contacts.push_back(make_contact(0, 4, {1., 0., 0.}));
  const dem::CoordinationNumbers blocked = dem::compute_coordination(contacts, 6, false);
  EXPECT_DOUBLE_EQ(blocked.all, 14. / 6.);
  EXPECT_DOUBLE_EQ(blocked.without_rattlers, 14. / 4.);
  EXPECT_EQ(blocked.n_rattlers, 2u);
  const dem::CoordinationNumbers free = dem::compute_coordination(contacts, 6, true);
  EXPECT_EQ(free.n_rattlers, 5u); // only grain 0 has four
  EXPECT_DOUBLE_EQ(free.without_rattlers, 14.);
  EXPECT_EQ(dem::compute_coordination({}, 3, true).without_rattlers, 0.);
}

// Simple cubic lattice of spacing L under pressure p = N/L^2: C11 = kn/L, C12 = p, C44 = kt/(2L) - p (Birch's
// coefficients of a crystal under pressure).
TEST(CondensedTangent, SimpleCubicUnderPressure)
{
  const double L = 1e-3, p = force / (L * L);
  const auto contacts = make_lattice({{L, 0., 0.}, {0., L, 0.}, {0., 0., L}});
  const Tangent expected = make_cubic(kn / L, p, kt / (2. * L) - p);
  for (const bool is_free : {false, true})
    {
      const Tangent c = dem::compute_condensed_tangent({contacts, one_radius, L * L * L, is_free});
      EXPECT_LT((c - expected).norm(), 1e-12 * expected.norm()); // rounding
    }
}

// Face-centred cubic lattice of nearest distance l, p = 2 sqrt2 N/l^2: C11 = sqrt2/l (kn + kt) - p/2,
// C12 = (kn - kt)/(sqrt2 l) + 5p/4, C44 = (kn + kt)/(sqrt2 l) - 3p/4; a single grain can neither move nor turn.
TEST(CondensedTangent, FaceCentredCubicUnderPressure)
{
  const double l = 1e-3, root = std::sqrt(2.), h = l / root, p = 2. * root * force / (l * l);
  const auto contacts = make_lattice({{h, h, 0.}, {h, -h, 0.}, {0., h, h}, {0., h, -h}, {h, 0., h}, {-h, 0., h}});
  const Tangent expected =
      make_cubic(root / l * (kn + kt) - 0.5 * p, (kn - kt) / (root * l) + 1.25 * p, (kn + kt) / (root * l) - 0.75 * p);
  for (const bool is_free : {false, true})
    {
      const dem::ContactGraph graph{contacts, one_radius, l * l * l / root, is_free};
      EXPECT_LT((dem::compute_condensed_tangent(graph) - expected).norm(), 1e-12 * expected.norm()); // rounding
      EXPECT_LT((dem::compute_affine_tangent(graph) - expected).norm(), 1e-12 * expected.norm());
    }
}

// A sliding contact keeps its normal stiffness and loses the tangential one.
TEST(CondensedTangent, SlidingContactHasNoTangentialStiffness)
{
  const double L = 1e-3;
  auto contacts = make_lattice({{L, 0., 0.}, {0., L, 0.}, {0., 0., L}});
  for (Contact &contact : contacts)
    {
      contact.normal_force = 0.;
      contact.is_sliding = true;
    }
  const Tangent expected = make_cubic(kn / L, 0., 0.);
  const Tangent c = dem::compute_condensed_tangent({contacts, one_radius, L * L * L, false});
  EXPECT_LT((c - expected).norm(), 1e-12 * expected.norm()); // rounding
}

// Two unlike springs in a row share the force: k1 k2/(k1 + k2) along the chain, where the affine estimate has the mean.
TEST(CondensedTangent, ChainOfTwoSprings)
{
  const double L = 1e-3, k1 = 1e6, k2 = 5e6, volume = 4. * L * L * L;
  std::vector<Contact> contacts = {make_contact(0, 1, {0., 0., L}), make_contact(1, 0, {0., 0., L})};
  contacts[0].normal_stiffness = k1;
  contacts[1].normal_stiffness = k2;
  const std::vector<double> radii(2, 0.5 * L);
  const dem::ContactGraph graph{contacts, radii, volume, false};
  const double series = 4. * L * L / volume * k1 * k2 / (k1 + k2);
  EXPECT_NEAR(dem::compute_condensed_tangent(graph)(2, 2), series, 1e-10 * series); // the anchor of 1e-12
  EXPECT_NEAR(dem::compute_affine_tangent(graph)(2, 2), (k1 + k2) * L * L / volume, 1e-8);
}

// Two grains that roll on each other in a column: shear of the column is free, where blocked grains resist with kt.
TEST(CondensedTangent, FreeGrainsRollBlockedOnesDoNot)
{
  const double L = 1e-3, volume = 2. * L * L * L;
  std::vector<Contact> contacts = {make_contact(0, 1, {0., 0., L}), make_contact(1, 0, {0., 0., L})};
  const std::vector<double> radii(2, 0.5 * L);
  const double blocked = dem::compute_condensed_tangent({contacts, radii, volume, false})(4, 4);
  const double free = dem::compute_condensed_tangent({contacts, radii, volume, true})(4, 4);
  EXPECT_NEAR(blocked, 2. * kt * L * L / 4. / volume, 1e-10 * blocked); // sum kt l^2/4 over volume; the anchor
  EXPECT_LT(std::abs(free), 1e-8 * blocked);                            // the anchor of 1e-12, and rounding
}

// Rattlers change nothing, neither loose ones nor one that hangs on a single contact without force.
TEST(CondensedTangent, RattlersChangeNothing)
{
  const double L = 1e-3, volume = 4. * L * L * L;
  std::vector<Contact> contacts = {make_contact(0, 1, {0., 0., L}), make_contact(1, 0, {0., 0., L}),
                                   make_contact(0, 0, {L, 0., 0.}), make_contact(1, 1, {0., L, 0.})};
  contacts[0].normal_stiffness = 5e6;
  std::vector<double> radii(2, 0.5 * L);
  const Tangent without = dem::compute_condensed_tangent({contacts, radii, volume, false});
  const Tangent without_free = dem::compute_condensed_tangent({contacts, radii, volume, true});
  radii.resize(4, 0.5 * L);
  contacts.push_back(make_contact(1, 3, {0.6 * L, 0., 0.8 * L}));
  const Tangent with = dem::compute_condensed_tangent({contacts, radii, volume, false});
  const Tangent with_free = dem::compute_condensed_tangent({contacts, radii, volume, true});
  EXPECT_LT((with - without).norm(), 1e-8 * without.norm()); // what the anchor may do
  EXPECT_LT((with_free - without_free).norm(), 1e-8 * without.norm());
}

// No contacts, no stiffness.
TEST(CondensedTangent, LooseGrainsHaveNone)
{
  EXPECT_EQ(dem::compute_condensed_tangent({{}, one_radius, 1., true}), Tangent::Zero());
}
