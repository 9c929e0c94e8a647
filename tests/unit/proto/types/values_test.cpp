#include <gtest/gtest.h>

#include <limits>
#include <stdexcept>

#include "proto/types/fit_origin.hpp"
#include "proto/types/mixture.hpp"
#include "proto/types/path.hpp"
#include "proto/types/profile.hpp"
#include "proto/types/result.hpp"

namespace kinship::values_test {
namespace {

TEST(Path, RefusesOneWaypointAndNan) {
  EXPECT_THROW(Path(Eigen::MatrixXd::Zero(6, 1)), std::invalid_argument);
  Eigen::MatrixXd waypoints = Eigen::MatrixXd::Zero(6, 3);
  EXPECT_NO_THROW(Path{waypoints});
  waypoints(2, 1) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(Path{waypoints}, std::invalid_argument);
}

TEST(Mixture, RefusesWeightsThatDoNotSumToOne) {
  const Eigen::MatrixXd means = Eigen::MatrixXd::Zero(2, 2);
  const std::vector<Eigen::MatrixXd> covariances(2, Eigen::MatrixXd::Identity(2, 2));
  EXPECT_THROW(Mixture(Eigen::Vector2d(0.5, 0.6), means, covariances), std::invalid_argument);
  EXPECT_EQ(Mixture(Eigen::Vector2d(0.4, 0.6), means, covariances).size(), 2);
}

TEST(Mixture, ComponentsMayShareACovariance) {
  const Eigen::MatrixXd means = Eigen::MatrixXd::Zero(2, 3);
  const Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(2, 2);
  const Eigen::VectorXd weights = Eigen::VectorXd::Constant(3, 1.0 / 3);
  const Mixture kernels(weights, means, {covariance});
  EXPECT_TRUE(kernels.shares_covariance());
  EXPECT_EQ(&kernels.covariance(2), kernels.covariances().data());
  EXPECT_FALSE(Mixture(weights, means, {covariance, covariance, covariance}).shares_covariance());
  EXPECT_THROW(Mixture(weights, means, {covariance, covariance}), std::invalid_argument);
  EXPECT_FALSE(Mixture(Eigen::VectorXd::Ones(1), means.col(0), {covariance}).shares_covariance());
}

TEST(Mixture, RefusesAnAsymmetricCovariance) {
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(2, 2);
  covariance(0, 1) = 0.5;
  EXPECT_THROW(Mixture(Eigen::VectorXd::Ones(1), Eigen::MatrixXd::Zero(2, 1), {covariance}),
               std::invalid_argument);
}

TEST(Result, HoldsAValueOrAReason) {
  const Result<int> good(3);
  const Result<int> bad(Error{ErrorCode::NotFound, "robot 'x': unknown"});
  EXPECT_EQ(*good, 3);
  EXPECT_FALSE(bad);
  EXPECT_EQ(bad.error().message, "robot 'x': unknown");
  EXPECT_THROW(static_cast<void>(bad.value()), std::logic_error);
}

TEST(Profile, KnowsDefaultAndPaper) {
  ASSERT_TRUE(find_profile("default"));
  ASSERT_TRUE(find_profile("paper"));
  EXPECT_EQ(find_profile("paper")->transfer.max_solutions, 5);
  EXPECT_FALSE(find_profile("Default"));
}

TEST(FitOrigin, SaysWhichOfTheTwoHappened) {
  EXPECT_EQ(describe({4, 2, 525, 25, 25, ""}), "incremental from revision 4, 25 of 525 paths new");
  EXPECT_EQ(describe({4, 2, 525, 25, 525, ""}),
            "incremental from revision 4, 25 of 525 paths new, 525 transferred");
  EXPECT_EQ(describe({0, 0, 500, 500, 500, "the first"}), "full (the first), 500 paths");
  EXPECT_EQ(describe({0, 0, 40, 40, 20, ""}), "full, 40 paths, 20 transferred");
}

}  // namespace
}  // namespace kinship::values_test
