#pragma once

#include <concepts>
#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace apps
{
  /** One row of a history, value by value. */
  class HistoryRow
  {
  public:
    HistoryRow &
    add(double value); ///< ten significant digits: more would record rounding, and they are the same each time
    HistoryRow &add(std::string_view text);

    template <std::integral Integer>
    HistoryRow &add(Integer value)
    {
      return add(std::string_view(std::to_string(value)));
    }

    const std::string &get_text() const { return text_; }
    std::size_t get_n_values() const { return n_values_; }

  private:
    std::string text_;
    std::size_t n_values_ = 0;
  };

  /**
   * A history.csv that grows by whole rows, each handed to the system before the program goes on.
   *
   * Every member throws std::runtime_error with path and cause when the file cannot be written (no space).
   */
  class HistoryFile
  {
  public:
    /** Starts a new file with its header. */
    HistoryFile(const std::string &file, const std::vector<std::string> &columns);

    /**
     * Goes on with a file after cutting it back: rows from the first for which `keep` says no, or that is not whole,
     * are dropped. Throws BadInput if the header is another one.
     *
     * @param keep  says of a row's values whether it happened before the checkpoint
     */
    HistoryFile(const std::string &file, const std::vector<std::string> &columns,
                const std::function<bool(const std::vector<std::string> &)> &keep);

    ~HistoryFile();
    HistoryFile(const HistoryFile &) = delete;
    HistoryFile &operator=(const HistoryFile &) = delete;

    /** @pre as many values as columns */
    void write(const HistoryRow &row);

    /** Length so far [bytes]. */
    std::uint64_t get_n_bytes() const { return n_bytes_; }

  private:
    void open(int flags);
    void append(const std::string &text);
    [[noreturn]] void fail() const;

    std::string file_;
    std::size_t n_columns_;
    int descriptor_ = -1;
    std::uint64_t n_bytes_ = 0;
  };

  /** PREFIX_xx SUFFIX ... in the order of all our tables: xx, yy, zz, xy, yz, xz. */
  std::vector<std::string> name_tensor_columns(const std::string &prefix, const std::string &suffix);
} // namespace apps
