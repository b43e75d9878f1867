#pragma once

#include <deal.II/lac/trilinos_solver.h>
#include <deal.II/lac/trilinos_sparse_matrix.h>
#include <deal.II/lac/trilinos_vector.h>

#include <memory>
#include <vector>

namespace fem
{
  using Vector = dealii::TrilinosWrappers::MPI::Vector;
  using Matrix = dealii::TrilinosWrappers::SparseMatrix;

  enum class LinearSolverKind
  {
    automatic, ///< direct on one rank; on several gmres, and direct for a matrix where that fails
    direct,    ///< Amesos KLU; the factors are kept
    cg,        ///< for tangents without initial stress: they are symmetric
    gmres      ///< any tangent
  };

  struct LinearSolverParameters
  {
    LinearSolverKind kind = LinearSolverKind::automatic;
    double tolerance = 1e-10;           ///< of the iterative solvers, relative to the right-hand side [-], in (0, 1)
    unsigned int max_iterations = 1000; ///< of the iterative solvers, >= 1
  };

  /** Solves with one matrix as often as wanted: factorised, or with its multigrid hierarchy (ML) kept. */
  class LinearSolver
  {
  public:
    explicit LinearSolver(const LinearSolverParameters &parameters);
    ~LinearSolver();

    /** Factorises. Throws std::runtime_error when the matrix is singular.
     *  @param constant_modes  rigid translations for ML, one vector a component @param degree of the elements */
    void initialise(const Matrix &matrix, const std::vector<std::vector<bool>> &constant_modes, unsigned int degree);

    /** Solves matrix x = right_hand_side. Throws SolverControl::NoConvergence, unless the kind is automatic.
     *  @pre initialise() was called and its matrix still lives */
    void solve(Vector &solution, const Vector &right_hand_side);

    unsigned int count_rescues() const { return n_rescues_; } ///< matrices factorised after an iteration had failed

  private:
    LinearSolverParameters parameters_;
    const Matrix *matrix_ = nullptr;
    unsigned int n_rescues_ = 0;
    dealii::SolverControl direct_control_;
    std::unique_ptr<dealii::TrilinosWrappers::SolverDirect> direct_;
    std::unique_ptr<dealii::TrilinosWrappers::PreconditionBase> preconditioner_;
  };
} // namespace fem
