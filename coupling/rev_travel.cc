#include "coupling/rev_travel.h"

#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <type_traits>

namespace coupling
{
  namespace
  {
    static_assert(std::is_trivially_copyable_v<dem::Fracture>);

    void append(const std::span<const std::byte> part, std::vector<std::byte> &bytes)
    {
      const std::uint64_t length = part.size();
      const auto *const head = reinterpret_cast<const std::byte *>(&length);
      bytes.insert(bytes.end(), head, head + sizeof(length));
      bytes.insert(bytes.end(), part.begin(), part.end());
    }

    std::span<const std::byte> take(std::span<const std::byte> &bytes)
    {
      std::uint64_t length = 0;
      if (bytes.size() < sizeof(length))
        throw std::runtime_error("a REV that changed its rank came without its end");
      std::memcpy(&length, bytes.data(), sizeof(length));
      bytes = bytes.subspan(sizeof(length));
      if (bytes.size() < length)
        throw std::runtime_error("a REV that changed its rank came without its end");
      const auto part = bytes.first(length);
      bytes = bytes.subspan(length);
      return part;
    }
  } // namespace

  std::vector<std::byte> pack_rev(const dem::Rev &rev)
  {
    const std::vector<std::byte> committed = dem::serialise(rev.get_committed());
    std::vector<std::byte> baseline = dem::serialise(rev.get_baseline());
    if (baseline == committed) // between steps: once is enough
      baseline.clear();
    std::vector<std::byte> bytes;
    append(committed, bytes);
    append(baseline, bytes);
    append(std::as_bytes(std::span(rev.get_baseline().fractures)), bytes);
    return bytes;
  }

  std::unique_ptr<dem::Rev> unpack_rev(const dem::RevModel &model, std::span<const std::byte> bytes)
  {
    const dem::RevState committed = dem::deserialise(take(bytes));
    const auto own = take(bytes), fractures = take(bytes);
    dem::RevState baseline = own.empty() ? committed : dem::deserialise(own);
    baseline.fractures.resize(fractures.size() / sizeof(dem::Fracture));
    std::memcpy(baseline.fractures.data(), fractures.data(), fractures.size());
    return std::make_unique<dem::Rev>(model, committed, baseline);
  }
} // namespace coupling
