#include "fem/linear_solver.h"

#include <deal.II/lac/trilinos_precondition.h>

#include <stdexcept>

namespace fem
{
  namespace wrappers = dealii::TrilinosWrappers;

  namespace
  {
    std::unique_ptr<wrappers::SolverDirect> factorise(const Matrix &matrix, dealii::SolverControl &control)
    {
      auto solver = std::make_unique<wrappers::SolverDirect>(
          control, wrappers::SolverDirect::AdditionalData(false, "Amesos_Klu"));
      try
        {
          solver->initialize(matrix);
        }
      catch (const dealii::ExceptionBase &)
        {
          throw std::runtime_error("the tangent matrix is singular: is every rigid motion of the body prescribed away, "
                                   "and does the material answer with a positive stiffness?");
        }
      return solver;
    }
  } // namespace

  LinearSolver::LinearSolver(const LinearSolverParameters &parameters) : parameters_(parameters) {}

  LinearSolver::~LinearSolver() = default;

  void LinearSolver::initialise(const Matrix &matrix, const std::vector<std::vector<bool>> &constant_modes,
                                unsigned int degree)
  {
    matrix_ = &matrix;
    const bool is_automatic = parameters_.kind == LinearSolverKind::automatic;
    const bool is_alone = dealii::Utilities::MPI::n_mpi_processes(matrix.get_mpi_communicator()) == 1;
    if (parameters_.kind == LinearSolverKind::direct || (is_automatic && is_alone))
      {
        direct_ = factorise(matrix, direct_control_);
        return;
      }
    direct_.reset();
    auto multigrid = std::make_unique<wrappers::PreconditionAMG>();
    wrappers::PreconditionAMG::AdditionalData settings;
    settings.elliptic = true;
    settings.higher_order_elements = degree > 1;
    settings.constant_modes = constant_modes;
    multigrid->initialize(matrix, settings);
    preconditioner_ = std::move(multigrid);
  }

  void LinearSolver::solve(Vector &solution, const Vector &right_hand_side)
  {
    if (direct_)
      return direct_->solve(solution, right_hand_side);
    const double size = right_hand_side.l2_norm();
    solution = 0.;
    if (size == 0.)
      return;
    dealii::SolverControl control(parameters_.max_iterations, parameters_.tolerance * size);
    try
      {
        if (parameters_.kind == LinearSolverKind::cg)
          wrappers::SolverCG(control).solve(*matrix_, solution, right_hand_side, *preconditioner_);
        else
          wrappers::SolverGMRES(control, wrappers::SolverGMRES::AdditionalData(false, 100))
              .solve(*matrix_, solution, right_hand_side, *preconditioner_);
      }
    catch (const dealii::ExceptionBase &) // no convergence, or Trilinos found its precision lost: the same on all ranks
      {
        if (parameters_.kind != LinearSolverKind::automatic)
          throw dealii::SolverControl::NoConvergence(control.last_step(), control.last_value());
        ++n_rescues_;
        direct_ = factorise(*matrix_, direct_control_);
        direct_->solve(solution, right_hand_side);
      }
  }
} // namespace fem
