#include "dem/homogenisation.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/QR>

#include <cmath>
#include <gtest/gtest.h>
#include <random>
#include <vector>

using dem::Contact;
using dem::Matrix;
using dem::Tangent;
using dem::Vector;

namespace
{
  constexpr double kn = 1., kt = 0.7;

  /** A contact of linear springs that remembers where it was when its shear force was last updated. */
  struct Spring
  {
    int a, b;
    Vector branch, shear_force;
    bool is_sliding;
  };

  /** How one spring answers to new places of its grains. */
  struct Answer
  {
    Vector branch, force, shear_force;
    double arm_a, arm_b;
  };

  /**
   * A handful of grains in a periodic cell, with finite displacements: overlaps, normals and lever arms are measured in
   * the new place, the shear force is turned onto the new plane and about the normal. Knows no derivatives.
   */
  class SpringNetwork
  {
  public:
    SpringNetwork(bool is_rotation_free, unsigned int seed);

    /** Strains the cell, lets the grains come to rest and forgets the old places. */
    void strain(const Matrix &strain);

    /** Symmetric part of the stress at rest after a strain [Pa], history untouched. */
    Matrix compute_stress_after(const Matrix &strain) const;

    dem::ContactGraph make_graph(std::vector<Contact> &contacts) const;
    double compute_unbalanced() const { return compute_residual(zero(), Matrix::Zero()).norm(); }
    int n_springs() const { return static_cast<int>(springs_.size()); }

  private:
    int width() const { return is_rotation_free_ ? 6 : 3; }
    Eigen::VectorXd zero() const { return Eigen::VectorXd::Zero(width() * static_cast<int>(radii_.size())); }
    Answer compute_answer(const Spring &spring, const Eigen::VectorXd &x, const Matrix &strain) const;
    Eigen::VectorXd compute_residual(const Eigen::VectorXd &x, const Matrix &strain) const;
    Eigen::VectorXd relax(const Matrix &strain) const;

    bool is_rotation_free_;
    double volume_ = 4. * std::sqrt(2.);
    std::vector<double> radii_;
    std::vector<Spring> springs_;
  };

  // Eight jittered grains on two cells of a face-centred cubic lattice of nearest distance 1, overlapping by about a
  // tenth, which makes the prestress terms large. (On a simple cubic lattice free grains would turn like gears.)
  SpringNetwork::SpringNetwork(const bool is_rotation_free, const unsigned int seed)
      : is_rotation_free_(is_rotation_free)
  {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> jitter(-0.08, 0.08);
    const double half = std::sqrt(0.5);
    std::vector<Vector> places;
    for (int i = 0; i < 8; ++i)
      {
        const Vector site(i / 2 % 2 + i % 2, i / 2 % 2, i / 4 * 2 + i % 2);
        places.push_back(half * site + Vector(jitter(random), jitter(random), jitter(random)));
        radii_.push_back(0.54 + 0.5 * jitter(random));
      }
    for (int a = 0; a < 8; ++a)
      for (int b = a; b < 8; ++b)
        for (int image = 0; image < 27; ++image)
          {
            const Vector shift = half * Vector(2 * (image % 3 - 1), 2 * (image / 3 % 3 - 1), 4 * (image / 9 - 1));
            const Vector branch = places[b] + shift - places[a];
            if ((a < b || image > 13) && branch.norm() < radii_[a] + radii_[b])
              springs_.push_back({a, b, branch, Vector::Zero(), random() % 8 == 0});
          }
    strain(Matrix::Zero());
  }

  Answer SpringNetwork::compute_answer(const Spring &spring, const Eigen::VectorXd &x, const Matrix &strain) const
  {
    const int a = width() * spring.a, b = width() * spring.b;
    const Vector moved = x.segment<3>(b) - x.segment<3>(a) + strain * spring.branch;
    Answer answer;
    answer.branch = spring.branch + moved;
    const Vector n = answer.branch.normalized();
    const double overlap = radii_[spring.a] + radii_[spring.b] - answer.branch.norm();
    answer.arm_a = radii_[spring.a] - 0.5 * overlap;
    answer.arm_b = radii_[spring.b] - 0.5 * overlap;
    Vector slip = moved;
    Vector t = spring.shear_force - n * n.dot(spring.shear_force);
    if (t.norm() > 0.)
      t *= spring.shear_force.norm() / t.norm();
    if (is_rotation_free_)
      {
        const Vector turn_a = x.segment<3>(a + 3), turn_b = x.segment<3>(b + 3);
        slip += n.cross(answer.arm_a * turn_a + answer.arm_b * turn_b);
        t = Eigen::AngleAxisd(0.5 * n.dot(turn_a + turn_b), n) * t;
      }
    answer.shear_force = t + (spring.is_sliding ? 0. : kt) * (slip - n * n.dot(slip));
    answer.force = answer.shear_force - kn * overlap * n;
    return answer;
  }

  Eigen::VectorXd SpringNetwork::compute_residual(const Eigen::VectorXd &x, const Matrix &strain) const
  {
    Eigen::VectorXd residual = zero();
    for (const Spring &spring : springs_)
      {
        const Answer answer = compute_answer(spring, x, strain);
        const int a = width() * spring.a, b = width() * spring.b;
        residual.segment<3>(a) += answer.force;
        residual.segment<3>(b) -= answer.force;
        if (!is_rotation_free_)
          continue;
        const Vector n = answer.branch.normalized();
        residual.segment<3>(a + 3) += answer.arm_a * n.cross(answer.force);
        residual.segment<3>(b + 3) += answer.arm_b * n.cross(answer.force);
      }
    return residual;
  }

  Eigen::VectorXd SpringNetwork::relax(const Matrix &strain) const
  {
    Eigen::VectorXd x = zero();
    const double step = 1e-6;
    Eigen::MatrixXd slope(x.size(), x.size());
    for (int iteration = 0; iteration < 20; ++iteration)
      {
        const Eigen::VectorXd residual = compute_residual(x, strain);
        if (residual.norm() < 1e-14 * n_springs())
          break;
        for (int i = 0; i < x.size(); ++i)
          {
            Eigen::VectorXd forward = x, backward = x;
            forward(i) += step;
            backward(i) -= step;
            slope.col(i) = (compute_residual(forward, strain) - compute_residual(backward, strain)) / (2. * step);
          }
        Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd> factors; // the whole may drift: least norm
        factors.setThreshold(1e-7);
        x -= factors.compute(slope).solve(residual);
      }
    return x;
  }

  void SpringNetwork::strain(const Matrix &strain)
  {
    const Eigen::VectorXd x = relax(strain);
    for (Spring &spring : springs_)
      {
        const Answer answer = compute_answer(spring, x, strain);
        spring.branch = answer.branch;
        spring.shear_force = answer.shear_force;
      }
    volume_ *= (Matrix::Identity() + strain).determinant();
  }

  Matrix SpringNetwork::compute_stress_after(const Matrix &strain) const
  {
    const Eigen::VectorXd x = relax(strain);
    Matrix sum = Matrix::Zero();
    for (const Spring &spring : springs_)
      {
        const Answer answer = compute_answer(spring, x, strain);
        sum += answer.force * answer.branch.transpose();
      }
    return 0.5 * (sum + sum.transpose()) / (volume_ * (Matrix::Identity() + strain).determinant());
  }

  dem::ContactGraph SpringNetwork::make_graph(std::vector<Contact> &contacts) const
  {
    for (const Spring &spring : springs_)
      {
        Contact contact;
        contact.a = spring.a;
        contact.b = spring.b;
        contact.branch = spring.branch;
        contact.normal = spring.branch.normalized();
        contact.shear_force = spring.shear_force;
        contact.overlap = radii_[spring.a] + radii_[spring.b] - spring.branch.norm();
        contact.normal_force = kn * contact.overlap;
        contact.normal_stiffness = kn;
        contact.shear_stiffness = kt;
        contact.is_sliding = spring.is_sliding;
        contacts.push_back(contact);
      }
    return {contacts, radii_, volume_, is_rotation_free_};
  }

  Tangent compute_differences(const SpringNetwork &network, const double step)
  {
    Tangent tangent;
    for (int c = 0; c < 6; ++c)
      {
        const auto [k, l] = dem::tangent_index[c];
        Matrix strain = Matrix::Zero();
        strain(k, l) += 0.5 * step;
        strain(l, k) += 0.5 * step;
        const Matrix change = network.compute_stress_after(strain) - network.compute_stress_after(-strain);
        for (int r = 0; r < 6; ++r)
          tangent(r, c) = change(dem::tangent_index[r][0], dem::tangent_index[r][1]) / (2. * step);
      }
    return tangent;
  }

  class CondensedTangentOfANetwork : public testing::TestWithParam<bool>
  {};
} // namespace

// The condensed tangent is the derivative of the relaxed stress: all 36 entries, with normal forces and shear forces in
// the contacts, some of them sliding.
TEST_P(CondensedTangentOfANetwork, IsTheSlopeOfTheRelaxedStress)
{
  for (const unsigned int seed : {1u, 2u, 3u})
    {
      SpringNetwork network(GetParam(), seed);
      Matrix shear;
      shear << -0.01, 0.02, 0., 0., 0.01, 0.01, 0.015, 0., -0.01;
      for (int i = 0; i < 3; ++i)
        network.strain(shear);
      ASSERT_LT(network.compute_unbalanced(), 1e-12); // at rest, or the differences mean nothing
      std::vector<Contact> contacts;
      const dem::ContactGraph graph = network.make_graph(contacts);
      const Tangent condensed = dem::compute_condensed_tangent(graph);
      const Tangent differences = compute_differences(network, 1e-5);
      const double scale = condensed.cwiseAbs().maxCoeff();
      // The differences' own error: step^2 by curvature of a few hundred, 1e-8.
      EXPECT_LT((condensed - differences).cwiseAbs().maxCoeff(), 1e-6 * scale) << condensed << "\n\n" << differences;
      // The test would prove little of the unsymmetric terms and of condensation if they were small here.
      EXPECT_GT((condensed - condensed.transpose()).cwiseAbs().maxCoeff(), 1e-3 * scale);
      EXPECT_GT((condensed - dem::compute_affine_tangent(graph)).cwiseAbs().maxCoeff(), 1e-2 * scale);
    }
}

INSTANTIATE_TEST_SUITE_P(Rotation, CondensedTangentOfANetwork, testing::Bool(),
                         [](const auto &info) { return info.param ? "free" : "blocked"; });

// Without prestress both estimates are symmetric, and grains that follow the mean strain store at least as much energy.
TEST(CondensedTangentBounds, AffineIsAnUpperEstimate)
{
  for (const bool is_free : {false, true})
    {
      std::vector<Contact> contacts;
      const SpringNetwork network(is_free, 7);
      const dem::ContactGraph graph = network.make_graph(contacts);
      for (Contact &contact : contacts)
        {
          contact.normal_force = 0.;
          contact.shear_force.setZero();
        }
      const Tangent affine = dem::compute_affine_tangent(graph), condensed = dem::compute_condensed_tangent(graph);
      const double scale = affine.norm();
      EXPECT_LT((affine - affine.transpose()).norm(), 1e-13 * scale);        // rounding
      EXPECT_LT((condensed - condensed.transpose()).norm(), 1e-9 * scale);   // the solver's tolerance
      const Eigen::SelfAdjointEigenSolver<Tangent> gain(affine - condensed); // energy saved by relaxing
      EXPECT_GT(gain.eigenvalues().minCoeff(), -1e-9 * scale);
      EXPECT_GT(gain.eigenvalues().maxCoeff(), 1e-3 * scale);
    }
}

// The same graph gives the same bits.
TEST(CondensedTangentBounds, IsDeterministic)
{
  SpringNetwork network(true, 4);
  std::vector<Contact> contacts;
  const dem::ContactGraph graph = network.make_graph(contacts);
  EXPECT_EQ(dem::compute_condensed_tangent(graph), dem::compute_condensed_tangent(graph));
}
