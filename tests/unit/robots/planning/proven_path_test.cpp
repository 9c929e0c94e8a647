#include "robots/planning/proven_path.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

#include "robots/planning/path_vertices.hpp"
#include "robots/planning/shortcut.hpp"

namespace kinship::planning::proven_path_test {
namespace {

constexpr double kStep = 0.05;
// A wall across the plane that lies between two steps of a straight line along x.
constexpr double kWall_x = 0.512, kThickness = 0.01;

/// A point in the plane. \param half_width  of the wall about y = 0
class Plane {
 public:
  explicit Plane(double half_width) : half_width_(half_width) {}

  bool is_free(const Eigen::VectorXd& q) const {
    return std::abs(q.x() - kWall_x) > kThickness / 2 || std::abs(q.y()) > half_width_;
  }

  /// Exactly: the line and the wall are both straight.
  bool edge(const Eigen::VectorXd& from, const Eigen::VectorXd& to) const {
    double first = 0, last = 1;  // shares of the line within the wall
    const auto clip = [&](double at, double change, double middle, double half) {
      if (change == 0) {
        if (std::abs(at - middle) > half)
          first = 2;
        return;
      }
      const double a = (middle - half - at) / change, b = (middle + half - at) / change;
      first = std::max(first, std::min(a, b));
      last = std::min(last, std::max(a, b));
    };
    clip(from.x(), to.x() - from.x(), kWall_x, kThickness / 2);
    clip(from.y(), to.y() - from.y(), 0, half_width_);
    return first > last;
  }

  IsFree proving() const {
    return {[this](const Eigen::VectorXd& q) { return is_free(q); },
            {},
            {},
            [this](const auto& from, const auto& to) {
              IsFree::Lines lines;
              for (Eigen::Index i = 0; i < from.cols(); ++i)
                lines.push_back(edge(from.col(i), to.col(i)));
              return lines;
            }};
  }

  bool all_free(const Eigen::MatrixXd& path) const { return proving().way_is_free(path); }

 private:
  double half_width_;
};

Eigen::MatrixXd across() {
  Eigen::MatrixXd path(2, 2);
  path << 0, 1, 0, 0;
  return path;
}

PlanBetween birrt(const IsFree& is_free, std::uint64_t max_checks) {
  return
      [&is_free, max_checks](const Eigen::VectorXd& from, const Eigen::VectorXd& to, double step) {
        Eigen::Matrix2Xd bounds(2, 2);
        bounds << -1, -1, 2, 1;
        BirrtOptions options;
        options.step = step;
        options.max_checks = max_checks;
        std::mt19937_64 generator(1);
        PlanSummary summary =
            plan_birrt(from, to, is_free, ConfigurationSampler(bounds), options, generator);
        if (summary.waypoints)
          summary.waypoints = sparse_vertices(*summary.waypoints, step);
        return summary;
      };
}

ShortcutSummary as_it_is(const Eigen::MatrixXd& waypoints, const IsFree&) {
  return {.waypoints = waypoints};
}

ShortcutSummary shortened(const Eigen::MatrixXd& waypoints, const IsFree& is_free) {
  std::mt19937_64 generator(1);
  return shortcut(waypoints, is_free, {.step = kStep, .max_checks = 10'000}, generator);
}

TEST(ProvenPath, WhatIsFreeIsLeftAsItIs) {
  const Plane plane(0);
  const IsFree is_free = plane.proving();
  Eigen::MatrixXd path(2, 3);
  path << 0, 0, 1, 0, 0.5, 0.5;
  const ProvenPath proven = shorten_and_prove(path, kStep, is_free, as_it_is, birrt(is_free, 1000));
  EXPECT_EQ(proven.waypoints, path);
  EXPECT_EQ(proven.refuted_edges, 0U);
  EXPECT_EQ(proven.collision_checks, 0U);
}

TEST(ProvenPath, GoesAroundWhatStandsBetweenTwoChecks) {
  const Plane plane(0.4);
  const IsFree is_free = plane.proving();
  const Eigen::MatrixXd steps = densified(across(), kStep);
  for (const auto& q : steps.colwise())
    ASSERT_TRUE(plane.is_free(q));
  const ProvenPath proven =
      shorten_and_prove(across(), kStep, is_free, as_it_is, birrt(is_free, 100'000));
  ASSERT_EQ(proven.reason, NoPath::None);
  EXPECT_GE(proven.refuted_edges, 1U);
  EXPECT_GT(proven.collision_checks, 0U);
  EXPECT_EQ(proven.waypoints.leftCols<1>(), across().leftCols<1>());
  EXPECT_EQ(proven.waypoints.rightCols<1>(), across().rightCols<1>());
  EXPECT_TRUE(plane.all_free(proven.waypoints));
}

/// The straight line looks free by steps, so each shortcut wants to take it.
TEST(ProvenPath, AShortcutThatIsRefutedIsNotTaken) {
  const Plane plane(0.4);
  const IsFree is_free = plane.proving();
  Eigen::MatrixXd around(2, 4);
  around << 0, 0.3, 0.7, 1, 0, 0.6, 0.6, 0;
  EXPECT_FALSE(plane.all_free(
      shortened(around, [&](const Eigen::VectorXd& q) { return plane.is_free(q); }).waypoints));
  const ProvenPath proven =
      shorten_and_prove(around, kStep, is_free, shortened, birrt(is_free, 1000));
  ASSERT_EQ(proven.reason, NoPath::None);
  EXPECT_TRUE(plane.all_free(proven.waypoints));
  EXPECT_LT(path_length(proven.waypoints), path_length(around));
  EXPECT_GE(proven.refuted_edges, 1U);
  EXPECT_EQ(proven.collision_checks, 0U);
}

TEST(ProvenPath, ASealedWallIsNotCrossed) {
  const Plane plane(10);
  const IsFree is_free = plane.proving();
  const ProvenPath proven =
      shorten_and_prove(across(), kStep, is_free, shortened, birrt(is_free, 2000));
  EXPECT_EQ(proven.reason, NoPath::MaxChecks);
  EXPECT_EQ(proven.waypoints.size(), 0);
  EXPECT_GE(proven.collision_checks, 2000U);
}

TEST(ProvenPath, APlannerThatNeverSeesWhyEndsToo) {
  const Plane plane(10);
  std::vector<double> steps;
  const auto blind = [&](const Eigen::VectorXd& from, const Eigen::VectorXd& to, double step) {
    steps.push_back(step);
    PlanSummary straight;
    straight.waypoints.emplace(from.size(), 2);
    *straight.waypoints << from, to;
    return straight;
  };
  const ProvenPath proven = shorten_and_prove(across(), kStep, plane.proving(), as_it_is, blind);
  EXPECT_EQ(proven.reason, NoPath::EdgesRefuted);
  EXPECT_GE(proven.refuted_edges, steps.size());
  EXPECT_TRUE(std::ranges::is_sorted(steps, std::greater<>()));
  EXPECT_LT(steps.back(), 1e-3);
}

TEST(ProvenPath, WithoutProofsAPathIsTakenAsItIs) {
  const Plane plane(10);
  const IsFree by_steps = [&](const Eigen::VectorXd& q) { return plane.is_free(q); };
  EXPECT_EQ(shorten_and_prove(across(), kStep, by_steps, as_it_is, birrt(by_steps, 2000)).waypoints,
            across());
}

TEST(ProvenPath, ADetourLeadsAroundWhatIsSmall) {
  const Plane plane(0.05);
  const IsFree is_free = plane.proving();
  Eigen::Matrix2Xd bounds(2, 2);
  bounds << -1, -1, 2, 1;
  std::mt19937_64 generator(1);
  std::uint64_t checks = 0;
  const auto way = detour(across().col(0), across().col(1), is_free, bounds, generator, checks);
  ASSERT_TRUE(way);
  EXPECT_TRUE(plane.all_free(*way));
  EXPECT_GE(checks, 1U);
  EXPECT_FALSE(
      detour(across().col(0), across().col(1), Plane(10).proving(), bounds, generator, checks));
}

}  // namespace
}  // namespace kinship::planning::proven_path_test
