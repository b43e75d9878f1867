#include "dem/snapshot.h"

#include <hdf5.h>

#include <fcntl.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <system_error>
#include <type_traits>

namespace dem
{
  namespace
  {
    static_assert(sizeof(hid_t) == sizeof(std::int64_t));

    // What a file needs beside its numbers: headers, attributes, heaps of strings.
    constexpr std::size_t metadata_size = 256 * 1024;

    [[noreturn]] void fail(const std::string &file, const std::string &what, const std::string &cause)
    {
      throw std::runtime_error(file + ": " + what + ": " + cause);
    }

    [[noreturn]] void fail_with_errno(const std::string &file, const std::string &what, const int error)
    {
      fail(file, what, std::generic_category().message(error));
    }

    /** A file or folder of the operating system, closed at the end. */
    class Descriptor
    {
    public:
      Descriptor(const std::string &file, const int flags) : value_(::open(file.c_str(), flags, 0666))
      {
        if (value_ < 0)
          fail_with_errno(file, "cannot open", errno);
      }
      ~Descriptor() { ::close(value_); }
      Descriptor(const Descriptor &) = delete;
      Descriptor &operator=(const Descriptor &) = delete;
      operator int() const { return value_; }

    private:
      int value_;
    };

    void reserve_room(const std::string &file, const std::size_t n_bytes)
    {
      const Descriptor descriptor(file, O_WRONLY);
      const off_t size = ::lseek(descriptor, 0, SEEK_END);
      const int error = ::posix_fallocate(descriptor, size, static_cast<off_t>(n_bytes + metadata_size));
      if (error == 0)
        return;
      if (::ftruncate(descriptor, size) != 0)
        fail_with_errno(file, "cannot give room back", errno);
      fail_with_errno(file, "cannot write", error);
    }

    herr_t keep_description(unsigned, const H5E_error2_t *error, void *text)
    {
      *static_cast<std::string *>(text) = error->desc ? error->desc : "";
      return 1; // the innermost is enough
    }

    std::string describe_error()
    {
      std::string text;
      H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_description, &text);
      return text.empty() ? "HDF5 gives no reason" : text;
    }

    template <typename T>
    hid_t get_type()
    {
      if constexpr (std::is_same_v<T, double>)
        return H5T_NATIVE_DOUBLE;
      else if constexpr (std::is_same_v<T, std::uint64_t>)
        return H5T_NATIVE_UINT64;
      else if constexpr (std::is_same_v<T, std::int64_t>)
        return H5T_NATIVE_INT64;
      else if constexpr (std::is_same_v<T, std::uint32_t>)
        return H5T_NATIVE_UINT32;
      else
        return H5T_NATIVE_UINT8;
    }

    /** Takes over a string that HDF5 allocated. */
    std::string take_text(char *characters)
    {
      const std::string text = characters == nullptr ? "" : characters;
      H5free_memory(characters);
      return text;
    }
  } // namespace

  /** Keeps HDF5 from printing its errors as long as it lives. */
  class Hdf5File::Silence
  {
  public:
    Silence()
    {
      H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
      H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    ~Silence() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }
    Silence(const Silence &) = delete;
    Silence &operator=(const Silence &) = delete;

  private:
    H5E_auto2_t function_ = nullptr;
    void *data_ = nullptr;
  };

  /** Something of HDF5's, closed at the end. */
  class Hdf5File::Handle
  {
  public:
    using Close = herr_t (*)(hid_t);
    Handle(const hid_t id, const Close close) : id_(id), close_(close) {}
    ~Handle()
    {
      if (id_ >= 0)
        close_(id_);
    }
    Handle(const Handle &) = delete;
    Handle &operator=(const Handle &) = delete;
    operator hid_t() const { return id_; }

  private:
    hid_t id_;
    Close close_;
  };

  Hdf5File::Hdf5File(const std::string &name) : name_(name)
  {
    open(false, 0);
  }

  Hdf5File::Hdf5File(const std::string &name, const std::size_t room) : name_(name)
  {
    open(true, room);
  }

  void Hdf5File::open(const bool is_to_write, const std::size_t room)
  {
    const Silence silence;
    if (::access(name_.c_str(), is_to_write ? R_OK | W_OK : R_OK) != 0)
      fail_with_errno(name_, "cannot open", errno);
    if (std::filesystem::is_directory(name_) || H5Fis_hdf5(name_.c_str()) <= 0)
      fail(name_, "foreign", "not an HDF5 file");
    if (is_to_write)
      reserve_room(name_, room);
    file_ = H5Fopen(name_.c_str(), is_to_write ? H5F_ACC_RDWR : H5F_ACC_RDONLY, H5P_DEFAULT);
    require(file_, "cannot open");
  }

  Hdf5File::~Hdf5File()
  {
    const Silence silence;
    H5Fclose(file_);
  }

  void Hdf5File::require(const std::int64_t outcome, const std::string &what) const
  {
    if (outcome < 0)
      fail(name_, what, describe_error());
  }

  bool Hdf5File::has(const std::string &path) const
  {
    for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1))
      if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0)
        return false;
    return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
  }

  Hdf5File::Handle Hdf5File::create_dataset(const std::string &path, const std::int64_t type, const std::int64_t space)
  {
    if (has(path))
      require(H5Ldelete(file_, path.c_str(), H5P_DEFAULT), path);
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    H5Pset_create_intermediate_group(links, 1);
    const hid_t dataset = H5Dcreate2(file_, path.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT);
    require(dataset, path);
    return {dataset, H5Dclose};
  }

  Hdf5File::Handle Hdf5File::open_dataset(const std::string &path) const
  {
    if (!has(path))
      fail(name_, path, "missing");
    const hid_t dataset = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
    require(dataset, path);
    return {dataset, H5Dclose};
  }

  Hdf5File::Handle Hdf5File::make_string_type()
  {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    return {type, H5Tclose};
  }

  template <typename T>
  void Hdf5File::write(const std::string &path, const std::vector<T> &values, const Shape &shape,
                       const std::string &unit)
  {
    assert(values.size() == shape.rows * shape.columns);
    const Silence silence;
    const hsize_t sizes[2] = {shape.rows, shape.columns};
    {
      const Handle space(H5Screate_simple(shape.columns > 1 ? 2 : 1, sizes, nullptr), H5Sclose);
      const Handle dataset = create_dataset(path, get_type<T>(), space);
      require(H5Dwrite(dataset, get_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
    }
    write_attribute(path, "unit", unit);
  }

  template <typename T>
  std::vector<T> Hdf5File::read(const std::string &path, const Shape &shape) const
  {
    const Silence silence;
    const Handle dataset = open_dataset(path);
    const Handle space(H5Dget_space(dataset), H5Sclose);
    const int n_dimensions = H5Sget_simple_extent_ndims(space);
    if (n_dimensions != (shape.columns > 1 ? 2 : 1))
      fail(name_, path, "wrong number of dimensions, " + std::to_string(n_dimensions));
    hsize_t sizes[2] = {0, 1};
    H5Sget_simple_extent_dims(space, sizes, nullptr);
    if (sizes[1] != shape.columns || (shape.rows != any_number && sizes[0] != shape.rows))
      fail(name_, path,
           "wrong size, " + std::to_string(sizes[0]) + " by " + std::to_string(sizes[1]) + " instead of " +
               (shape.rows == any_number ? "any number" : std::to_string(shape.rows)) + " by " +
               std::to_string(shape.columns));
    std::vector<T> values(sizes[0] * sizes[1]);
    require(H5Dread(dataset, get_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
    return values;
  }

  void Hdf5File::write_text(const std::string &path, const std::string &text)
  {
    const Silence silence;
    {
      const Handle type = make_string_type();
      const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
      const Handle dataset = create_dataset(path, type, space);
      const char *characters = text.c_str();
      require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &characters), path);
    }
    write_attribute(path, "unit", std::string("-"));
  }

  std::string Hdf5File::read_text(const std::string &path) const
  {
    const Silence silence;
    const Handle dataset = open_dataset(path);
    const Handle space(H5Dget_space(dataset), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 1)
      fail(name_, path, "not a single text");
    const Handle type = make_string_type();
    char *characters = nullptr;
    require(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &characters), path);
    return take_text(characters);
  }

  template <typename T>
  void Hdf5File::write_attribute(const std::string &path, const std::string &name, const T &value)
  {
    const Silence silence;
    const std::string what = path + " attribute " + name;
    const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
    const auto write_value = [&](const hid_t type, const void *data) {
      const Handle attribute(
          H5Acreate_by_name(file_, path.c_str(), name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT),
          H5Aclose);
      require(attribute, what);
      require(H5Awrite(attribute, type, data), what);
    };
    if constexpr (std::is_same_v<T, std::string>)
      {
        const char *characters = value.c_str();
        write_value(make_string_type(), &characters);
      }
    else
      write_value(get_type<T>(), &value);
  }

  template <typename T>
  T Hdf5File::read_attribute(const std::string &path, const std::string &name) const
  {
    const Silence silence;
    const std::string what = path + " attribute " + name;
    if (path != "/" && !has(path))
      fail(name_, path, "missing");
    const Handle attribute(H5Aopen_by_name(file_, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    if (attribute < 0)
      fail(name_, what, "missing");
    const Handle space(H5Aget_space(attribute), H5Sclose);
    if (H5Sget_simple_extent_npoints(space) != 1)
      fail(name_, what, "not a single value");
    if constexpr (std::is_same_v<T, std::string>)
      {
        char *characters = nullptr;
        require(H5Aread(attribute, make_string_type(), &characters), what);
        return take_text(characters);
      }
    else
      {
        T value{};
        require(H5Aread(attribute, get_type<T>(), &value), what);
        return value;
      }
  }

  void Hdf5File::flush()
  {
    const Silence silence;
    require(H5Fflush(file_, H5F_SCOPE_GLOBAL), "cannot flush");
  }

  template void Hdf5File::write(const std::string &, const std::vector<double> &, const Shape &, const std::string &);
  template void Hdf5File::write(const std::string &, const std::vector<std::uint64_t> &, const Shape &,
                                const std::string &);
  template void Hdf5File::write(const std::string &, const std::vector<std::int64_t> &, const Shape &,
                                const std::string &);
  template void Hdf5File::write(const std::string &, const std::vector<std::uint32_t> &, const Shape &,
                                const std::string &);
  template void Hdf5File::write(const std::string &, const std::vector<std::uint8_t> &, const Shape &,
                                const std::string &);
  template std::vector<double> Hdf5File::read(const std::string &, const Shape &) const;
  template std::vector<std::uint64_t> Hdf5File::read(const std::string &, const Shape &) const;
  template std::vector<std::int64_t> Hdf5File::read(const std::string &, const Shape &) const;
  template std::vector<std::uint32_t> Hdf5File::read(const std::string &, const Shape &) const;
  template std::vector<std::uint8_t> Hdf5File::read(const std::string &, const Shape &) const;
  template void Hdf5File::write_attribute(const std::string &, const std::string &, const double &);
  template void Hdf5File::write_attribute(const std::string &, const std::string &, const std::uint64_t &);
  template void Hdf5File::write_attribute(const std::string &, const std::string &, const std::string &);
  template double Hdf5File::read_attribute(const std::string &, const std::string &) const;
  template std::uint64_t Hdf5File::read_attribute(const std::string &, const std::string &) const;
  template std::string Hdf5File::read_attribute(const std::string &, const std::string &) const;

  void create_hdf5_file(const std::string &name)
  {
    {
      const Descriptor empty(name, O_WRONLY | O_CREAT | O_TRUNC);
    }
    reserve_room(name, 0);
    const hid_t file = H5Fcreate(name.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    if (file < 0 || H5Fclose(file) < 0)
      fail(name, "cannot create", describe_error());
  }

  void flush_and_rename(const std::string &temporary, const std::string &file)
  {
    if (::fsync(Descriptor(temporary, O_RDONLY)) != 0)
      fail_with_errno(temporary, "cannot write", errno);
    if (std::rename(temporary.c_str(), file.c_str()) != 0)
      fail_with_errno(file, "cannot rename " + temporary, errno);
    // The new name is safe only when its folder is.
    const std::filesystem::path folder = std::filesystem::absolute(file).parent_path();
    if (::fsync(Descriptor(folder.string(), O_RDONLY | O_DIRECTORY)) != 0)
      fail_with_errno(folder.string(), "cannot write", errno);
  }
} // namespace dem
