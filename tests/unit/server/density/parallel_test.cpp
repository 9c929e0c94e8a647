#include "server/density/parallel.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <stdexcept>
#include <vector>

namespace kinship::density::parallel_test {
namespace {

TEST(ForEachPart, DoesEachPartOnce) {
  for (const int threads : {1, 2, 5}) {
    std::vector<std::atomic<int>> done(100);
    for_each_part(threads, 100, [&](int part) { ++done[static_cast<std::size_t>(part)]; });
    for (const auto& count : done)
      EXPECT_EQ(count, 1);
  }
  for_each_part(3, 0, [](int /*part*/) { FAIL(); });
}

TEST(ForEachPart, ThrowsWhatTheFirstFailingPartThrew) {
  for (const int threads : {1, 4}) {
    std::atomic<int> done = 0;
    try {
      for_each_part(threads, 50, [&](int part) {
        ++done;
        if (part == 7 || part == 30)
          throw std::runtime_error("part " + std::to_string(part));
      });
      FAIL();
    } catch (const std::runtime_error& error) {
      EXPECT_STREQ(error.what(), "part 7");
    }
    EXPECT_EQ(done, 50);
  }
}

}  // namespace
}  // namespace kinship::density::parallel_test
