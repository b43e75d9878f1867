#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace dem
{
  /** Length of a list, or rows and columns of a table. */
  struct Shape
  {
    std::size_t rows = 0;
    std::size_t columns = 1; ///< 1: a list, not a table
  };

  /** Rows of a dataset whose length is not known beforehand. */
  inline constexpr std::size_t any_number = static_cast<std::size_t>(-1);

  /**
   * An open HDF5 file whose every failure is a std::runtime_error that names file, dataset and cause; snapshot.cc is
   * the only file that includes HDF5. HDF5 is not thread-safe: one thread at a time.
   *
   * T below is one of double, std::uint64_t, std::int64_t, std::uint32_t, std::uint8_t.
   */
  class Hdf5File
  {
  public:
    /** Opens to read. */
    explicit Hdf5File(const std::string &name);

    /**
     * Opens to write, once the disk has given room for so many bytes [B] more: a full disk shows here, with its cause,
     * and not inside HDF5, which then can neither write nor close. What is not needed is given back.
     */
    Hdf5File(const std::string &name, std::size_t room);

    ~Hdf5File();
    Hdf5File(const Hdf5File &) = delete;
    Hdf5File &operator=(const Hdf5File &) = delete;

    /** Writes a dataset with its attribute `unit`, groups created as needed; replaces one of that name. Tables by rows.
     *  @pre values.size() == rows * columns */
    template <typename T>
    void write(const std::string &path, const std::vector<T> &values, const Shape &shape, const std::string &unit);

    /** Throws as well when the dataset has another shape. */
    template <typename T>
    std::vector<T> read(const std::string &path, const Shape &shape) const;

    void write_text(const std::string &path, const std::string &text);
    std::string read_text(const std::string &path) const;

    /** Attribute of a group or dataset; T may also be std::string. @pre the object has none of that name */
    template <typename T>
    void write_attribute(const std::string &path, const std::string &name, const T &value);
    template <typename T>
    T read_attribute(const std::string &path, const std::string &name) const;

    /** Hands everything to the operating system; errors that closing would swallow show here. */
    void flush();

    const std::string &name() const { return name_; }

    /** True if there is a group or dataset of that name. */
    bool has(const std::string &path) const;

  private:
    class Handle;
    class Silence;

    void open(bool is_to_write, std::size_t room);
    static Handle make_string_type();
    Handle create_dataset(const std::string &path, std::int64_t type, std::int64_t space);
    Handle open_dataset(const std::string &path) const;
    void require(std::int64_t outcome, const std::string &what) const;

    std::string name_;
    std::int64_t file_ = -1;
  };

  /** Creates an empty HDF5 file, replacing one of that name. */
  void create_hdf5_file(const std::string &name);

  /** Flushes a finished file to the disk and gives it its final name. */
  void flush_and_rename(const std::string &temporary, const std::string &file);
} // namespace dem
