#include "fem/file_seal.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstdio>
#include <cstring>
#include <memory>
#include <optional>
#include <stdexcept>
#include <vector>

namespace fem
{
  namespace
  {
    constexpr std::array<char, 8> mark = {'S', 'S', 'S', 'E', 'A', 'L', '0', '1'};

    /** What stands at the end of a sealed file, in the byte order of the machine, as all of the file does. */
    struct Seal
    {
      std::array<char, 8> mark{};
      std::uint64_t length = 0; ///< of the file without its seal [B]
      std::uint64_t checksum = 0;
    };
    static_assert(sizeof(Seal) == 24);

    using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE *)>;

    [[noreturn]] void fail(const std::string &file, const std::string &what)
    {
      throw std::runtime_error(fmt::format("{}: cannot be {}: {}", file, what, std::strerror(errno)));
    }

    Stream open(const std::string &file, const char *mode)
    {
      Stream stream(std::fopen(file.c_str(), mode), std::fclose);
      if (!stream)
        fail(file, "opened");
      return stream;
    }

    std::uint64_t measure_length(std::FILE *stream, const std::string &file)
    {
      if (std::fseek(stream, 0, SEEK_END) != 0)
        fail(file, "read");
      const long length = std::ftell(stream);
      if (length < 0)
        fail(file, "read");
      return static_cast<std::uint64_t>(length);
    }

    /** FNV-1a in words of eight bytes: each step is one to one, so a change within one word always shows. */
    std::uint64_t compute_checksum(std::FILE *stream, const std::uint64_t length, const std::string &file)
    {
      std::uint64_t sum = 0xcbf29ce484222325u;
      std::vector<char> part(1 << 20); // a multiple of the word
      std::rewind(stream);
      for (std::uint64_t at = 0; at < length; at += part.size())
        {
          const std::size_t n = std::min<std::uint64_t>(part.size(), length - at);
          if (std::fread(part.data(), 1, n, stream) != n)
            fail(file, "read");
          for (std::size_t i = 0; i < n; i += sizeof(std::uint64_t))
            {
              std::uint64_t word = 0;
              std::memcpy(&word, part.data() + i, std::min(sizeof(word), n - i));
              sum = (sum ^ word) * 0x100000001b3u;
            }
        }
      return sum;
    }

    std::optional<Seal> read_seal(std::FILE *stream, const std::uint64_t file_length, const std::string &file)
    {
      Seal seal;
      if (file_length < sizeof(seal))
        return std::nullopt;
      if (std::fseek(stream, -static_cast<long>(sizeof(seal)), SEEK_END) != 0 ||
          std::fread(&seal, sizeof(seal), 1, stream) != 1)
        fail(file, "read");
      return seal.mark == mark ? std::optional(seal) : std::nullopt;
    }
  } // namespace

  void seal_file(const std::string &file)
  {
    const Stream stream = open(file, "r+b");
    Seal seal{mark, measure_length(stream.get(), file), 0};
    seal.checksum = compute_checksum(stream.get(), seal.length, file);
    if (std::fseek(stream.get(), 0, SEEK_END) != 0 || std::fwrite(&seal, sizeof(seal), 1, stream.get()) != 1 ||
        std::fflush(stream.get()) != 0)
      fail(file, "written");
  }

  SealState check_seal(const std::string &file)
  {
    const Stream stream = open(file, "rb");
    const std::uint64_t length = measure_length(stream.get(), file);
    const auto seal = read_seal(stream.get(), length, file);
    if (!seal)
      return SealState::missing;
    if (seal->length != length - sizeof(Seal))
      return SealState::damaged;
    return compute_checksum(stream.get(), seal->length, file) == seal->checksum ? SealState::whole : SealState::damaged;
  }
} // namespace fem
