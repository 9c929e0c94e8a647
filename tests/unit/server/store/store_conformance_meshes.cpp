#include "tests/unit/server/store/store_conformance.hpp"

namespace kinship::store {
namespace {

constexpr MeshLimits kLimits{1U << 20U, 77};

TriangleMesh mesh_of(double size_m) {
  Eigen::Matrix3Xd corners(3, 6);
  corners << 0, size_m, 0, 0, 0, size_m, 0, 0, size_m, 0, 0, 0, 0, 0, 0, 0, size_m, size_m;
  return TriangleMesh::from_corners(corners).value_or_throw();
}

/// One for collision, one to look at.
RobotRecord with_meshes(RobotRecord robot, double collision_m, double visual_m) {
  robot.description.meshes = {
      {"arm", MeshRole::Collision, test::make_pose(), {}, 0, mesh_of(collision_m).digest()},
      {"hand",
       MeshRole::Visual,
       test::make_pose(),
       {1, 0.5, 0, 1},
       0.001,
       mesh_of(visual_m).digest()}};
  return robot;
}

TEST_P(StoreConformance, GivesMeshesAndTheirContentsBackAsTheyWere) {
  const RobotRecord robot = with_meshes(test::make_robot("mesh", 3), 1, 2);
  ASSERT_EQ(store_->register_robot(robot).value_or_throw(), RegisterStatus::Registered);
  const MeshesPut put = store_->put_meshes(robot.digest, {mesh_of(2).content()}, kLimits);
  EXPECT_EQ(put.stored, 1U);
  EXPECT_FALSE(put.is_complete) << "the one for collision is missing";
  reopen();
  const RobotRecord after = store_->find_robot(robot.digest).value();
  ASSERT_EQ(after.description.meshes.size(), 2U);
  const LinkMesh& is = after.description.meshes[1];
  EXPECT_EQ(is.link, "hand");
  EXPECT_EQ(is.role, MeshRole::Visual);
  EXPECT_TRUE(is.T_link_mesh.isApprox(test::make_pose(), 1e-15));
  EXPECT_EQ(is.rgba, (std::vector<double>{1, 0.5, 0, 1}));
  EXPECT_EQ(is.error_m, 0.001);
  EXPECT_EQ(is.content, mesh_of(2).digest());
  EXPECT_EQ(after.geometry_revision, 0U);
  ASSERT_TRUE(store_->find_mesh(mesh_of(2).digest()));
  EXPECT_EQ(TriangleMesh::read(*store_->find_mesh(mesh_of(2).digest()))->digest(),
            mesh_of(2).digest());
  EXPECT_FALSE(store_->find_mesh(mesh_of(1).digest()));
  EXPECT_EQ(
      store_->known_meshes({mesh_of(1).digest(), mesh_of(2).digest()}),
      (std::map<Digest, std::uint64_t>{{mesh_of(2).digest(), mesh_of(2).content().zlib.size()}}));
  EXPECT_EQ(store_->mesh_use().count, 1U);
  EXPECT_EQ(store_->mesh_use().bytes, mesh_of(2).content().zlib.size());
  EXPECT_EQ(store_->status().meshes, 1U);
  EXPECT_EQ(store_->status().mesh_bytes, mesh_of(2).content().zlib.size());
}

TEST_P(StoreConformance, TheLastMeshForCollisionRaisesTheRevisionOfGeometry) {
  const RobotRecord robot = with_meshes(test::make_robot("mesh", 3), 1, 2);
  ASSERT_TRUE(store_->register_robot(robot));
  EXPECT_TRUE(store_->put_meshes(robot.digest, {mesh_of(1).content()}, kLimits).is_complete);
  EXPECT_FALSE(store_->put_meshes(robot.digest, {mesh_of(1).content()}, kLimits).is_complete);
  reopen();
  EXPECT_EQ(store_->find_robot(robot.digest)->geometry_revision, 1U);
  EXPECT_EQ(store_->find_robot(robot.digest)->geometry_ms, kLimits.now_ms);
  EXPECT_EQ(store_->find_robot(robot.digest)->description.meshes.size(), 2U);
}

TEST_P(StoreConformance, TakesOnlyContentsThatTheRobotNamesAndThatThereIsRoomFor) {
  const RobotRecord robot = with_meshes(test::make_robot("mesh", 3), 1, 2);
  ASSERT_TRUE(store_->register_robot(robot));
  MeshContent broken = mesh_of(2).content();
  broken.zlib[5] ^= 0xffU;
  const MeshesPut put = store_->put_meshes(robot.digest, {mesh_of(3).content(), broken}, kLimits);
  EXPECT_EQ(put.refused, 2U);
  EXPECT_NE(put.why, "");
  const std::uint64_t room = mesh_of(1).content().zlib.size();
  const MeshesPut full =
      store_->put_meshes(robot.digest, {mesh_of(1).content(), mesh_of(2).content()}, {room, 1});
  EXPECT_EQ(full.stored, 1U);
  EXPECT_EQ(full.over, 1U);
  EXPECT_EQ(store_->put_meshes(test::id_from<Digest>(9), {mesh_of(1).content()}, kLimits).refused,
            1U);
}

TEST_P(StoreConformance, AContentGoesWithTheLastRobotThatNamesIt) {
  const RobotRecord one = with_meshes(test::make_robot("one", 3), 1, 2),
                    other = with_meshes(test::make_robot("other", 4), 1, 3);
  for (const RobotRecord& robot : {one, other})
    ASSERT_TRUE(store_->register_robot(robot));
  store_->put_meshes(one.digest, {mesh_of(1).content(), mesh_of(2).content()}, kLimits);
  store_->put_meshes(other.digest, {mesh_of(1).content(), mesh_of(3).content()}, kLimits);
  EXPECT_EQ(store_->mesh_use().count, 3U) << "the shared one is there once";
  ASSERT_TRUE(store_->remove_robot(one.digest));
  EXPECT_FALSE(store_->find_mesh(mesh_of(2).digest()));
  EXPECT_TRUE(store_->find_mesh(mesh_of(1).digest()));
  RobotRecord changed = with_meshes(other, 1, 4);
  changed.geometry_revision = store_->find_robot(other.digest)->geometry_revision + 1;
  ASSERT_TRUE(store_->replace_geometry(changed));
  EXPECT_FALSE(store_->find_mesh(mesh_of(3).digest()));
  EXPECT_TRUE(store_->find_mesh(mesh_of(1).digest()));
  report(test::make_attempt(other.digest, "shelf", 1));  // its row stays
  ASSERT_TRUE(store_->remove_robot(other.digest));
  EXPECT_EQ(store_->mesh_use().count, 0U);
}

}  // namespace
}  // namespace kinship::store
