#pragma once

#include "fem/constitutive_model.h"

#include <deal.II/base/mpi.h>

#include <functional>
#include <map>
#include <span>
#include <vector>

namespace coupling
{
  using fem::PointId;

  /**
   * Which REV lives on which rank, and the way of questions to it and of answers back.
   *
   * REVs are dealt out to the ranks like cards, in the order of their numbers, whatever rank the mesh gave their points
   * to. Questions and answers are rows of plain numbers. Nothing that comes out depends on the number of ranks or
   * threads: answers are assembled in the order of the questions, sums over points in the order of their numbers.
   *
   * All members that communicate are collective. What is thrown on one rank is thrown on all.
   */
  class RevPool
  {
  public:
    /**
     * @param communicator    the ranks that share the REVs
     * @param is_replicated   true: every rank holds the whole mesh and asks the same; false: each rank asks for its
     * part
     * @param n_threads       of each rank, >= 1
     */
    RevPool(MPI_Comm communicator, bool is_replicated, unsigned int n_threads);

    /** Deals out the points of all ranks. @param introduced  those of this rank's part of the mesh, in any order */
    void set_points(const std::vector<PointId> &introduced);

    /** All points, ascending. */
    const std::vector<PointId> &get_points() const { return points_; }

    /** Those whose REVs live here, ascending. */
    const std::vector<PointId> &get_local_points() const { return local_points_; }

    /** Place of a point among all. */
    std::size_t get_index(PointId id) const { return index_.at(id); }
    unsigned int get_owner(PointId id) const { return get_index(id) % n_ranks_; }

    unsigned int get_rank() const { return rank_; }
    unsigned int get_n_ranks() const { return n_ranks_; }
    MPI_Comm get_communicator() const { return communicator_; }

    /** Some points and a row of numbers for each. */
    struct Questions
    {
      std::span<const PointId> ids;
      std::vector<double> rows; ///< ids.size() rows of n_columns
      std::size_t n_columns = 0;
    };

    /** Fills the answer to one question; runs where the REV lives, for several points at a time. */
    using Responder = std::function<void(PointId, std::span<const double> question, std::span<double> answer)>;

    /** Answers to this rank's questions, one row of n_columns each, in their order. */
    std::vector<double> ask(const Questions &questions, std::size_t n_columns, const Responder &respond) const;

    /** One row of n_columns for every point, in the order of get_points(), known to all ranks. */
    std::vector<double> collect(std::size_t n_columns,
                                const std::function<void(PointId, std::span<double>)> &respond) const;

    /** Runs the work once for each REV that lives here. */
    void for_each_local(const std::function<void(PointId)> &work) const;

    /** Runs something on every rank; if it throws on one, all throw the first such rank's message. */
    void agree(const std::function<void()> &work) const;

    /** Wall time that this rank has spent inside REVs, and in all calls with waiting for others [s]. */
    double get_working_time() const { return working_s_; }
    double get_total_time() const { return total_s_; }

  private:
    std::vector<double> answer_all(const Questions &questions, std::size_t n_columns, const Responder &respond) const;
    Questions gather(const Questions &questions, std::vector<PointId> &ids) const;
    void run_threads(std::size_t n, const std::function<void(std::size_t)> &work) const;

    MPI_Comm communicator_;
    bool is_replicated_;
    unsigned int n_threads_, n_ranks_, rank_;
    std::vector<PointId> points_, local_points_;
    std::map<PointId, std::size_t> index_;
    mutable double working_s_ = 0., total_s_ = 0.; // measurements: no result depends on them
  };

  /** Rows of several ranks put together in the order of the ranks. Collective. */
  std::vector<double> gather_rows(const std::vector<double> &rows, MPI_Comm communicator);
} // namespace coupling
