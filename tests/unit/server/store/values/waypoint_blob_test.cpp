#include "server/store/values/waypoint_blob.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <limits>

#include "proto/types/limits.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::store::waypoint_blob_test {
namespace {

std::optional<Path> decode(const WaypointBlob& blob) {
  return decode_waypoints(blob.dof, blob.waypoint_count, static_cast<std::int64_t>(blob.encoding),
                          blob.bytes);
}

bool same_bits(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return a.rows() == b.rows() && a.cols() == b.cols() &&
         std::memcmp(a.data(), b.data(), static_cast<std::size_t>(a.size()) * sizeof(double)) == 0;
}

/// What a planner writes: straight segments in small steps.
Eigen::MatrixXd planned(Eigen::Index dof, Eigen::Index size) {
  const Eigen::MatrixXd ends = test::make_path(3, dof, 2).waypoints();
  Eigen::MatrixXd waypoints(dof, size);
  for (Eigen::Index i = 0; i < size; ++i) {
    const double along = static_cast<double>(i) / static_cast<double>(size - 1);
    waypoints.col(i) = (1 - along) * ends.col(0) + along * ends.col(1);
  }
  return waypoints;
}

TEST(WaypointBlob, KeepsEveryBit) {
  Eigen::MatrixXd odd = test::make_path(1, 7, 40).waypoints();
  odd(0, 0) = -0.0;
  odd(1, 1) = std::numeric_limits<double>::denorm_min();
  odd(2, 2) = std::numeric_limits<double>::max();
  odd(2, 3) = std::numeric_limits<double>::lowest();
  for (const Eigen::MatrixXd& waypoints :
       {odd, planned(6, 120), Eigen::MatrixXd(odd.leftCols(2))}) {
    const std::optional<Path> path = decode(encode_waypoints(waypoints));
    ASSERT_TRUE(path);
    EXPECT_TRUE(same_bits(path->waypoints(), waypoints));
  }
}

TEST(WaypointBlob, IsNeverLargerThanRaw) {
  const WaypointBlob noise = encode_waypoints(test::make_path(5, 7, 2).waypoints());
  EXPECT_EQ(noise.encoding, WaypointEncoding::Raw);
  EXPECT_EQ(noise.bytes.size(), 7U * 2 * sizeof(double));
  const WaypointBlob smooth = encode_waypoints(planned(7, 150));
  EXPECT_EQ(smooth.encoding, WaypointEncoding::Delta);
  EXPECT_LT(smooth.bytes.size(), 7U * 150 * sizeof(double) * 3 / 4);
}

TEST(WaypointBlob, RefusesSizesOverTheLimitsBeforeItAllocates) {
  const WaypointBlob blob = encode_waypoints(planned(6, 50));
  const auto encoding = static_cast<std::int64_t>(blob.encoding);
  const std::int64_t huge = std::numeric_limits<std::int64_t>::max();
  EXPECT_FALSE(decode_waypoints(huge, 50, encoding, blob.bytes));
  EXPECT_FALSE(decode_waypoints(6, huge, encoding, blob.bytes));
  EXPECT_FALSE(decode_waypoints(0, 50, encoding, blob.bytes));
  EXPECT_FALSE(decode_waypoints(6, 1, encoding, blob.bytes));
  EXPECT_FALSE(decode_waypoints(-6, -50, encoding, blob.bytes));
}

TEST(WaypointBlob, RefusesAnotherLengthAndAnUnknownEncoding) {
  for (const auto& waypoints : {planned(6, 50), test::make_path(5, 7, 2).waypoints()}) {
    WaypointBlob blob = encode_waypoints(waypoints);
    EXPECT_FALSE(decode_waypoints(blob.dof, blob.waypoint_count, 3, blob.bytes));
    EXPECT_FALSE(decode_waypoints(blob.dof, blob.waypoint_count + 1,
                                  static_cast<std::int64_t>(blob.encoding), blob.bytes));
    blob.bytes.pop_back();
    EXPECT_FALSE(decode(blob));
    blob.bytes.clear();
    EXPECT_FALSE(decode(blob));
  }
}

TEST(WaypointBlob, RefusesValuesThatAreNotFinite) {
  Eigen::MatrixXd waypoints = test::make_path(1).waypoints();
  waypoints(1, 1) = std::nan("");
  EXPECT_FALSE(decode(encode_waypoints(waypoints)));
}

}  // namespace
}  // namespace kinship::store::waypoint_blob_test
