#include "fem/hdf5_file.h"

#include <fmt/format.h>

#include <hdf5.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <filesystem>
#include <stdexcept>
#include <unistd.h>

namespace fem
{
  namespace
  {
    /** An HDF5 identifier with the function that closes it. */
    class Handle
    {
    public:
      Handle(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
      ~Handle()
      {
        if (id_ >= 0)
          close_(id_);
      }
      Handle(const Handle &) = delete;
      Handle &operator=(const Handle &) = delete;
      bool is_valid() const { return id_ >= 0; }
      operator hid_t() const { return id_; }

    private:
      hid_t id_;
      herr_t (*close_)(hid_t);
    };

    void sync_to_disk(const std::string &path, int flags)
    {
      const int descriptor = ::open(path.c_str(), flags);
      const bool is_synced = descriptor >= 0 && ::fsync(descriptor) == 0;
      const int cause = errno;
      if (descriptor >= 0)
        ::close(descriptor);
      if (!is_synced)
        throw std::runtime_error(fmt::format("{}: {}", path, std::strerror(cause)));
    }

    /** Gives a file a second name, in the place of whatever had it; the only one where there can be no second. */
    void keep_as(const std::string &file, const std::string &name)
    {
      const std::string unfinished = name + ".tmp"; // links do not replace, renaming does
      std::remove(unfinished.c_str());
      const bool has_two = ::link(file.c_str(), unfinished.c_str()) == 0;
      if (std::rename(has_two ? unfinished.c_str() : file.c_str(), name.c_str()) != 0)
        throw std::runtime_error(fmt::format("{}: {}", name, std::strerror(errno)));
    }
  } // namespace

  Hdf5File::Hdf5File(const std::string &file, Mode mode) : file_(file)
  {
    H5Eset_auto(H5E_DEFAULT, nullptr, nullptr); // errors are reported by exceptions, not on the console
    errno = 0;
    if (mode == Mode::create)
      handle_ = H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    else
      handle_ = H5Fopen(file.c_str(), mode == Mode::read ? H5F_ACC_RDONLY : H5F_ACC_RDWR, H5P_DEFAULT);
    if (handle_ < 0)
      throw std::runtime_error(fmt::format("{}: cannot be {} as an HDF5 file: {}", file,
                                           mode == Mode::create ? "created" : "opened",
                                           errno != 0 ? std::strerror(errno) : "foreign, damaged or truncated"));
  }

  Hdf5File::~Hdf5File()
  {
    if (handle_ >= 0)
      H5Fclose(handle_);
  }

  void Hdf5File::fail(const std::string &name, const std::string &cause) const
  {
    throw std::runtime_error(fmt::format("{}: dataset {}: {}", file_, name, cause));
  }

  void Hdf5File::write(const std::string &name, const std::vector<double> &values, const std::string &unit)
  {
    errno = 0;
    const hsize_t length = values.size();
    const Handle links(H5Pcreate(H5P_LINK_CREATE), H5Pclose);
    const Handle space(H5Screate_simple(1, &length, nullptr), H5Sclose);
    bool is_written = links.is_valid() && space.is_valid() && H5Pset_create_intermediate_group(links, 1) >= 0;
    const Handle data(H5Dcreate(handle_, name.c_str(), H5T_IEEE_F64LE, space, links, H5P_DEFAULT, H5P_DEFAULT),
                      H5Dclose);
    is_written = is_written && data.is_valid() &&
                 H5Dwrite(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0;

    const Handle scalar(H5Screate(H5S_SCALAR), H5Sclose);
    const Handle text(H5Tcopy(H5T_C_S1), H5Tclose);
    is_written = is_written && H5Tset_size(text, unit.size() + 1) >= 0;
    if (is_written)
      {
        const Handle attribute(H5Acreate(data, "unit", text, scalar, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
        is_written = attribute.is_valid() && H5Awrite(attribute, text, unit.c_str()) >= 0;
      }
    if (!is_written)
      fail(name, errno != 0 ? std::strerror(errno) : "cannot be written");
  }

  std::vector<double> Hdf5File::read(const std::string &name) const
  {
    const Handle data(H5Dopen(handle_, name.c_str(), H5P_DEFAULT), H5Dclose);
    if (!data.is_valid())
      fail(name, "missing");
    const Handle space(H5Dget_space(data), H5Sclose);
    const hssize_t length = space.is_valid() ? H5Sget_simple_extent_npoints(space) : -1;
    if (length < 0)
      fail(name, "has no readable length");
    std::vector<double> values(length);
    if (H5Dread(data, H5T_NATIVE_DOUBLE, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) < 0)
      fail(name, "cannot be read: damaged or truncated, or no numbers");
    return values;
  }

  bool Hdf5File::has(const std::string &name) const
  {
    return H5Lexists(handle_, name.c_str(), H5P_DEFAULT) > 0;
  }

  std::vector<double> Hdf5File::read(const std::string &name, std::size_t length) const
  {
    std::vector<double> values = read(name);
    if (values.size() != length)
      fail(name, fmt::format("holds {} numbers, expected {}", values.size(), length));
    return values;
  }

  void Hdf5File::close()
  {
    errno = 0;
    const bool is_flushed = H5Fflush(handle_, H5F_SCOPE_GLOBAL) >= 0;
    const int cause = errno;
    const bool is_closed = H5Fclose(handle_) >= 0;
    handle_ = -1;
    if (!is_flushed || !is_closed)
      throw std::runtime_error(
          fmt::format("{}: cannot be written: {}", file_, std::strerror(cause != 0 ? cause : errno)));
  }

  void publish_file(const std::string &file, const std::string &previous)
  {
    const std::string temporary = file + ".tmp";
    sync_to_disk(temporary, O_RDONLY);
    if (!previous.empty() && std::filesystem::exists(file))
      keep_as(file, previous);
    if (std::rename(temporary.c_str(), file.c_str()) != 0)
      throw std::runtime_error(fmt::format("{}: {}", file, std::strerror(errno)));
    const std::string folder = std::filesystem::path(file).parent_path().string();
    sync_to_disk(folder.empty() ? "." : folder, O_RDONLY | O_DIRECTORY);
  }
} // namespace fem
