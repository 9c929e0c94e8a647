#include "robots/geometry/point_cloud.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <string>
#include <vector>

namespace kinship::geometry::point_cloud_test {
namespace {

TEST(PointCloud, FillsEachVoxelOnce) {
  Eigen::Matrix3Xd points(3, 4);
  points << 0.01, 0.019, -0.01, 0.03, 0, 0.01, 0, 0, 0, 0, 0, 0;
  const Eigen::Matrix3Xd voxels = voxels_of(points, 0.02).value_or_throw();
  ASSERT_EQ(voxels.cols(), 3);
  EXPECT_TRUE(voxels.col(0).isApprox(Eigen::Vector3d(-0.01, 0.01, 0.01)));
  EXPECT_TRUE(voxels.col(1).isApprox(Eigen::Vector3d(0.01, 0.01, 0.01)));
  points(0, 0) = 1500;
  EXPECT_NE(voxels_of(points, 0.02).error().message.find("are these metres?"), std::string::npos);
  points(0, 0) = 900;
  EXPECT_NE(voxels_of(points, 0.01).error().message.find("leave out points far away"),
            std::string::npos);
  const Eigen::Matrix3Xd many = Eigen::Matrix3Xd::Random(3, 600'000);
  EXPECT_EQ(voxels_of(many, 0.001).error().code, ErrorCode::TooLarge);
}

TEST(PointCloud, BlocksHoldAllVoxelsOnce) {
  constexpr double kVoxel_m = 0.03;
  std::srand(5);
  const Eigen::Matrix3Xd voxels =
      voxels_of(Eigen::Matrix3Xd::Random(3, 3000), kVoxel_m).value_or_throw();
  for (const std::size_t most : {std::size_t{1}, std::size_t{50}, std::size_t{100'000}}) {
    Eigen::Index held = 0;
    const std::vector<VoxelBlock> blocks = blocks_of(voxels, kVoxel_m, most);
    EXPECT_EQ(blocks.size(), std::min(most, static_cast<std::size_t>(voxels.cols())));
    for (const VoxelBlock& block : blocks) {
      held += block.voxels.cols();
      const Eigen::Array3d farthest =
          (block.voxels.colwise() - block.center).array().abs().rowwise().maxCoeff();
      EXPECT_TRUE((farthest + kVoxel_m / 2 <= block.size.array() / 2 + 1e-9).all());
      const Eigen::Array3d corner = block.center / kVoxel_m;
      EXPECT_LT((corner - corner.round()).abs().maxCoeff(), 1e-6);
    }
    EXPECT_EQ(held, voxels.cols());
  }
}

}  // namespace
}  // namespace kinship::geometry::point_cloud_test
