#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace fem
{
  /**
   * A serial HDF5 file of vectors of numbers, in which every call is checked: deal.II's own class checks by assertions
   * that a release build leaves out, and a full disk or a truncated file must not pass unseen. Errors are
   * std::runtime_error naming file and dataset.
   */
  class Hdf5File
  {
  public:
    enum class Mode
    {
      create,
      append,
      read
    };

    Hdf5File(const std::string &file, Mode mode);
    ~Hdf5File();
    Hdf5File(const Hdf5File &) = delete;
    Hdf5File &operator=(const Hdf5File &) = delete;

    /** @param name  path such as "/macro/time"; missing groups are made @param unit  attribute of the dataset, "1" if
     * none */
    void write(const std::string &name, const std::vector<double> &values, const std::string &unit);

    std::vector<double> read(const std::string &name) const;

    /** True if there is a dataset of this path, all of whose groups exist. */
    bool has(const std::string &name) const;

    /** As read(); another length than the expected one is an error. */
    std::vector<double> read(const std::string &name, std::size_t length) const;

    /** Flushes and closes; throws where the destructor could only be silent. */
    void close();

  private:
    [[noreturn]] void fail(const std::string &name, const std::string &cause) const;

    std::string file_;
    std::int64_t handle_ = -1;
  };

  /**
   * Renames FILE.tmp to FILE after both have reached the disk. Throws std::runtime_error with path and cause.
   *
   * @param previous  name that the FILE of before gets; empty: it is replaced. Where the file system knows second
   * names, FILE exists at any moment.
   */
  void publish_file(const std::string &file, const std::string &previous = "");
} // namespace fem
