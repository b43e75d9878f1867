// Law: a constant stays what was written. gcc 12.2 for AVX-512 turns {a, a, a, 0} into {a, a, a, a} when it copies 32
// bytes in one piece; the build forbids such pieces, and this test says so if it forgets.

#include <gtest/gtest.h>

#include <array>
#include <vector>

namespace
{
  struct Written
  {
    std::vector<double> values = {100e3, 100e3, 100e3, 0., 0., 0.};
  };

  [[gnu::noinline]] void fill(Written &written)
  {
    written = Written();
  }
} // namespace

TEST(Compiler, KeepsAConstantWithEqualHeadAndZeroTail)
{
  Written written;
  fill(written);
  const std::array<double, 6> expected = {{1e5, 1e5, 1e5, 0., 0., 0.}};
  for (std::size_t i = 0; i < expected.size(); ++i)
    EXPECT_EQ(written.values[i], expected[i]) << i; // exact: nothing is computed
}
