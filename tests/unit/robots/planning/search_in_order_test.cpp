// The search asks for several extensions and steps together; it must find what one finds that asks
// for one configuration after the other.

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>
#include <vector>

#include "robots/planning/birrt.hpp"
#include "tests/unit/robots/planning/wall_world.hpp"

namespace kinship::planning::search_in_order_test {
namespace {

using namespace test_support;

constexpr double kOvershoot = 1.5;

/// Two trees in the plane, grown as plan_birrt says and as plainly as can be.
class PlainSearch {
 public:
  PlainSearch(WallWorld& world, std::uint64_t max_checks, std::mt19937_64& generator)
      : world_(world), max_checks_(max_checks), generator_(generator) {}

  /// \return the path, empty if the checks are used up.
  std::vector<Eigen::VectorXd> plan(const Eigen::VectorXd& start, const Eigen::VectorXd& goal) {
    ask(start);
    ask(goal);
    trees_[0] = {{start, -1}};
    trees_[1] = {{goal, -1}};
    bool reached = false;
    const int there = extend(trees_[0], 0, goal, reached);
    if (reached)
      return joined(there, 0);
    const ConfigurationSampler sampler(square_bounds());
    while (checks < max_checks_) {
      ++iterations;
      const bool start_grows = trees_[0].size() <= trees_[1].size();
      auto &grown = trees_[start_grows ? 0 : 1], &other = trees_[start_grows ? 1 : 0];
      const Eigen::VectorXd sample = sampler.sample(generator_);
      const int near = nearest(grown, sample);
      const Eigen::VectorXd from = grown[static_cast<std::size_t>(near)].q;
      const Eigen::VectorXd target =
          (from + kOvershoot * (sample - from)).cwiseMax(at(-1, -1)).cwiseMin(at(1, 1));
      const int node = extend(grown, near, target, reached);
      if (node == near)
        continue;
      const Eigen::VectorXd tip = grown[static_cast<std::size_t>(node)].q;
      const int met = extend(other, nearest(other, tip), tip, reached);
      if (reached)
        return joined(start_grows ? node : met, start_grows ? met : node);
    }
    return {};
  }

  std::uint64_t checks = 0, iterations = 0;

 private:
  struct Node {
    Eigen::VectorXd q;
    int parent;
  };

  bool ask(const Eigen::VectorXd& q) {
    if (checks >= max_checks_)
      return false;
    ++checks;
    return world_.free_at(q);
  }

  static int nearest(const std::vector<Node>& tree, const Eigen::VectorXd& q) {
    int index = 0;
    float least = std::numeric_limits<float>::infinity();
    for (std::size_t i = 0; i < tree.size(); ++i) {
      const Eigen::Vector2f apart = tree[i].q.cast<float>() - q.cast<float>();
      const float squared = apart.x() * apart.x() + apart.y() * apart.y();
      if (squared < least) {
        least = squared;
        index = static_cast<int>(i);
      }
    }
    return index;
  }

  int extend(std::vector<Node>& tree, int from, const Eigen::VectorXd& target, bool& reached) {
    const Eigen::VectorXd origin = tree[static_cast<std::size_t>(from)].q;
    const double distance = (target - origin).norm();
    reached = distance == 0;
    const Eigen::VectorXd direction = (target - origin) / distance;
    for (int i = 1; !reached; ++i) {
      const bool last = i * kStep >= distance - 1e-9;
      const Eigen::VectorXd q = last ? target : Eigen::VectorXd(origin + i * kStep * direction);
      if (!ask(q))
        return from;
      tree.push_back({q, from});
      from = static_cast<int>(tree.size()) - 1;
      reached = last;
    }
    return from;
  }

  std::vector<Eigen::VectorXd> joined(int start_node, int goal_node) const {
    std::vector<Eigen::VectorXd> path;
    for (int i = start_node; i >= 0; i = trees_[0][static_cast<std::size_t>(i)].parent)
      path.insert(path.begin(), trees_[0][static_cast<std::size_t>(i)].q);
    for (int i = trees_[1][static_cast<std::size_t>(goal_node)].parent; i >= 0;
         i = trees_[1][static_cast<std::size_t>(i)].parent)
      path.push_back(trees_[1][static_cast<std::size_t>(i)].q);
    return path;
  }

  WallWorld& world_;
  std::uint64_t max_checks_;
  std::mt19937_64& generator_;
  std::vector<Node> trees_[2];
};

TEST(SearchInOrder, FindsWhatAPlainSearchFinds) {
  for (const std::uint64_t max_checks : {3U, 40U, 57U, 300U, 100'000U})
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
      WallWorld world;
      world.gap_lower = 0.7;  // narrow: many extensions come to nothing
      std::mt19937_64 plain_generator(seed), generator(seed);
      PlainSearch plain(world, max_checks, plain_generator);
      const std::vector<Eigen::VectorXd> expected = plain.plan(kStart, kGoal);
      BirrtOptions options = stepped();
      options.overshoot = kOvershoot;
      options.max_checks = max_checks;
      const PlanSummary summary =
          plan_birrt(kStart, kGoal, world.is_free(), ConfigurationSampler(square_bounds()), options,
                     generator);
      ASSERT_EQ(summary.collision_checks, plain.checks) << seed;
      EXPECT_EQ(world.asked, plain.checks);
      EXPECT_EQ(summary.iterations, plain.iterations);
      EXPECT_EQ(generator, plain_generator);
      ASSERT_EQ(summary.waypoints.has_value(), !expected.empty()) << seed;
      for (std::size_t i = 0; i < expected.size(); ++i)
        ASSERT_EQ(summary.waypoints->col(static_cast<Eigen::Index>(i)), expected[i]) << seed;
    }
}

}  // namespace
}  // namespace kinship::planning::search_in_order_test
