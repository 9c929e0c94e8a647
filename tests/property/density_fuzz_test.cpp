// Whatever the public interface of server/density is given: a mixture with which one can work, a
// reason, or std::invalid_argument where an option is a caller's bug. Which of the three is
// foretold.

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <optional>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "proto/types/limits.hpp"
#include "server/density/fit.hpp"
#include "server/density/kernel_density.hpp"

namespace kinship::density::density_fuzz_test {
namespace {

constexpr int kCalls = 800;  // of each estimator
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kMin = std::numeric_limits<double>::denorm_min();

/// What numbers of a call come from.
class Draws {
 public:
  explicit Draws(std::uint64_t seed) : generator_(seed) {}

  bool one_in(std::uint64_t count) { return generator_() % count == 0; }
  std::uint64_t below(std::uint64_t limit) { return generator_() % limit; }
  Eigen::Index index_below(Eigen::Index limit) {
    return static_cast<Eigen::Index>(below(static_cast<std::uint64_t>(limit)));
  }
  double normal() { return normal_(generator_); }
  template <typename Values>
  auto any_of(const Values& values) {
    return values[below(std::size(values))];
  }
  std::uint64_t bits() { return generator_(); }

 private:
  std::mt19937_64 generator_;
  std::normal_distribution<double> normal_;
};

/// Points like a robot's, or not.
Eigen::MatrixXd configurations_of(Draws& draws) {
  constexpr std::array kScales = {1.0, 1.0, 1e-3, 1e3, 2e5, 1e-200, kMin};
  constexpr std::array kOdd = {0.0,   -0.0, 1e6,      -1e6, 1e-310, 1e6 * (1 + 1e-9),
                               1e300, kNaN, kInfinity};
  constexpr std::array<Eigen::Index, 9> kCounts = {0, 2, 17, 33, 40, 41, 90, 130, 300};
  const auto joints = static_cast<Eigen::Index>(draws.one_in(100) ? 0 : 1 + draws.below(16));
  const Eigen::Index count = draws.any_of(kCounts);
  const double scale = draws.any_of(kScales);
  Eigen::MatrixXd points =
      Eigen::MatrixXd::NullaryExpr(joints, count, [&] { return scale * draws.normal(); });
  if (points.size() == 0)
    return points;
  const auto column = [&] { return draws.index_below(points.cols()); };
  const auto joint = [&] { return draws.index_below(points.rows()); };
  if (draws.one_in(6))
    points.row(joint()).setConstant(draws.normal());
  if (draws.one_in(6))
    points.row(joint()) = points.row(joint()).eval();
  if (draws.one_in(20))
    points = points.col(column()).replicate(1, points.cols()).eval();
  if (draws.one_in(6))
    points.leftCols(points.cols() / 2) =
        points.col(column()).replicate(1, points.cols() / 2).eval();
  if (draws.one_in(6))
    points.rightCols(points.cols() / 3).array() += draws.any_of(std::array{1e2, 1e4, 5e5});
  for (int odd = draws.one_in(8) ? 2 : 0; odd > 0; --odd)
    points(joint(), column()) = draws.any_of(kOdd);
  return points;
}

Eigen::VectorXd weights_of(Draws& draws, Eigen::Index count) {
  constexpr std::array kScales = {1.0, 1.0, 1e-9, kMin, 1e-300, 1e300};
  constexpr std::array kOdd = {0.0, 1e9, 1e-9, kMin, 1e308, 1e308, -1.0, kNaN, kInfinity};
  if (draws.one_in(100))
    ++count;  // one too many
  const double scale = draws.any_of(kScales);
  Eigen::VectorXd weights =
      Eigen::VectorXd::NullaryExpr(count, [&] { return scale * (1 + std::abs(draws.normal())); });
  if (draws.one_in(50))
    weights.setZero();
  for (int odd = draws.one_in(6) ? 3 : 0; count > 0 && odd > 0; --odd)
    weights[draws.index_below(count)] = draws.any_of(kOdd);
  return weights;
}

struct Paths {
  std::vector<std::uint32_t> path_of;
  bool are_valid = true;
};

Paths paths_of(Draws& draws, Eigen::Index count) {
  const std::uint64_t length = draws.any_of(std::array<std::uint64_t, 4>{1, 3, 10, 1000});
  Paths paths;
  for (Eigen::Index i = 0; i < count; ++i)
    paths.path_of.push_back(static_cast<std::uint32_t>(static_cast<std::uint64_t>(i) / length));
  if (draws.one_in(60)) {
    paths.path_of.push_back(0);
    paths.are_valid = false;
  } else if (count > 0 && draws.one_in(60)) {
    std::replace(paths.path_of.begin(), paths.path_of.end(), 0U,
                 draws.any_of(std::array{1U << 31, static_cast<std::uint32_t>(count)}));
    paths.are_valid = false;
  } else if (count > 2 && draws.one_in(60)) {
    std::fill(paths.path_of.begin(), paths.path_of.end(), 1U);  // and none of path 0
    paths.are_valid = false;
  }
  return paths;
}

struct Limits {
  Eigen::Matrix2Xd limits;
  bool are_valid = true;
};

Limits limits_of(Draws& draws, Eigen::Index joints) {
  Limits made{Eigen::Matrix2Xd(2, joints)};
  made.limits.row(0).setConstant(-draws.any_of(std::array{3.0, 0.0, 1e300, 1.7e308}));
  made.limits.row(1).setConstant(draws.any_of(std::array{3.0, 0.0, 1e-320, 1.7e308}));
  if (joints == 0 || draws.one_in(2))
    return {};
  if (draws.one_in(30)) {
    made.limits(draws.below(2) == 0 ? 0 : 1, 0) = draws.any_of(std::array{kNaN, kInfinity});
    made.are_valid = false;
  } else if (draws.one_in(30)) {
    made.limits.col(0) << 1, -1;
    made.are_valid = false;
  } else if (draws.one_in(30)) {
    made.limits.conservativeResize(2, joints + 1);
    made.limits.col(joints) << -1, 1;
    made.are_valid = false;
  }
  return made;
}

/// A mixture of any origin; nothing says that it was fitted to points like these.
Mixture mixture_before(Draws& draws, Eigen::Index joints) {
  constexpr std::array kVariances = {1.0, 1e-4, 1e-300, 1e12, 1e300, 0.0};
  constexpr std::array kPlaces = {0.0, 1.0, 100.0, 1e6, 1e6, 1e300};
  const Eigen::Index components = draws.any_of(std::array{1, 2, 7, 60});
  const double place = draws.one_in(2) ? 1 : draws.any_of(kPlaces);
  const Eigen::MatrixXd means = Eigen::MatrixXd::NullaryExpr(
      joints, components, [&] { return place * std::clamp(draws.normal(), -1.0, 1.0); });
  Eigen::VectorXd weights = Eigen::VectorXd::NullaryExpr(
      components, [&] { return draws.one_in(5) ? 0 : std::abs(draws.normal()); });
  weights[0] += 1;
  std::vector<Eigen::MatrixXd> covariances;
  const auto count = draws.one_in(4) ? 1 : components;
  for (Eigen::Index k = 0; k < count; ++k)
    covariances.emplace_back((draws.one_in(2) ? 1 : draws.any_of(kVariances)) *
                             Eigen::MatrixXd::Identity(joints, joints));
  return {weights / weights.sum(), means, covariances};
}

struct Floor {
  double value;
  bool is_valid = true;
};

Floor floor_of(Draws& draws) {
  if (draws.one_in(60))
    return {draws.any_of(std::array{-1.0, kNaN, kInfinity}), false};
  return {draws.one_in(3) ? draws.any_of(std::array{0.0, kMin, 1e-300, 1e-12, 1.0, 1e300}) : 1e-4};
}

/// Whether a reason may be only that there is no such number, or too few of them.
bool is_good_data(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights, double floor) {
  return points.allFinite() && points.cwiseAbs().maxCoeff() <= kMaxJointValue && floor >= 1e-4 &&
         weights.allFinite() && weights.minCoeff() >= 0 && weights.maxCoeff() > 0 &&
         weights.maxCoeff() <= 1e300;
}

void expect_workable(const Mixture& mixture, double floor, double scale) {
  EXPECT_TRUE(mixture.weights().allFinite());
  EXPECT_NEAR(mixture.weights().sum(), 1, 1e-9);
  EXPECT_GE(mixture.weights().minCoeff(), 0);
  EXPECT_TRUE(mixture.means().allFinite());
  EXPECT_LE(mixture.means().cwiseAbs().maxCoeff(), 1.001e6);
  for (const Eigen::MatrixXd& covariance : mixture.covariances()) {
    EXPECT_TRUE(covariance.allFinite());
    EXPECT_EQ(Eigen::LLT<Eigen::MatrixXd>(covariance).info(), Eigen::Success);
    EXPECT_GE(covariance.diagonal().minCoeff(), floor * (1 - 1e-9) - 1e-14 * scale * scale);
  }
}

/// How often each of the three came out: a fuzz that meets only one of them tests nothing.
struct Tally {
  int mixtures = 0, reasons = 0, bugs = 0;

  void expect_some_of_each() const {
    EXPECT_GT(mixtures, kCalls / 5);
    EXPECT_GT(reasons, kCalls / 20);
    EXPECT_GT(bugs, kCalls / 20);
  }
};

/// \param call  gives a Result of what has a mixture.
template <typename Call>
void expect_contract(const Eigen::MatrixXd& points, const Eigen::VectorXd& weights, double floor,
                     bool is_bug, const Call& call, Tally& tally) {
  if (is_bug) {
    EXPECT_THROW(static_cast<void>(call()), std::invalid_argument);
    ++tally.bugs;
    return;
  }
  std::optional<decltype(call())> answer;
  EXPECT_NO_THROW(answer = call());
  if (!answer)
    return;
  const auto& made = *answer;
  if (!made) {
    ++tally.reasons;
    EXPECT_EQ(made.error().code, ErrorCode::InvalidInput);
    if (points.cols() > 0 && is_good_data(points, weights, floor)) {
      EXPECT_NE(made.error().message.find("distinct configurations"), std::string::npos)
          << made.error().message;
    }
    return;
  }
  ++tally.mixtures;
  expect_workable(made->mixture, floor, points.cwiseAbs().maxCoeff());
  EXPECT_TRUE(std::isfinite(made->held_out_score.value_or(0)));
}

TEST(DensityFuzz, FitMixtureAnswersRefusesOrNamesTheBug) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < kCalls; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draws draws(seed);
    const Eigen::MatrixXd points = configurations_of(draws);
    const Eigen::VectorXd weights = weights_of(draws, points.cols());
    const Paths paths = paths_of(draws, points.cols());
    const Limits limits = limits_of(draws, points.rows());
    const Floor floor = floor_of(draws);
    FitOptions options;
    options.components =
        draws.one_in(40) ? -1 : draws.any_of(std::array{0, 0, 1, 3, 50, 2'000'000'000});
    options.seed = draws.bits();
    options.path_of_configuration = paths.path_of;
    options.limits = limits.limits;
    options.max_iterations = draws.one_in(40) ? -1 : draws.any_of(std::array{50, 50, 50, 1, 0});
    options.tolerance = draws.one_in(50) ? kNaN : draws.any_of(std::array{1e-3, 0.0, kInfinity});
    options.computation.prune = !draws.one_in(4);
    options.computation.threads = draws.any_of(std::array{1, 1, 1, 3, 0, -7});
    if (draws.one_in(2))
      options.covariance_floor = floor.value;
    else
      options.floors_of_joints = Eigen::VectorXd::Constant(points.rows(), floor.value);
    bool is_bug = points.rows() == 0 || weights.size() != points.cols() || !floor.is_valid ||
                  !limits.are_valid || options.components < 0 || options.max_iterations < 0 ||
                  std::isnan(options.tolerance);
    double floor_value = floor.value;
    if (options.floors_of_joints.size() > 0 && draws.one_in(40)) {
      options.floors_of_joints.conservativeResize(points.rows() + 1);
      options.floors_of_joints[points.rows()] = 1;
      is_bug = true;
    }
    const bool is_warm = draws.one_in(3);
    if (is_warm) {
      const Eigen::Index joints = draws.one_in(30) ? points.rows() + 1 : points.rows();
      options.warm_start = {mixture_before(draws, std::max(joints, Eigen::Index{1})), {}};
      for (Eigen::Index i = draws.one_in(30) ? -1 : 0; i < points.cols(); ++i)
        options.warm_start->is_new.push_back(static_cast<std::uint8_t>(draws.below(3) == 0));
      is_bug = is_bug || options.warm_start->mixture.dimension() != points.rows() ||
               options.warm_start->is_new.size() != static_cast<std::size_t>(points.cols()) ||
               options.warm_start->mixture.means().cwiseAbs().maxCoeff() > 2e6;
      floor_value = options.max_iterations == 0 ? 0 : floor_value;  // the mixture before as it is
    } else if (options.components == 0) {
      is_bug = is_bug || !paths.are_valid;
    }
    const double good_floor = is_warm ? 0 : floor_value;  // what it begins with may be anything
    expect_contract(
        points, weights, good_floor, is_bug,
        [&] {
          auto fitted = fit_mixture(points, weights, options);
          if (!fitted)
            return fitted;
          for (const double likelihood : fitted->log_likelihoods)
            EXPECT_TRUE(std::isfinite(likelihood));
          return fitted;
        },
        tally);
  }
  tally.expect_some_of_each();
}

TEST(DensityFuzz, EstimateKernelsAnswersRefusesOrNamesTheBug) {
  Tally tally;
  for (std::uint64_t seed = 0; seed < kCalls; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Draws draws(seed + 1'000'000);
    const Eigen::MatrixXd points = configurations_of(draws);
    const Eigen::VectorXd weights = weights_of(draws, points.cols());
    const Paths paths = paths_of(draws, points.cols());
    const Limits limits = limits_of(draws, points.rows());
    const Floor floor = floor_of(draws);
    KernelDensityOptions options;
    options.floors_of_joints =
        Eigen::VectorXd::Constant(points.rows() + (draws.one_in(40) ? 1 : 0), floor.value);
    options.seed = draws.bits();
    options.computation.prune = !draws.one_in(4);
    options.computation.threads = draws.any_of(std::array{1, 1, 1, 3, 0, -7});
    options.path_of_configuration = paths.path_of;
    options.limits = limits.limits;
    const bool is_bug = points.rows() == 0 || weights.size() != points.cols() || !floor.is_valid ||
                        !limits.are_valid || !paths.are_valid ||
                        options.floors_of_joints.size() != points.rows();
    expect_contract(
        points, weights, floor.value, is_bug,
        [&] { return estimate_kernel_density(points, weights, options); }, tally);
  }
  tally.expect_some_of_each();
}

}  // namespace
}  // namespace kinship::density::density_fuzz_test
