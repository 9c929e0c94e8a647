#include "proto/types/link_mesh.hpp"

#include <gtest/gtest.h>
#include <zlib.h>

#include <limits>
#include <random>

#include "proto/types/limits.hpp"

namespace kinship::link_mesh_test {
namespace {

constexpr std::uint64_t kSeed = 71;

/// A tetrahedron's corners.
Eigen::Matrix3Xd tetrahedron() {
  Eigen::Matrix3Xd points(3, 4);
  points << 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1;
  Eigen::Matrix3Xd corners(3, 12);
  int column = 0;
  for (const int i : {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3})
    corners.col(column++) = points.col(i);
  return corners;
}

MeshContent packed(std::vector<std::uint8_t> bytes) {
  uLongf size = ::compressBound(bytes.size());
  MeshContent content{static_cast<std::uint32_t>(bytes.size()), std::vector<std::uint8_t>(size)};
  EXPECT_EQ(::compress(content.zlib.data(), &size, bytes.data(), bytes.size()), Z_OK);
  content.zlib.resize(size);
  return content;
}

std::vector<std::uint8_t> unpacked(const MeshContent& content) {
  std::vector<std::uint8_t> bytes(content.bytes);
  uLongf size = bytes.size();
  EXPECT_EQ(::uncompress(bytes.data(), &size, content.zlib.data(), content.zlib.size()), Z_OK);
  return bytes;
}

TEST(TriangleMesh, OrderOfTrianglesAndOfTheirFirstCornersMakesNoDifference) {
  const Eigen::Matrix3Xd corners = tetrahedron();
  Eigen::Matrix3Xd other(3, 15);
  const std::vector<int> order = {11, 9, 10, 4, 5, 3, 6, 7, 8, 1, 2, 0, 0, 1, 2};  // one twice
  for (std::size_t i = 0; i < order.size(); ++i)
    other.col(static_cast<Eigen::Index>(i)) = corners.col(order[i]);
  other(0, 0) = -0.0;
  const TriangleMesh mesh = TriangleMesh::from_corners(corners).value_or_throw();
  EXPECT_EQ(mesh.digest(), TriangleMesh::from_corners(other)->digest());
  EXPECT_EQ(mesh.vertices().size(), 12U);
  EXPECT_EQ(mesh.triangles().size(), 12U);
  Eigen::Matrix3Xd turned_over = corners;  // its other side is another mesh
  turned_over.col(0).swap(turned_over.col(1));
  EXPECT_NE(mesh.digest(), TriangleMesh::from_corners(turned_over)->digest());
}

TEST(TriangleMesh, ComesBackFromItsContentWithTheCornersRoundedTo32Bits) {
  std::mt19937 generator(kSeed);
  std::uniform_real_distribution<double> coordinate(-2, 2);
  const Eigen::Matrix3Xd corners =
      Eigen::Matrix3Xd::NullaryExpr(3, 300, [&] { return coordinate(generator); });
  const TriangleMesh mesh = TriangleMesh::from_corners(corners).value_or_throw();
  const MeshContent content = mesh.content();
  EXPECT_EQ(content.bytes, mesh.bytes());
  EXPECT_EQ(content.bytes, 8U + 12U * 300 + 12U * 100);
  const TriangleMesh back = TriangleMesh::read(content).value_or_throw();
  EXPECT_EQ(back.digest(), mesh.digest());
  const Eigen::Matrix3Xd rounded = mesh.corners();
  EXPECT_EQ(back.corners(), rounded);
  for (Eigen::Index i = 0; i < 300; ++i) {  // each corner is a vertex within half a step
    const Eigen::VectorXd distances = (rounded.colwise() - corners.col(i)).colwise().norm();
    EXPECT_LT(distances.minCoeff(), 3e-7) << i;
  }
}

TEST(TriangleMesh, NumbersThatAreNoneAreRefused) {
  Eigen::Matrix3Xd corners = tetrahedron();
  corners(1, 4) = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(TriangleMesh::from_corners(corners));
  corners(1, 4) = 1001;
  EXPECT_FALSE(TriangleMesh::from_corners(corners));
  EXPECT_FALSE(TriangleMesh::from_corners(Eigen::Matrix3Xd(3, 0)));
  EXPECT_FALSE(TriangleMesh::from_corners(Eigen::Matrix3Xd::Zero(3, 4)));
}

TEST(TriangleMesh, ABombIsStoppedByItsDeclaredSizeBeforeItIsUnpacked) {
  const MeshContent bomb = packed(std::vector<std::uint8_t>(64U << 20U));
  EXPECT_EQ(TriangleMesh::read(bomb).error().message, "mesh: 67108864 bytes exceed 4194304");
  MeshContent liar = bomb;  // unpacks to more than it declares
  liar.bytes = 1024;
  EXPECT_EQ(TriangleMesh::read(liar).error().message, "mesh: is not a zlib stream of 1024 bytes");
  const MeshContent boaster{4 * 1024 * 1024, std::vector<std::uint8_t>(100)};  // has less
  EXPECT_EQ(TriangleMesh::read(boaster).error().message, "mesh: 100 bytes cannot hold 4194304");
}

TEST(TriangleMesh, BytesThatAreNotCanonicalAreRefused) {
  const std::vector<std::uint8_t> good =
      unpacked(TriangleMesh::from_corners(tetrahedron())->content());
  ASSERT_TRUE(TriangleMesh::read(packed(good)));
  std::vector<std::uint8_t> bytes = good;
  bytes[0] = 5;  // vertices
  EXPECT_FALSE(TriangleMesh::read(packed(bytes)));
  bytes = good;
  bytes.back() = 1;  // an index beyond all vertices
  EXPECT_FALSE(TriangleMesh::read(packed(bytes)));
  bytes = good;
  std::swap_ranges(bytes.end() - 12, bytes.end(), bytes.end() - 24);  // triangles out of order
  EXPECT_EQ(TriangleMesh::read(packed(bytes)).error().message,
            "mesh: its bytes are not in their canonical order");
  MeshContent content = packed(good);
  content.zlib.push_back(0);  // behind its end
  EXPECT_FALSE(TriangleMesh::read(content));
  content.zlib.resize(content.zlib.size() - 2);
  EXPECT_FALSE(TriangleMesh::read(content));
  EXPECT_FALSE(TriangleMesh::read(MeshContent{}));
}

}  // namespace
}  // namespace kinship::link_mesh_test
