#include "dem/homogenisation.h"

#include <Eigen/Geometry>
#include <Eigen/IterativeLinearSolvers>
#include <Eigen/SparseCholesky>
#include <Eigen/SparseLU>

#include <algorithm>
#include <array>
#include <limits>

namespace dem
{
  namespace
  {
    using SparseMatrix = Eigen::SparseMatrix<double>;
    using Columns = Eigen::Matrix<double, Eigen::Dynamic, 6>;

    // Stiffness that every grain gets from nowhere, over the mean normal stiffness: holds rattlers and the translation
    // of the whole. It moves the answer by its ratio to the network's softest mode, about 1e-3.
    constexpr double anchor_ratio = 1e-12;

    // Residual over right-hand side at which a solution is taken: with the softest mode at 1e-3 of the mean stiffness
    // the tangent is good to 1e-8 at the worst.
    constexpr double solver_tolerance = 1e-11;
    constexpr int n_iterations_at_most = 40;

    /**
     * Preconditioner: factors of the symmetric part. The rest is small, shear force over stiffness times length, so
     * that two or three iterations suffice, at a fraction of the cost of unsymmetric factors.
     */
    class SymmetricPart : public Eigen::SimplicialLDLT<SparseMatrix>
    {
    public:
      template <typename AnyMatrix>
      SymmetricPart &compute(const AnyMatrix &matrix)
      {
        const SparseMatrix transposed = matrix.transpose();
        Eigen::SimplicialLDLT<SparseMatrix>::compute(0.5 * (matrix + transposed));
        return *this;
      }
    };

    /** How a contact answers to w (relative displacement of the centres) and to the turns of a and b, times -1 for the
     *  moments: block (i, j) of d(f_a, -m_a, -m_b)/d(w, turn_a, turn_b). Symmetric but for the terms with t. */
    using ContactStiffness = std::array<std::array<Matrix, 3>, 3>;

    Matrix make_cross(const Vector &v)
    {
      Matrix m;
      m << 0., -v.z(), v.y(), v.z(), 0., -v.x(), -v.y(), v.x(), 0.;
      return m;
    }

    double get_tangential_stiffness(const Contact &contact)
    {
      return contact.is_sliding ? 0. : contact.shear_stiffness;
    }

    /** d(f_a)/dw [N/m], docs/theory.md Eq. 7.5. */
    Matrix compute_translational_stiffness(const Contact &contact)
    {
      const Vector &n = contact.normal;
      const double length = contact.branch.norm();
      const Matrix along = n * n.transpose();
      const Matrix across = Matrix::Identity() - along;
      return contact.normal_stiffness * along +
             (get_tangential_stiffness(contact) - contact.normal_force / length) * across -
             n * contact.shear_force.transpose() * across / length;
    }

    /** All blocks, for grains that turn (docs/theory.md Eq. 7.5-7.7). */
    ContactStiffness compute_contact_stiffness(const Contact &contact, const double radius_a, const double radius_b)
    {
      const Vector &n = contact.normal;
      const Vector &t = contact.shear_force;
      const double kt = get_tangential_stiffness(contact);
      const double half = 0.5 * (contact.overlap + contact.crept_overlap);
      const std::array<double, 2> arm = {radius_a - half, radius_b - half};
      const Matrix across = Matrix::Identity() - n * n.transpose();
      const Vector n_cross_t = n.cross(t);
      const Matrix turning = make_cross(t) * across / contact.branch.norm();

      ContactStiffness k;
      k[0][0] = compute_translational_stiffness(contact);
      for (int i = 0; i < 2; ++i)
        {
          k[0][i + 1] = kt * arm[i] * make_cross(n) + 0.5 * n_cross_t * n.transpose();
          k[i + 1][0] = -0.5 * n_cross_t * n.transpose() + arm[i] * (turning - kt * make_cross(n));
          for (int j = 0; j < 2; ++j)
            k[i + 1][j + 1] = arm[i] * (kt * arm[j] * across + 0.5 * t * n.transpose());
        }
      return k;
    }

    /** Six strains of size one, as Tangent counts them. */
    Matrix make_unit_strain(const int column)
    {
      const auto [i, j] = tangent_index[column];
      Matrix strain = Matrix::Zero();
      strain(i, j) += 0.5;
      strain(j, i) += 0.5;
      return strain;
    }

    int find_tangent_index(const int i, const int j)
    {
      int m = 0;
      while (!(tangent_index[m][0] == std::min(i, j) && tangent_index[m][1] == std::max(i, j)))
        ++m;
      return m;
    }

    std::array<Matrix, 6> make_unit_strains()
    {
      std::array<Matrix, 6> strains;
      for (int column = 0; column < 6; ++column)
        strains[column] = make_unit_strain(column);
      return strains;
    }

    /** One of the three-component unknowns that a contact feels. */
    struct Unknown
    {
      int block;           ///< 0: w, 1: turn of a, 2: turn of b
      double sign;         ///< of its part in that
      Eigen::Index offset; ///< place in the vector of all unknowns
    };

    /**
     * The equations of rest: stiffness * x = load, x the displacements of the grains and, where they turn, their turns
     * times the mean radius, so that all unknowns are lengths.
     */
    class Network
    {
    public:
      explicit Network(const ContactGraph &graph);

      /** Displacements in answer to the six unit strains; NaN when there is no answer. */
      Columns solve();

      /** d(stress)/d(strain) once the grains have moved by x [Pa]. */
      Tangent compute_tangent(const Columns &x) const;

    private:
      std::vector<Unknown> list_unknowns(const Contact &contact) const;
      void assemble();
      ContactStiffness compute_scaled_stiffness(const Contact &contact) const;
      Columns solve_directly() const;

      const ContactGraph &graph_;
      double mean_radius_ = 1.;
      Eigen::Index n_unknowns_ = 0;
      SparseMatrix stiffness_;
      Columns load_;
    };

    Network::Network(const ContactGraph &graph) : graph_(graph)
    {
      const auto n_grains = static_cast<Eigen::Index>(graph.radii.size());
      n_unknowns_ = (graph.is_rotation_free ? 6 : 3) * n_grains;
      if (n_grains > 0)
        mean_radius_ = Eigen::Map<const Eigen::VectorXd>(graph.radii.data(), n_grains).mean();
    }

    std::vector<Unknown> Network::list_unknowns(const Contact &contact) const
    {
      const Eigen::Index width = graph_.is_rotation_free ? 6 : 3;
      const Eigen::Index a = width * contact.a, b = width * contact.b;
      if (graph_.is_rotation_free)
        return {{0, -1., a}, {0, 1., b}, {1, 1., a + 3}, {2, 1., b + 3}};
      return {{0, -1., a}, {0, 1., b}};
    }

    ContactStiffness Network::compute_scaled_stiffness(const Contact &contact) const
    {
      ContactStiffness k;
      if (!graph_.is_rotation_free)
        {
          k[0][0] = compute_translational_stiffness(contact);
          return k;
        }
      k = compute_contact_stiffness(contact, graph_.radii[contact.a], graph_.radii[contact.b]);
      for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j)
          k[i][j] /= (i > 0 ? mean_radius_ : 1.) * (j > 0 ? mean_radius_ : 1.);
      return k;
    }

    void Network::assemble()
    {
      std::vector<Eigen::Triplet<double>> entries;
      entries.reserve(graph_.contacts.size() * (graph_.is_rotation_free ? 144 : 36) + n_unknowns_);
      load_ = Columns::Zero(n_unknowns_, 6);
      double mean_stiffness = 0.;
      for (const Contact &contact : graph_.contacts)
        {
          mean_stiffness += contact.normal_stiffness / static_cast<double>(graph_.contacts.size());
          const ContactStiffness k = compute_scaled_stiffness(contact);
          const std::vector<Unknown> unknowns = list_unknowns(contact);
          for (const Unknown &row : unknowns)
            {
              for (const Unknown &column : unknowns)
                for (int i = 0; i < 3; ++i)
                  for (int j = 0; j < 3; ++j)
                    entries.emplace_back(row.offset + i, column.offset + j,
                                         row.sign * column.sign * k[row.block][column.block](i, j));
              for (int c = 0; c < 6; ++c)
                load_.block<3, 1>(row.offset, c) -=
                    row.sign * (k[row.block][0] * (make_unit_strain(c) * contact.branch));
            }
        }
      for (Eigen::Index i = 0; i < n_unknowns_; ++i)
        entries.emplace_back(i, i, anchor_ratio * mean_stiffness);
      stiffness_.resize(n_unknowns_, n_unknowns_);
      stiffness_.setFromTriplets(entries.begin(), entries.end());
    }

    Columns Network::solve()
    {
      assemble();
      Eigen::BiCGSTAB<SparseMatrix, SymmetricPart> solver;
      solver.setTolerance(solver_tolerance);
      solver.setMaxIterations(n_iterations_at_most);
      solver.compute(stiffness_);
      if (solver.preconditioner().info() != Eigen::Success)
        return solve_directly();
      const Columns x = solver.solve(load_);
      return solver.info() == Eigen::Success && x.allFinite() ? x : solve_directly();
    }

    Columns Network::solve_directly() const
    {
      const Eigen::SparseLU<SparseMatrix> factors(stiffness_);
      if (factors.info() != Eigen::Success)
        return Columns::Constant(n_unknowns_, 6, std::numeric_limits<double>::quiet_NaN());
      Columns x = factors.solve(load_);
      x += factors.solve(load_ - stiffness_ * x);
      return x;
    }

    /** Change of stress under unit strains, from the changes of V times stress. */
    Tangent make_tangent(const std::array<Matrix, 6> &changes, const Matrix &stress, const double volume)
    {
      Tangent tangent;
      for (int c = 0; c < 6; ++c)
        {
          const Matrix d = (changes[c] - stress * make_unit_strain(c).trace()) / volume;
          for (int r = 0; r < 6; ++r)
            tangent(r, c) =
                0.5 * (d(tangent_index[r][0], tangent_index[r][1]) + d(tangent_index[r][1], tangent_index[r][0]));
        }
      return tangent;
    }

    Tangent Network::compute_tangent(const Columns &x) const
    {
      const std::array<Matrix, 6> strains = make_unit_strains();
      std::array<Matrix, 6> change;
      change.fill(Matrix::Zero());
      Matrix stress = Matrix::Zero();
      for (const Contact &contact : graph_.contacts)
        {
          const ContactStiffness k = compute_scaled_stiffness(contact);
          const std::vector<Unknown> unknowns = list_unknowns(contact);
          const Vector force = compute_force_on_a(contact);
          stress += force * contact.branch.transpose();
          for (int c = 0; c < 6; ++c)
            {
              Vector moved = strains[c] * contact.branch;
              Vector force_change = k[0][0] * moved;
              for (const Unknown &unknown : unknowns)
                {
                  const Vector part = unknown.sign * x.block<3, 1>(unknown.offset, c);
                  force_change += k[0][unknown.block] * part;
                  if (unknown.block == 0)
                    moved += part;
                }
              change[c] += force_change * contact.branch.transpose() + force * moved.transpose();
            }
        }
      return make_tangent(change, stress, graph_.volume);
    }
  } // namespace

  Tangent compute_condensed_tangent(const ContactGraph &graph)
  {
    if (graph.contacts.empty())
      return Tangent::Zero();
    Network network(graph);
    return network.compute_tangent(network.solve());
  }

  Tangent compute_affine_tangent(const ContactGraph &graph)
  {
    // Branches follow the mean strain: one sum over contacts, K_ij b_k b_l, serves all strains.
    Eigen::Matrix<double, 9, 6> sum = Eigen::Matrix<double, 9, 6>::Zero(); // K column by column; kl as in a tangent
    Matrix stress = Matrix::Zero();
    for (const Contact &contact : graph.contacts)
      {
        const Matrix k = compute_translational_stiffness(contact);
        const Vector &branch = contact.branch;
        Eigen::Matrix<double, 6, 1> square;
        for (int m = 0; m < 6; ++m)
          square[m] = branch[tangent_index[m][0]] * branch[tangent_index[m][1]];
        sum += Eigen::Map<const Eigen::Matrix<double, 9, 1>>(k.data()) * square.transpose();
        stress += compute_force_on_a(contact) * branch.transpose();
      }
    std::array<Matrix, 6> change;
    for (int c = 0; c < 6; ++c)
      {
        const Matrix strain = make_unit_strain(c);
        change[c] = stress * strain.transpose();
        for (int l = 0; l < 3; ++l)
          for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
              change[c].col(l) += strain(j, k) * sum.col(find_tangent_index(k, l)).segment<3>(3 * j);
      }
    return make_tangent(change, stress, graph.volume);
  }
} // namespace dem
