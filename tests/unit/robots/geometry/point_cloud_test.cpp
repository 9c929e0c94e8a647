#include "robots/geometry/point_cloud.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "robots/geometry/point_file.hpp"

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

Eigen::Matrix3Xd read(const std::string& text, const std::string& ending) {
  return read_points(text, ending).value_or_throw().points;
}

std::string why(const std::string& text, const std::string& ending) {
  return read_points(text, ending).error().message;
}

const std::string kHeader =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS rgb x y z\nSIZE 4 4 8 4\nTYPE U F F F\nCOUNT 2 1 1 1\n"
    "WIDTH 2\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 2\n";

TEST(PointFile, ReadsLinesOfNumbers) {
  Eigen::Matrix3Xd expected(3, 2);
  expected << 1, -4, 2, 5, 3e-2, +6;
  EXPECT_EQ(read("# seen at noon\n1 2 3e-2\n\n  -4\t 5\t+6 255 0 0 # red\r\nnan 1 2\n", "xyz"),
            expected);
}

TEST(PointFile, ReadsPcdAsTextAndAsBytes) {
  Eigen::Matrix3Xd expected(3, 1);
  expected << 0.5, 0.25, -2;
  EXPECT_EQ(read(kHeader + "DATA ascii\n7 8 0.5 0.25 -2\n7 8 nan nan nan\n", "pcd"), expected);

  std::string binary = kHeader + "DATA binary\n";
  for (const float x : {0.5F, std::numeric_limits<float>::quiet_NaN()}) {
    const double y = 0.25;
    const float z = -2;
    std::string point(24, '\n');
    std::memcpy(point.data() + 8, &x, sizeof x);
    std::memcpy(point.data() + 12, &y, sizeof y);
    std::memcpy(point.data() + 20, &z, sizeof z);
    binary += point;
  }
  EXPECT_EQ(read(binary, "pcd"), expected);
  binary.pop_back();
  EXPECT_EQ(why(binary, "pcd"), "2 points of 24 bytes are announced, 47 bytes follow");
}

TEST(PointFile, OnlyBlanksAndTabsPartNumbers) {
  for (const std::string line : {"0,5 0,25 1", "0, 5 1", "1,2,3", "1, 2, 3", "1 ,2 3", "1 2 0,5"})
    EXPECT_NE(why("1 2 3\n" + line + "\n", "xyz").find("is no number; decimal commas are not read"),
              std::string::npos)
        << line;
  EXPECT_EQ(why("1 2 3\n0,5 0,25 1\n", "txt").find("line 2: '0,5' is no number"), 0U);
  for (const std::string line : {"1;2;3", "1; 2; 3", "1|2|3", "1\v2\v3", "1\xc2\xa0 2 3"})
    EXPECT_EQ(why(line, "xyz").find("line 1: '"), 0U) << line;
  EXPECT_EQ(why(kHeader + "DATA ascii\n7 8 0,5 0,25 -2\n", "pcd").find("line 12: '0,5' is no"), 0U);
  EXPECT_EQ(why("FIELDS x,y,z\nSIZE 4,4,4\nTYPE F,F,F\nPOINTS 0\nDATA ascii\n", "pcd"),
            "header: SIZE is missing, too short or no number");
}

TEST(PointFile, WhatARefusalQuotesIsPrintable) {
  EXPECT_EQ(why("1 2 \x1b[31m\xff\n", "xyz"), "line 1: '?[31m?' is no number");
  EXPECT_EQ(why("1 2 " + std::string(1000, 'x'), "xyz"),
            "line 1: '" + std::string(40, 'x') + "' is no number");
  EXPECT_EQ(why(kHeader + "DATA \x07\x1b]0;\n", "pcd"),
            "header: DATA must be ascii or binary, not '??]0;'");
}

TEST(PointFile, SaysWhatIsWrong) {
  EXPECT_EQ(why("1 2 3\n1 2\n", "xyz"), "line 2: has too few numbers");
  EXPECT_EQ(why("1 2 x3\n", "txt"), "line 1: 'x3' is no number");
  EXPECT_NE(why("1 2 3\n", "las").find("known: xyz, txt, pcd, bt, ot"), std::string::npos);
  EXPECT_EQ(why("FIELDS x y\nSIZE 4 4\nTYPE F F\nDATA ascii\n", "pcd"),
            "header: FIELDS must name x, y and z once each");
  EXPECT_EQ(why("FIELDS x y z\nSIZE 4 4 4\nTYPE F F I\nDATA ascii\n", "pcd"),
            "header: z must be there once, one number of TYPE F and SIZE 4 or 8");
  EXPECT_EQ(why(kHeader + "DATA binary_compressed\n", "pcd"),
            "header: DATA must be ascii or binary, not 'binary_compressed'");
  EXPECT_NE(why("FIELDS x y z\nSIZE 4 4\nTYPE F F F\n", "pcd").find("SIZE is missing, too short"),
            std::string::npos);
  EXPECT_EQ(why("", "pcd"), "header: FIELDS is missing");
  EXPECT_EQ(why("FIELDS x y y\nSIZE 4 4 4\nTYPE F F F\nPOINTS 0\nDATA ascii\n", "pcd"),
            "header: y must be there once, one number of TYPE F and SIZE 4 or 8");
  EXPECT_EQ(why(kHeader + "DATA ascii\n7 8 0.5 0.25 -2\n", "pcd"),
            "2 points are announced, 1 follow");
  EXPECT_EQ(why(std::string(100'000, 'a'), "pcd"), "header: more than 100 lines of 4096 bytes");
}

}  // namespace
}  // namespace kinship::geometry::point_cloud_test
