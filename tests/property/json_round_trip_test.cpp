#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <random>
#include <string>

#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/problem_json.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::json::json_round_trip_test {
namespace {

constexpr std::uint64_t kSeed = 8;
constexpr int kCases = 200;

/// Values of the contract with doubles of every magnitude and any printable text.
class Values : public test::RandomValues {
 public:
  Values() : RandomValues(kSeed) {}

  double any_double() {
    for (;;) {
      const auto value = std::bit_cast<double>(generator()());
      if (std::isfinite(value))
        return value;
    }
  }
  double positive() { return std::abs(any_double()); }
  Eigen::MatrixXd any_matrix(Eigen::Index rows, Eigen::Index columns) {
    return Eigen::MatrixXd::NullaryExpr(rows, columns, [&] { return any_double(); });
  }
  std::string printable(int max_size) {
    std::string text(static_cast<std::size_t>(below(max_size + 1)), ' ');
    for (char& c : text)
      c = static_cast<char>(' ' + below('~' - ' ' + 1));
    return text;
  }

  Attempt attempt() {
    Attempt attempt = RandomValues::attempt();
    attempt.machine = printable(128);
    attempt.record.planner = printable(128);
    attempt.record.planner_options = printable(1024);
    attempt.record.planning_time_s = positive();
    attempt.record.time_limit_s = positive();
    if (attempt.path)
      attempt.path = Path(any_matrix(attempt.path->dof(), attempt.path->size()));
    return attempt;
  }
  Mixture mixture(Eigen::Index dof) {
    const Mixture mixture = RandomValues::mixture(dof);
    return {mixture.weights(), any_matrix(dof, mixture.size()), mixture.covariances()};
  }
};

bool same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::equal(a.data(), a.data() + a.size(), b.data(), [](double x, double y) {
           return std::bit_cast<std::uint64_t>(x) == std::bit_cast<std::uint64_t>(y);
         });
}

TEST(JsonRoundTrip, AttemptComesBackBitByBit) {
  Values values;
  for (int i = 0; i < kCases; ++i) {
    const Attempt written = values.attempt();
    const auto named = attempt_from_json(to_json(written));
    ASSERT_TRUE(named) << named.error().message;
    const Attempt& read = named->attempt;
    EXPECT_EQ(read.report_uuid, written.report_uuid);
    EXPECT_EQ(read.robot, written.robot);
    EXPECT_EQ(read.machine, written.machine);
    EXPECT_EQ(read.record.planner_options, written.record.planner_options);
    EXPECT_EQ(read.record.planning_time_s, written.record.planning_time_s);
    EXPECT_EQ(read.record.collision_checks, written.record.collision_checks);
    EXPECT_EQ(read.record.distribution_id, written.record.distribution_id);
    ASSERT_EQ(read.path.has_value(), written.path.has_value());
    if (written.path) {
      EXPECT_TRUE(same_bits(read.path->waypoints(), written.path->waypoints()));
    }
    ASSERT_EQ(read.T_task_base.has_value(), written.T_task_base.has_value());
    if (written.T_task_base) {
      EXPECT_TRUE(read.T_task_base->isApprox(*written.T_task_base, 1e-12));
    }
  }
}

TEST(JsonRoundTrip, DistributionComesBackBitByBit) {
  Values values;
  for (int i = 0; i < kCases; ++i) {
    Distribution written;
    written.id = values.digest();
    written.revision = values.count();
    written.task = "t";
    written.mixture = values.mixture(1 + values.below(8));
    const Eigen::Index dof = written.mixture->dimension();
    written.limits.resize(2, dof);
    written.limits.row(0).setConstant(-values.positive());
    written.limits.row(1).setConstant(values.positive());
    written.advice.recommended_share = values.share();
    if (values.coin())
      written.held_out_score = values.any_double();
    Source& source = written.sources.emplace_back();
    source.robot = values.digest();
    source.paths = values.count();

    const auto read = distribution_from_json(to_json(written));

    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->id, written.id);
    EXPECT_EQ(read->revision, written.revision);
    EXPECT_TRUE(same_bits(read->mixture->weights(), written.mixture->weights()));
    EXPECT_TRUE(same_bits(read->mixture->means(), written.mixture->means()));
    for (std::size_t k = 0; k < written.mixture->covariances().size(); ++k)
      EXPECT_TRUE(same_bits(read->mixture->covariances()[k], written.mixture->covariances()[k]));
    EXPECT_TRUE(same_bits(read->limits, written.limits));
    EXPECT_EQ(read->held_out_score, written.held_out_score);
    EXPECT_EQ(read->sources[0].paths, written.sources[0].paths);
  }
}

TEST(JsonRoundTrip, ProblemWritesTheSameTextAgain) {
  Values values;
  for (int i = 0; i < kCases; ++i) {
    Problem written;
    written.name = values.printable(40);
    written.start = values.any_matrix(1 + values.below(32), 1);
    if (values.coin())
      written.goal_configurations = values.any_matrix(written.start.size(), 1 + values.below(5));
    else
      written.T_task_goal = Eigen::Isometry3d::Identity();
    if (values.coin()) {
      written.start.resize(0);
      written.T_task_start = Eigen::Isometry3d(Eigen::Translation3d(values.share(), 0, 1));
    }
    const double extent = 0.01 + values.share();
    for (const Shape& shape :
         {Shape(BoxShape{Eigen::Vector3d(extent, 1, 2)}), Shape(SphereShape{extent}),
          Shape(CylinderShape{extent, 2}), Shape(CapsuleShape{1, extent})}) {
      const Eigen::Isometry3d T(Eigen::Translation3d(values.share(), values.share(), 0));
      written.attached.push_back({values.printable(9) + "a", "hand", shape, T, {"finger", "palm"}});
      written.scene.objects.push_back(
          {values.printable(9) + "o" + std::to_string(written.scene.objects.size()), shape, T});
    }
    written.allowed_collisions.assign(static_cast<std::size_t>(values.below(4)), {"a", "b"});
    written.time_limit_s = values.share();
    written.seed = values.count();

    const std::string text = to_json(written);
    const auto read = problem_from_json(text);

    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(to_json(*read), text);
    EXPECT_TRUE(same_bits(read->start, written.start));
  }
}

TEST(JsonRoundTrip, DamagedTextNeverDoesMoreThanRefuse) {
  Values values;
  const std::string text = to_json(values.attempt());
  for (int i = 0; i < 20 * kCases; ++i) {
    std::string damaged = text;
    for (int changes = 1 + values.below(4); changes > 0; --changes)
      damaged[static_cast<std::size_t>(values.below(static_cast<int>(text.size())))] =
          static_cast<char>(values.below(256));
    damaged.resize(damaged.size() - static_cast<std::size_t>(values.below(3)));
    const auto result = attempt_from_json(damaged);
    EXPECT_TRUE(result || !result.error().message.empty());
  }
}

}  // namespace
}  // namespace kinship::json::json_round_trip_test
