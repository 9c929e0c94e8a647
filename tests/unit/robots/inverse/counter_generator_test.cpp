#include "robots/inverse/counter_generator.hpp"

#include <gtest/gtest.h>

#include <set>

namespace kinship::inverse::counter_generator_test {
namespace {

TEST(CounterGenerator, EqualSeedAndPoseGiveEqualNumbers) {
  const Eigen::Isometry3d pose(Eigen::Translation3d(0.1, 0.2, 0.3));
  CounterGenerator a(7, pose), b(7, pose);
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(a.next(), b.next());
}

TEST(CounterGenerator, NegativeZeroIsZero) {
  const Eigen::Isometry3d plus(Eigen::Translation3d(0.0, 1, 1));
  const Eigen::Isometry3d minus(Eigen::Translation3d(-0.0, 1, 1));
  EXPECT_EQ(CounterGenerator(1, plus).next(), CounterGenerator(1, minus).next());
}

TEST(CounterGenerator, NeighbouringSeedsAndPosesDiffer) {
  std::set<std::uint64_t> firsts;
  for (std::uint64_t seed = 0; seed < 100; ++seed)
    for (int step = 0; step < 10; ++step) {
      const Eigen::Isometry3d pose(Eigen::Translation3d(1e-15 * step, 0, 0));
      firsts.insert(CounterGenerator(seed, pose).next());
    }
  EXPECT_EQ(firsts.size(), 1000U);
}

TEST(CounterGenerator, UniformFillsTheUnitInterval) {
  CounterGenerator generator(3);
  double sum = 0;
  double squares = 0;
  constexpr int kCount = 100000;
  for (int i = 0; i < kCount; ++i) {
    const double u = generator.uniform();
    ASSERT_GE(u, 0);
    ASSERT_LT(u, 1);
    sum += u;
    squares += u * u;
  }
  EXPECT_NEAR(sum / kCount, 0.5, 0.005);
  EXPECT_NEAR(squares / kCount, 1.0 / 3, 0.005);
}

}  // namespace
}  // namespace kinship::inverse::counter_generator_test
