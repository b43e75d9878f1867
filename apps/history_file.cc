#include "apps/history_file.h"

#include "apps/bad_input.h"

#include <fmt/format.h>

#include <cassert>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <unistd.h>

namespace apps
{
  namespace
  {
    std::string join(const std::vector<std::string> &columns)
    {
      return fmt::format("{}\n", fmt::join(columns, ","));
    }

    std::vector<std::string> split(const std::string &line)
    {
      std::vector<std::string> values;
      std::istringstream stream(line);
      for (std::string value; std::getline(stream, value, ',');)
        values.push_back(value);
      return values;
    }

    /** Bytes of the header and of the leading rows to be kept. */
    std::uint64_t find_end_of_kept_rows(const std::string &file, const std::vector<std::string> &columns,
                                        const std::function<bool(const std::vector<std::string> &)> &keep)
    {
      std::ifstream stream(file);
      std::string line;
      const std::string header = join(columns);
      if (!std::getline(stream, line) || line + "\n" != header)
        throw BadInput(fmt::format("{}, line 1: these are not the columns that the parameters ask for", file));
      std::uint64_t end = header.size();
      while (std::getline(stream, line) && !stream.eof()) // a last line without its end was cut off
        {
          const auto values = split(line);
          if (values.size() != columns.size() || !keep(values))
            break;
          end += line.size() + 1;
        }
      return end;
    }
  } // namespace

  HistoryRow &HistoryRow::add(const double value)
  {
    return add(std::string_view(fmt::format("{:.10g}", value == 0. ? 0. : value))); // -0 as 0
  }

  HistoryRow &HistoryRow::add(const std::string_view text)
  {
    if (n_values_++ > 0)
      text_ += ',';
    text_ += text;
    return *this;
  }

  HistoryFile::HistoryFile(const std::string &file, const std::vector<std::string> &columns)
      : file_(file), n_columns_(columns.size())
  {
    open(O_CREAT | O_TRUNC);
    append(join(columns));
  }

  HistoryFile::HistoryFile(const std::string &file, const std::vector<std::string> &columns,
                           const std::function<bool(const std::vector<std::string> &)> &keep)
      : file_(file), n_columns_(columns.size()), n_bytes_(find_end_of_kept_rows(file, columns, keep))
  {
    open(0);
    if (::ftruncate(descriptor_, static_cast<off_t>(n_bytes_)) != 0)
      fail();
  }

  HistoryFile::~HistoryFile()
  {
    if (descriptor_ >= 0)
      ::close(descriptor_);
  }

  void HistoryFile::open(const int flags)
  {
    descriptor_ = ::open(file_.c_str(), O_WRONLY | O_APPEND | O_CLOEXEC | flags, 0666);
    if (descriptor_ < 0)
      fail();
  }

  void HistoryFile::append(const std::string &text)
  {
    for (std::size_t n_written = 0; n_written < text.size();)
      {
        const ssize_t n = ::write(descriptor_, text.data() + n_written, text.size() - n_written);
        if (n < 0 && errno != EINTR)
          fail();
        n_written += n > 0 ? static_cast<std::size_t>(n) : 0;
      }
    n_bytes_ += text.size();
  }

  void HistoryFile::write(const HistoryRow &row)
  {
    assert(row.get_n_values() == n_columns_);
    append(row.get_text() + "\n");
  }

  void HistoryFile::fail() const
  {
    throw std::runtime_error(fmt::format("{}: cannot be written: {}", file_, std::strerror(errno)));
  }

  std::vector<std::string> name_tensor_columns(const std::string &prefix, const std::string &suffix)
  {
    std::vector<std::string> names;
    for (const char *component : {"xx", "yy", "zz", "xy", "yz", "xz"})
      names.push_back(prefix + "_" + component + suffix);
    return names;
  }
} // namespace apps
