#include "dem/snapshot.h"

#include "dem/checksum.h"

#include <hdf5.h>

#include <fcntl.h>
#include <unistd.h>

#include <cassert>
#include <cerrno>
#include <cstdio>
#include <filesystem>
#include <stdexcept>
#include <unordered_map>

namespace dem
{
  namespace
  {
    constexpr std::uint64_t format_version = 1;
    const std::string format_name = "slowsand-rev";

    // What a file needs beside its numbers: headers, attributes, heaps of strings.
    constexpr std::size_t metadata_size = 256 * 1024;

    [[noreturn]] void fail(const std::string &file, const std::string &what, const std::string &cause)
    {
      throw std::runtime_error(file + ": " + what + ": " + cause);
    }

    [[noreturn]] void fail_with_errno(const std::string &file, const std::string &what, const int error = errno)
    {
      fail(file, what, std::generic_category().message(error));
    }

    /** A file of the operating system, closed at the end. */
    class Descriptor
    {
    public:
      Descriptor(const std::string &file, const int flags) : value_(::open(file.c_str(), flags, 0666))
      {
        if (value_ < 0)
          fail_with_errno(file, "cannot open");
      }
      ~Descriptor() { ::close(value_); }
      Descriptor(const Descriptor &) = delete;
      Descriptor &operator=(const Descriptor &) = delete;
      operator int() const { return value_; }

    private:
      int value_;
    };

    /**
     * Takes the room on the disk before HDF5 writes: a full disk shows here, with its cause, and not inside HDF5, which
     * then can neither write nor close. HDF5 gives back what it does not need.
     */
    void reserve_room(const std::string &file, const std::size_t n_bytes)
    {
      const Descriptor descriptor(file, O_WRONLY | O_CREAT);
      const off_t size = ::lseek(descriptor, 0, SEEK_END);
      const int error = ::posix_fallocate(descriptor, size, static_cast<off_t>(n_bytes + metadata_size));
      if (error == 0)
        return;
      if (::ftruncate(descriptor, size) != 0)
        fail_with_errno(file, "cannot give room back");
      fail_with_errno(file, "cannot write", error);
    }

    /** Keeps HDF5 from printing its errors as long as it lives. */
    class Silence
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

    herr_t keep_description(unsigned, const H5E_error2_t *error, void *text)
    {
      *static_cast<std::string *>(text) = error->desc ? error->desc : "";
      return 1; // the innermost is enough
    }

    std::string describe_hdf5_error()
    {
      std::string text;
      H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, keep_description, &text);
      return text.empty() ? "HDF5 gives no reason" : text;
    }

    /** Something of HDF5's, closed at the end. */
    class Handle
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

    struct Shape
    {
      std::size_t rows = 0;
      std::size_t columns = 1; ///< 1: a list, not a table
    };

    constexpr std::size_t any_number = static_cast<std::size_t>(-1);

    /** An open HDF5 file whose every failure is an exception that names file and dataset. */
    class File
    {
    public:
      File(const std::string &name, const bool is_to_write)
        : name_(name), file_(open(name, is_to_write ? H5F_ACC_RDWR : H5F_ACC_RDONLY), H5Fclose)
      {}

      template <typename T>
      void write(const std::string &path, const std::vector<T> &values, const Shape &shape, const std::string &unit)
      {
        assert(values.size() == shape.rows * shape.columns);
        const hsize_t sizes[2] = {shape.rows, shape.columns};
        const Handle space(H5Screate_simple(shape.columns > 1 ? 2 : 1, sizes, nullptr), H5Sclose);
        const Handle dataset = create_dataset(path, get_type<T>(), space);
        require(H5Dwrite(dataset, get_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
        write_attribute(path, "unit", unit);
      }

      template <typename T>
      std::vector<T> read(const std::string &path, const Shape &shape) const
      {
        const Handle dataset = open_dataset(path);
        const Handle space(H5Dget_space(dataset), H5Sclose);
        hsize_t sizes[2] = {0, 1};
        const int n_dimensions = H5Sget_simple_extent_ndims(space);
        if (n_dimensions != (shape.columns > 1 ? 2 : 1))
          fail(name_, path, "wrong number of dimensions, " + std::to_string(n_dimensions));
        H5Sget_simple_extent_dims(space, sizes, nullptr);
        if (sizes[1] != shape.columns || (shape.rows != any_number && sizes[0] != shape.rows))
          fail(name_, path, "wrong size, " + std::to_string(sizes[0]) + " by " + std::to_string(sizes[1]));
        std::vector<T> values(sizes[0] * sizes[1]);
        require(H5Dread(dataset, get_type<T>(), H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()), path);
        return values;
      }

      void write_text(const std::string &path, const std::string &text)
      {
        const Handle type = make_string_type(), space(H5Screate(H5S_SCALAR), H5Sclose);
        const Handle dataset = create_dataset(path, type, space);
        const char *characters = text.c_str();
        require(H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &characters), path);
        write_attribute(path, "unit", "-");
      }

      std::string read_text(const std::string &path) const
      {
        const Handle dataset = open_dataset(path), type = make_string_type();
        char *characters = nullptr;
        require(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, &characters), path);
        return take_text(characters);
      }

      template <typename T>
      void write_attribute(const std::string &path, const std::string &name, const T &value)
      {
        const Handle space(H5Screate(H5S_SCALAR), H5Sclose);
        const auto write = [&](const hid_t type, const void *data) {
          const Handle attribute(H5Acreate_by_name(file_, path.c_str(), name.c_str(), type, space, H5P_DEFAULT,
                                                   H5P_DEFAULT, H5P_DEFAULT),
                                 H5Aclose);
          require(attribute, path + " attribute " + name);
          require(H5Awrite(attribute, type, data), path + " attribute " + name);
        };
        if constexpr (std::is_arithmetic_v<T>)
          write(get_type<T>(), &value);
        else
          {
            const char *characters = std::string_view(value).data();
            write(make_string_type(), &characters);
          }
      }

      template <typename T>
      T read_attribute(const std::string &path, const std::string &name) const
      {
        const std::string what = path + " attribute " + name;
        const Handle attribute(H5Aopen_by_name(file_, path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        if (attribute < 0)
          fail(name_, what, "missing");
        const Handle space(H5Aget_space(attribute), H5Sclose);
        if (H5Sget_simple_extent_npoints(space) != 1)
          fail(name_, what, "not a single value");
        if constexpr (std::is_arithmetic_v<T>)
          {
            T value{};
            require(H5Aread(attribute, get_type<T>(), &value), what);
            return value;
          }
        else
          {
            char *characters = nullptr;
            require(H5Aread(attribute, make_string_type(), &characters), what);
            return take_text(characters);
          }
      }

      /** Hands everything to the operating system; errors that a destructor would swallow show here. */
      void flush() { require(H5Fflush(file_, H5F_SCOPE_GLOBAL), "cannot flush"); }

      const std::string &name() const { return name_; }

    private:
      static hid_t open(const std::string &name, const unsigned int mode)
      {
        if (!std::filesystem::exists(name))
          fail(name, "cannot open", "no such file");
        if (::access(name.c_str(), mode == H5F_ACC_RDONLY ? R_OK : R_OK | W_OK) != 0)
          fail_with_errno(name, "cannot open");
        if (H5Fis_hdf5(name.c_str()) <= 0)
          fail(name, "foreign", "not an HDF5 file");
        const hid_t file = H5Fopen(name.c_str(), mode, H5P_DEFAULT);
        if (file < 0)
          fail(name, "cannot open", describe_hdf5_error());
        return file;
      }

      static Handle make_string_type()
      {
        const hid_t type = H5Tcopy(H5T_C_S1);
        H5Tset_size(type, H5T_VARIABLE);
        H5Tset_cset(type, H5T_CSET_UTF8);
        return {type, H5Tclose};
      }

      static std::string take_text(char *characters)
      {
        const std::string text = characters == nullptr ? "" : characters;
        H5free_memory(characters);
        return text;
      }

      bool has(const std::string &path) const
      {
        for (std::size_t end = path.find('/', 1); end != std::string::npos; end = path.find('/', end + 1))
          if (H5Lexists(file_, path.substr(0, end).c_str(), H5P_DEFAULT) <= 0)
            return false;
        return H5Lexists(file_, path.c_str(), H5P_DEFAULT) > 0;
      }

      Handle create_dataset(const std::string &path, const hid_t type, const hid_t space)
      {
        if (has(path))
          require(H5Ldelete(file_, path.c_str(), H5P_DEFAULT), path);
        const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
        H5Pset_create_intermediate_group(links, 1);
        const hid_t dataset = H5Dcreate2(file_, path.c_str(), type, space, links, H5P_DEFAULT, H5P_DEFAULT);
        require(dataset, path);
        return {dataset, H5Dclose};
      }

      Handle open_dataset(const std::string &path) const
      {
        if (!has(path))
          fail(name_, path, "missing");
        const hid_t dataset = H5Dopen2(file_, path.c_str(), H5P_DEFAULT);
        require(dataset, path);
        return {dataset, H5Dclose};
      }

      void require(const hid_t outcome, const std::string &what) const
      {
        if (outcome < 0)
          fail(name_, what, describe_hdf5_error());
      }

      std::string name_;
      Silence silence_; // outlives the file: closing may complain too
      Handle file_;
    };
