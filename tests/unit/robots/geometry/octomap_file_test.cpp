// Maps that OctoMap itself has written, read here.

#include "robots/geometry/point_file.hpp"

#include <gtest/gtest.h>
#include <octomap/ColorOcTree.h>
#include <octomap/OcTree.h>

#include <algorithm>
#include <array>
#include <limits>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "proto/types/failure.hpp"
#include "robots/geometry/point_cloud.hpp"

namespace kinship::geometry::octomap_file_test {
namespace {

constexpr double kEdge_m = 0.05;

/// Two clouds of cubes, a block so large that the map keeps it as one cube, and free space.
octomap::OcTree map() {
  octomap::OcTree tree(kEdge_m);
  std::mt19937_64 generator(3);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int i = 0; i < 400; ++i) {
    tree.updateNode(place(generator) - 2, place(generator), place(generator), true);
    tree.updateNode(place(generator) + 2, place(generator), place(generator), false);
  }
  for (double x = 0.025; x < 0.8; x += kEdge_m)
    for (double y = 0.025; y < 0.8; y += kEdge_m)
      for (double z = 0.025; z < 0.8; z += kEdge_m)
        tree.updateNode(x + 3.2, y, z, true);
  tree.updateInnerOccupancy();
  tree.prune();
  return tree;
}

/// The middles of all smallest cubes that are occupied.
std::vector<std::array<double, 3>> cubes_of(const octomap::OcTree& tree) {
  std::vector<std::array<double, 3>> cubes;
  for (auto leaf = tree.begin_leafs(); leaf != tree.end_leafs(); ++leaf) {
    if (!tree.isNodeOccupied(*leaf))
      continue;
    const int across = 1 << (16 - static_cast<int>(leaf.getDepth()));
    const auto at = [&](double middle, int i) {
      return middle + kEdge_m * (i - 0.5 * (across - 1));
    };
    for (int i = 0; i < across; ++i)
      for (int j = 0; j < across; ++j)
        for (int k = 0; k < across; ++k)
          cubes.push_back({at(leaf.getX(), i), at(leaf.getY(), j), at(leaf.getZ(), k)});
  }
  std::ranges::sort(cubes);
  return cubes;
}

std::string binary(octomap::OcTree tree) {
  std::ostringstream file;
  tree.writeBinary(file);
  return file.str();
}

std::string full(const octomap::AbstractOcTree& tree) {
  std::ostringstream file;
  tree.write(file);
  return file.str();
}

std::string why(const std::string& file) {
  try {
    read_octomap(file);
    return "accepted";
  } catch (const Failure& failure) {
    return failure.what();
  }
}

TEST(OctomapFile, ItsCubesAreTheVoxelsOfAGridAsFine) {
  const octomap::OcTree tree = map();
  const std::vector<std::array<double, 3>> expected = cubes_of(tree);
  ASSERT_GT(expected.size(), 4'000U);
  for (const std::string& file : {binary(tree), full(tree)}) {
    const FilePoints read = read_octomap(file);
    EXPECT_EQ(read.cube_m, kEdge_m);
    const Eigen::Matrix3Xd voxels = voxels_of(read.points, kEdge_m).value_or_throw();
    ASSERT_EQ(voxels.cols(), static_cast<Eigen::Index>(expected.size()));
    for (std::size_t i = 0; i < expected.size(); ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        ASSERT_NEAR(voxels(static_cast<Eigen::Index>(axis), static_cast<Eigen::Index>(i)),
                    expected[i][axis], 1e-6);
  }
}

TEST(OctomapFile, ACoarserGridLeavesOutNothing) {
  constexpr double kVoxel_m = 0.07;
  const octomap::OcTree tree = map();
  const Eigen::Matrix3Xd voxels =
      voxels_of(read_octomap(binary(tree)).points, kVoxel_m).value_or_throw();
  octomap::OcTree grid(kVoxel_m);
  for (const auto& voxel : voxels.colwise())
    grid.updateNode(voxel.x(), voxel.y(), voxel.z(), true);
  std::mt19937_64 generator(4);
  std::uniform_real_distribution<double> within(-0.499 * kEdge_m, 0.499 * kEdge_m);
  for (const auto& cube : cubes_of(tree))
    for (int i = 0; i < 20; ++i)
      ASSERT_NE(grid.search(cube[0] + within(generator), cube[1] + within(generator),
                            cube[2] + within(generator)),
                nullptr);
}

TEST(OctomapFile, AnEmptyMapHasNoPoints) {
  EXPECT_EQ(read_octomap(full(octomap::OcTree(kEdge_m))).points.cols(), 0);
}

/// It would be free else.
TEST(OctomapFile, AProbabilityThatIsNoNumberIsRefused) {
  octomap::OcTree tree(kEdge_m);
  tree.updateNode(0.1, 0.1, 0.1, true)->setLogOdds(std::numeric_limits<float>::quiet_NaN());
  EXPECT_EQ(why(full(tree)), "data: a node's probability is no number");
}

TEST(OctomapFile, SaysWhatIsWrong) {
  const std::string file = binary(map());
  EXPECT_EQ(why(file.substr(0, file.size() - 1)), "data: ends within a node");
  const std::size_t data = file.find("data\n") + 5;
  EXPECT_EQ(why(file.substr(0, data) + std::string(4'000, '\xff')),
            "data: is deeper than 16 levels");
  const std::string second_child_only = std::string("\x0c") + std::string(1, '\0');
  EXPECT_EQ(why(file.substr(0, data) + "\x02" + std::string(1, '\0')),
            "more than 1000000 of its smallest cubes are occupied");
  EXPECT_EQ(why(file + "x"), "data: 1 bytes follow the tree");
  EXPECT_EQ(why(file.substr(0, data) + second_child_only), "data: ends within a node");
  EXPECT_NE(why("VERSION 0.7\n").find("is no OctoMap"), std::string::npos);
  EXPECT_EQ(why("# Octomap OcTree file\nid OcTree\n"), "header: no line 'data'");
  EXPECT_EQ(why("# Octomap OcTree file\nid OcTree\nres -1\ndata\n"),
            "header: res must be an edge of 0.0001 to 100 m");
  EXPECT_EQ(why(full(octomap::ColorOcTree(kEdge_m))),
            "header: id must be OcTree, not 'ColorOcTree'");
}

}  // namespace
}  // namespace kinship::geometry::octomap_file_test
