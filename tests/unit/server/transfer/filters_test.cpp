#include "server/transfer/filters.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/support/one_by_one.hpp"

namespace kinship::transfer::filters_test {
namespace {

/// Of a configuration of two joints: the first is what `self` judges, the second what `scene` does.
Filters both() {
  return {.self = test::one_by_one([](const auto& q) { return q[0] > 0; }),
          .scene = test::one_by_one([](const auto& q) { return q[1] > 0; })};
}

/// What was kept and counted where each configuration is asked about by itself.
struct OneAfterTheOther {
  Eigen::MatrixXd kept = Eigen::MatrixXd(2, 0);
  std::uint64_t checks = 0, self = 0, scene = 0;

  /// \return whether it is kept.
  bool ask(const Eigen::Vector2d& q) {
    ++checks;
    self += q[0] > 0 ? 0U : 1U;
    scene += q[0] > 0 && q[1] <= 0 ? 1U : 0U;
    if (q[0] <= 0 || q[1] <= 0)
      return false;
    kept.conservativeResize(Eigen::NoChange, kept.cols() + 1);
    kept.rightCols(1) = q;
    return true;
  }
};

void expect_counts(const CountedFilters& counted, const OneAfterTheOther& wanted) {
  EXPECT_EQ(counted.checks(), wanted.checks);
  EXPECT_EQ(counted.self_collisions(), wanted.self);
  EXPECT_EQ(counted.scene_collisions(), wanted.scene);
}

/// Mostly free, so that some run to the end.
Eigen::MatrixXd random_configurations(std::mt19937_64& generator) {
  std::uniform_real_distribution<double> value(-0.2, 1);
  const auto count = static_cast<Eigen::Index>(generator() % 12);
  return Eigen::MatrixXd::NullaryExpr(2, count, [&] { return value(generator); });
}

TEST(CountedFilters, CountTogetherAsTheyWouldOneAfterTheOther) {
  const Filters filters = both();
  CountedFilters counted(filters);
  OneAfterTheOther wanted;
  std::mt19937_64 generator(1);
  for (int i = 0; i < 500; ++i) {
    const Eigen::MatrixXd qs = random_configurations(generator);
    Eigen::Index ahead = 0;
    while (ahead < qs.cols() && wanted.ask(qs.col(ahead)))
      ++ahead;
    EXPECT_EQ(counted.keep_ahead(qs), ahead);
  }
  expect_counts(counted, wanted);
}

TEST(CountedFilters, PassedAreAllThatAreKept) {
  const Filters filters = both();
  CountedFilters counted(filters);
  OneAfterTheOther wanted;
  std::mt19937_64 generator(2);
  for (int i = 0; i < 500; ++i) {
    const Eigen::MatrixXd qs = random_configurations(generator);
    wanted.kept.resize(2, 0);
    for (const auto& q : qs.colwise())
      wanted.ask(q);
    EXPECT_EQ(passed(qs, counted), wanted.kept);
  }
  expect_counts(counted, wanted);
}

TEST(CountedFilters, WithoutFiltersEverythingIsKeptAndNothingCounted) {
  const Filters none;
  CountedFilters counted(none);
  EXPECT_EQ(counted.keep_ahead(Eigen::MatrixXd::Zero(2, 5)), 5);
  EXPECT_EQ(counted.checks(), 0U);
}

}  // namespace
}  // namespace kinship::transfer::filters_test
