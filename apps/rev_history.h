#pragma once

#include "apps/history_file.h"

#include "dem/breakage_measures.h"
#include "dem/laboratory.h"

#include <map>
#include <memory>
#include <string>

namespace apps
{
  /** Rows of each table, by the name of its file. */
  using RowCounts = std::map<std::string, std::uint64_t>;

  /**
   * The tables that a run of slowsand-rev writes, compression-positive, stages counted from 1 (docs/user-guide.md):
   * history.csv, breakage.csv, jumps.csv, fractures.csv. Between walls the last columns of history.csv are the stresses
   * on them.
   *
   * Every member throws std::runtime_error with path and cause when a file cannot be written.
   */
  class RevHistory
  {
  public:
    /** Starts new tables in a folder that is there. */
    RevHistory(const std::string &folder, dem::CellKind kind);

    /** Goes on with tables after cutting them back. Throws BadInput if one is missing or has other columns.
     *  @param kept  rows of each that the checkpoint counts */
    RevHistory(const std::string &folder, dem::CellKind kind, const RowCounts &kept);

    void write(const dem::Observation &observation);

    /** One row, numbered by its place in the table. */
    void write(const dem::DynamicRecord &record);

    /** @param stage  from 0 */
    void write(const dem::Fracture &fracture, std::size_t stage);

    /** @param stage  number that is written: from 1, 0 before the first
     *  @param time  [s] */
    void write(const dem::BreakageMeasures &measures, const dem::Counters &counters, double time, std::size_t stage);

    RowCounts count_rows() const;

  private:
    struct Table
    {
      std::unique_ptr<HistoryFile> file;
      std::uint64_t n_rows = 0;
    };

    void write_row(const std::string &name, const HistoryRow &row);

    const dem::CellKind kind_;
    std::map<std::string, Table> tables_;
  };
} // namespace apps
