#include "server/runtime/robot_registry.hpp"

#include <gtest/gtest.h>

#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/urdf_parses.hpp"
#include "tests/unit/server/fleet.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::runtime::robot_registry_test {
namespace {

class Registry : public testing::Test {
 protected:
  test::TemporaryDirectory directory_;
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "fleet.db");
  RobotRegistry registry_{*store_};
};

TEST_F(Registry, ANewRobotIsIdentifiedStoredAndKept) {
  const RegisterReply reply = registry_.register_robot(fleet::teacher(), 1234);
  EXPECT_EQ(reply.status, RegisterStatus::Registered);
  EXPECT_EQ(reply.robot, fleet::chain_of(fleet::teacher()).digest());
  EXPECT_EQ(reply.dof, 3U);
  EXPECT_FALSE(reply.solver.empty());
  ASSERT_NE(registry_.find_in_memory(reply.robot), nullptr);
  const auto record = store_->find_robot(reply.robot);
  ASSERT_TRUE(record);
  EXPECT_EQ(record->registered_ms, 1234);
}

/// Texts that a registration parses.
std::size_t parses(RobotRegistry& registry, const RobotDescription& description,
                   RegisterStatus status) {
  const std::size_t before = test::urdf_parses();
  const Candidate candidate(description);
  const std::optional<RegisterReply> known = registry.register_known(candidate);
  EXPECT_EQ((known ? *known : registry.register_robot(candidate, 1)).status, status);
  return test::urdf_parses() - before;
}

TEST_F(Registry, ParsesADescriptionOnce) {
  RobotDescription robot = fleet::with_shape(fleet::teacher(), "<mesh filename='a.stl'/>");
  EXPECT_EQ(parses(registry_, robot, RegisterStatus::Registered), 1U);
  EXPECT_EQ(parses(registry_, robot, RegisterStatus::Known), 1U);
  robot.mesh_solids.solids = {{"link1", SphereShape{0.1}}};
  EXPECT_EQ(parses(registry_, robot, RegisterStatus::Known), 1U) << "better geometry";
  store::TroubledStore shared(*store_);
  shared.has_others = true;
  RobotRegistry next(shared);
  EXPECT_EQ(parses(next, robot, RegisterStatus::Known), 1U) << "of the store";
  EXPECT_EQ(parses(next, robot, RegisterStatus::Known), 1U) << "of memory";
}

TEST_F(Registry, ARobotWhoseLabelIsDamagedIsRefusedForNowIfItsLabelMatters) {
  const Digest robot = RobotRegistry(*store_).register_robot(fleet::teacher(), 1).robot;
  store::Database(directory_ / "fleet.db", store::Access::ReadWrite)
      .execute("UPDATE robot SET base_link = ''");  // as a repair that found the name alone
  ASSERT_TRUE(store_->list_robots("", 10).rows.empty());
  const RegisterReply reply = registry_.register_robot(
      fleet::teacher(), 2, [](const std::string&) { return std::optional<Error>(); });
  EXPECT_EQ(reply.status, RegisterStatus::Refused);
  EXPECT_GT(reply.retry_after.count(), 0);
  EXPECT_EQ(reply.message,
            "robot " + robot.short_hex() + " is known, its label cannot be read now");
  EXPECT_EQ(registry_.register_robot(fleet::teacher(), 3).status, RegisterStatus::Registered)
      << "written anew by a caller whose labels are not limited";
}

TEST_F(Registry, TheSameRobotIsKnownByItsFirstLabel) {
  registry_.register_robot(fleet::teacher(), 1);
  RobotDescription again = fleet::teacher();
  EXPECT_EQ(registry_.register_robot(again, 2).status, RegisterStatus::Known);
  again.label = "other";
  const RegisterReply reply = registry_.register_robot(again, 3);
  EXPECT_EQ(reply.status, RegisterStatus::Known);
  EXPECT_EQ(reply.message, "known already, as 'teacher'");
}

TEST_F(Registry, ARobotInMemoryIsKnownAlsoWhileASharedStoreCannotBeReached) {
  store::TroubledStore shared(*store_);
  shared.has_others = true;
  RobotRegistry registry(shared);
  const auto cut = [] { throw Failure(ErrorCode::Storage, "the database does not answer"); };
  registry.register_robot(fleet::teacher(), 1);
  shared.on_register = shared.on_robot_read = cut;
  const RegisterReply reply = registry.register_robot(fleet::teacher(), 2);
  EXPECT_EQ(reply.status, RegisterStatus::Known);
  EXPECT_FALSE(reply.geometry.empty());
  const auto of_memory = registry.register_known(fleet::teacher());
  ASSERT_TRUE(of_memory);
  EXPECT_EQ(of_memory->status, RegisterStatus::Known);
  EXPECT_EQ(of_memory->robot, reply.robot);
  EXPECT_EQ(of_memory->dof, reply.dof);
  EXPECT_EQ(of_memory->solver, reply.solver);
  EXPECT_EQ(of_memory->geometry, reply.geometry);
  EXPECT_EQ(of_memory->geometry_grade, reply.geometry_grade);
  EXPECT_THROW(registry.register_robot(fleet::pupil(), 3), Failure) << "nobody can vouch for it";

  // Until the store says that it does not have it.
  registry.forget(reply.robot);
  EXPECT_THROW(registry.register_robot(fleet::teacher(), 4), Failure);
}

TEST_F(Registry, MemoryAloneAnswersForRobotsItHasAndRefusesWhatIsNoRobot) {
  store::TroubledStore shared(*store_);
  RobotRegistry registry(shared);
  registry.register_robot(fleet::teacher(), 1);
  EXPECT_FALSE(registry.register_known(fleet::teacher()))
      << "of one server: its row may be damaged";
  shared.has_others = true;
  EXPECT_FALSE(registry.register_known(fleet::pupil()));
  RobotDescription other = fleet::teacher();
  other.label = "other";
  EXPECT_EQ(registry.register_known(other)->message, "known already, as 'teacher'");
  other.label = "two words";
  EXPECT_EQ(registry.register_known(other)->status, RegisterStatus::Refused);
  const auto of_nobody = [](const std::string& label) {
    return std::optional(Error{ErrorCode::InvalidInput, label + " is not yours"});
  };
  EXPECT_EQ(registry.register_known(fleet::teacher(), of_nobody)->message, "teacher is not yours");
  const RobotDescription better = fleet::with_shape(fleet::teacher(), "<sphere radius='0.1'/>");
  EXPECT_FALSE(registry.register_known(better)) << "its geometry is to be written";
}

TEST_F(Registry, ARobotInMemoryIsComparedWithThoseInMemoryWhereTheStoreIsShared) {
  store::TroubledStore shared(*store_);
  shared.has_others = true;
  RobotRegistry registry(shared);
  RobotDescription twin = fleet::teacher();
  twin.label = "twin";
  twin.task_axes.matters = {true, true, true, false, false, true};
  registry.register_robot(fleet::teacher(), 1);
  const RegisterReply first = registry.register_robot(twin, 2);
  ASSERT_EQ(first.same_arms, std::vector<std::string>{"teacher"});
  shared.on_register = [] { throw Failure(ErrorCode::Storage, "the database does not answer"); };
  EXPECT_EQ(registry.register_robot(twin, 3).same_arms, first.same_arms);
}

TEST_F(Registry, ALabelBelongsToOneRobot) {
  registry_.register_robot(fleet::teacher(), 1);
  RobotDescription other = fleet::pupil();
  other.label = "teacher";
  const RegisterReply reply = registry_.register_robot(other, 2);
  EXPECT_EQ(reply.status, RegisterStatus::Refused);
  EXPECT_NE(reply.message.find("teacher"), std::string::npos) << reply.message;
}

TEST_F(Registry, BadDescriptionsAreRefusedWithTheReason) {
  RobotDescription description = fleet::teacher();
  description.label = "two words";
  EXPECT_EQ(registry_.register_robot(description, 1).message,
            "label: byte 4 is not one of A-Z a-z 0-9 _ . : -");
  description = fleet::teacher();
  description.tip_link = "hand";
  const RegisterReply reply = registry_.register_robot(description, 1);
  EXPECT_EQ(reply.status, RegisterStatus::Refused);
  EXPECT_TRUE(reply.message.starts_with("tip link 'hand': not in the URDF (it has 'base', "))
      << reply.message;
  EXPECT_TRUE(store_->robots().empty());
}

TEST_F(Registry, RobotsOfTheStoreAreReadWhenAskedFor) {
  const Digest robot = RobotRegistry(*store_).register_robot(fleet::teacher(), 1).robot;
  EXPECT_EQ(registry_.find_in_memory(robot), nullptr);
  const auto found = registry_.find(robot);
  ASSERT_TRUE(found);
  EXPECT_EQ(found.value()->label, "teacher");
  EXPECT_EQ(registry_.find_in_memory(robot), found.value());
}

using Labels = std::vector<std::string>;

TEST_F(Registry, TellsWhichKnownRobotsAreTheSameArm) {
  EXPECT_EQ(registry_.register_robot(fleet::teacher(), 1).same_arms, Labels{});
  EXPECT_EQ(registry_.register_robot(fleet::pupil(), 2).same_arms, Labels{});
  EXPECT_EQ(registry_.register_robot(fleet::planar("a_twin", {0.401, 0.3, 0.2}), 3).same_arms,
            Labels{"teacher"});
  EXPECT_EQ(registry_.register_robot(fleet::planar("z_other", {0.45, 0.3, 0.2}), 4).same_arms,
            Labels{});
  const RegisterReply again = registry_.register_robot(fleet::teacher(), 5);
  EXPECT_EQ(again.status, RegisterStatus::Known);
  EXPECT_EQ(again.same_arms, Labels{"a_twin"});
}

TEST_F(Registry, TellsOfRobotsThatARunBeforeThisOneRegistered) {
  RobotRegistry(*store_).register_robot(fleet::teacher(), 1);
  EXPECT_EQ(registry_.register_robot(fleet::planar("twin", {0.401, 0.3, 0.2}), 2).same_arms,
            Labels{"teacher"});
}

TEST_F(Registry, ADamagedRobotIsLeftOutOfTheSameArms) {
  RobotRegistry before(*store_);
  before.register_robot(fleet::teacher(), 1);
  before.register_robot(fleet::planar("second", {0.401, 0.3, 0.2}), 2);
  store::damage_robot(directory_ / "fleet.db", "teacher");
  const RegisterReply reply =
      registry_.register_robot(fleet::planar("third", {0.402, 0.3, 0.2}), 3);
  EXPECT_EQ(reply.status, RegisterStatus::Registered);
  EXPECT_EQ(reply.same_arms, Labels{"second"});
}

TEST_F(Registry, CollisionMeshesThatItCannotReadDoNotKeepARobotOut) {
  RobotDescription description = fleet::teacher();
  const std::string link = "<link name='link1'/>";
  const std::string mesh =
      "<link name='link1'><collision><geometry><mesh filename='package://nowhere/l1.stl'/>"
      "</geometry></collision></link>";
  description.urdf.replace(description.urdf.find(link), link.size(), mesh);
  EXPECT_EQ(registry_.register_robot(description, 1).status, RegisterStatus::Registered);
}

RobotDescription shaped(const std::string& geometry) {
  return fleet::with_shape(fleet::teacher(), geometry);
}
RobotDescription with_mesh() { return shaped("<mesh filename='package://nowhere/l1.stl'/>"); }
RobotDescription with_mesh_solids(double radius_m) {
  RobotDescription description = with_mesh();
  description.mesh_solids.solids = {{"link1", SphereShape{radius_m}}};
  return description;
}
RobotDescription with_sphere() { return shaped("<sphere radius='0.05'/>"); }

TEST_F(Registry, BetterGeometryOfAKnownRobotIsTakenOver) {
  const RegisterReply none = registry_.register_robot(with_mesh(), 1);
  EXPECT_EQ(none.geometry_grade, GeometryGrade::None);
  EXPECT_EQ(none.geometry, "1 link unknown, with meshes that only its clients have");
  EXPECT_EQ(registry_.geometry_revision(none.robot), 0U);

  RobotDescription again = with_mesh_solids(0.1);
  again.label = "other";
  const RegisterReply solids = registry_.register_robot(again, 2);
  EXPECT_EQ(solids.robot, none.robot) << "geometry is no part of who a robot is";
  EXPECT_EQ(solids.status, RegisterStatus::Known);
  EXPECT_TRUE(solids.took_geometry);
  EXPECT_EQ(solids.geometry_grade, GeometryGrade::Approximate);
  EXPECT_EQ(solids.geometry, "1 link by 1 solid around meshes (approximate)");
  EXPECT_EQ(registry_.geometry_revision(none.robot), 1U);
  EXPECT_EQ(registry_.find(none.robot).value()->shapes.shapes.size(), 1U);
  EXPECT_EQ(registry_.find(none.robot).value()->label, "teacher");

  const RegisterReply exact = registry_.register_robot(with_sphere(), 3);
  EXPECT_TRUE(exact.took_geometry);
  EXPECT_EQ(exact.geometry, "1 link by exact shapes");
  EXPECT_EQ(registry_.geometry_revision(none.robot), 2U);
  EXPECT_EQ(store_->find_robot(none.robot)->registered_ms, 1);
  EXPECT_EQ(store_->find_robot(none.robot)->geometry_ms, 3);

  RobotRegistry next(*store_);
  EXPECT_EQ(next.geometry_revision(none.robot), 2U) << "known before anybody asks for the robot";
  EXPECT_EQ(next.find(none.robot).value()->grade, GeometryGrade::Exact);
}

TEST_F(Registry, BetterGeometryIsTakenOverAlsoIfARobotIsRenamedMeanwhile) {
  store::TroubledStore store(*store_);
  RobotRegistry registry(store);
  const Digest robot = registry.register_robot(with_mesh(), 1).robot;
  const Digest other = registry.register_robot(fleet::pupil(), 1).robot;
  for (const Digest& renamed : {robot, other}) {
    const std::uint64_t revision = registry.geometry_revision(robot) + 1;
    store.on_geometry = [&] {
      EXPECT_TRUE(registry.rename_robot(renamed, "renamed_" + std::to_string(revision)));
      EXPECT_TRUE(registry.find(robot));
    };
    const RegisterReply reply =
        registry.register_robot(revision == 1 ? with_mesh_solids(0.1) : with_sphere(), 2);
    EXPECT_TRUE(reply.took_geometry);
    EXPECT_EQ(registry.geometry_revision(robot), revision);
    EXPECT_EQ(registry.find(robot).value()->geometry_revision, revision);
    EXPECT_EQ(registry.find(robot).value()->grade, reply.geometry_grade);
    EXPECT_EQ(registry.find(robot).value()->label, "renamed_1");
  }
}

TEST_F(Registry, GeometryThatIsNoBetterChangesNothing) {
  const Digest robot = registry_.register_robot(with_mesh_solids(0.1), 1).robot;
  for (const RobotDescription& other : {with_mesh_solids(0.2), with_mesh(), fleet::teacher()}) {
    const RegisterReply reply = registry_.register_robot(other, 2);
    EXPECT_EQ(reply.status, RegisterStatus::Known);
    EXPECT_FALSE(reply.took_geometry);
    EXPECT_EQ(reply.geometry_grade, GeometryGrade::Approximate);
  }
  EXPECT_EQ(registry_.geometry_revision(robot), 0U);
  const std::vector<LinkSolid> solids = store_->find_robot(robot)->description.mesh_solids.solids;
  EXPECT_EQ(std::get<SphereShape>(solids.at(0).shape).radius_m, 0.1) << "the first stays";
}

TEST_F(Registry, GeometryThatIsOfferedIsTakenOverIfItIsBetter) {
  const Digest robot = registry_.register_robot(with_mesh(), 1).robot;
  EXPECT_FALSE(registry_.offer_geometry(robot, with_mesh(), 2));
  EXPECT_FALSE(registry_.offer_geometry(robot, fleet::pupil(), 2)) << "it is another robot";
  RobotDescription better = with_sphere();
  better.label = "elsewhere";
  EXPECT_TRUE(registry_.offer_geometry(robot, better, 2));
  EXPECT_EQ(registry_.find(robot).value()->grade, GeometryGrade::Exact);
  EXPECT_EQ(registry_.find(robot).value()->label, "teacher");
  EXPECT_EQ(registry_.geometry_revision(robot), 1U);
  const Digest unknown = fleet::chain_of(fleet::pupil()).digest();
  EXPECT_FALSE(registry_.offer_geometry(unknown, fleet::pupil(), 2));
  EXPECT_FALSE(store_->find_robot(unknown));
}

TEST_F(Registry, SolidsThatMakeNoSenseAreNoGeometryAndAreToldOf) {
  RobotDescription description = with_mesh();
  description.mesh_solids.solids = {{"nose", SphereShape{0.1}}};
  const RegisterReply reply = registry_.register_robot(description, 1);
  EXPECT_EQ(reply.status, RegisterStatus::Registered);
  EXPECT_EQ(reply.geometry_grade, GeometryGrade::None);
  EXPECT_EQ(reply.geometry, "cannot be read: mesh_solids: no link named 'nose'");
  EXPECT_TRUE(registry_.register_robot(with_mesh_solids(0.1), 2).took_geometry);
}

TriangleMesh bar() {
  return TriangleMesh::from_corners(test::BoxMesh({0.1, 0.1, 0.3}).triangles()).value_or_throw();
}

/// With solids, and the names of the mesh's content for collision and of another one to look at.
RobotDescription with_named_meshes() {
  RobotDescription robot = with_mesh_solids(0.1);
  robot.meshes = {
      {"link1", MeshRole::Collision, Eigen::Isometry3d::Identity(), {}, 0, bar().digest()},
      {"link1",
       MeshRole::Visual,
       Eigen::Isometry3d::Identity(),
       {},
       0.001,
       test::id_from<Digest>(7)}};
  return robot;
}

TEST_F(Registry, MeshesOfAKnownRobotAreTakenOverAndFilterOnceTheyAreAllHere) {
  const Digest robot = registry_.register_robot(with_mesh_solids(0.1), 1).robot;
  const RegisterReply named = registry_.register_robot(with_named_meshes(), 2);
  EXPECT_EQ(named.status, RegisterStatus::Known);
  EXPECT_TRUE(named.took_geometry);
  EXPECT_EQ(named.geometry_grade, GeometryGrade::Approximate);
  EXPECT_EQ(named.meshes,
            "2 meshes, 1 of them for collision; 0 of 2 contents are here, 0 bytes "
            "compressed");
  EXPECT_EQ(named.wanted.size(), 2U);
  EXPECT_FALSE(registry_.register_robot(with_named_meshes(), 3).took_geometry);

  RobotDescription uploading = with_named_meshes();
  uploading.contents = {bar().content()};
  const RegisterReply complete = registry_.register_robot(uploading, 4);
  EXPECT_TRUE(complete.took_geometry);
  EXPECT_EQ(complete.geometry_grade, GeometryGrade::Exact);
  EXPECT_EQ(complete.geometry, "1 link by the triangles of their meshes");
  EXPECT_EQ(complete.wanted, std::vector<MeshDigest>{{test::id_from<Digest>(7)}});
  EXPECT_EQ(registry_.geometry_revision(robot), 2U);
  EXPECT_EQ(store_->find_robot(robot)->geometry_ms, 4);
  EXPECT_NE(registry_.find(robot).value()->shapes.shapes.at(0).triangles, nullptr);

  for (const RobotDescription& worse : {with_mesh_solids(0.1), with_mesh()})
    EXPECT_FALSE(registry_.register_robot(worse, 5).took_geometry);
  EXPECT_EQ(RobotRegistry(*store_).find(robot).value()->grade, GeometryGrade::Exact);
  EXPECT_EQ(registry_.geometry_revision(robot), 2U);
}

TEST_F(Registry, ContentsThatCannotBeTakenAreToldOfAndTheRobotIsRegistered) {
  RobotDescription uploading = with_named_meshes();
  uploading.contents = {bar().content(), MeshContent{44, {1, 2, 3}}};
  RobotRegistry full(*store_, {.max_mesh_bytes = 1});
  const RegisterReply reply = full.register_robot(uploading, 1);
  EXPECT_EQ(reply.status, RegisterStatus::Registered);
  EXPECT_TRUE(reply.wanted.empty()) << "it would be refused again";
  EXPECT_TRUE(
      reply.meshes.starts_with("1 contents are beyond the 0 MB of all robots; 1 contents "
                               "were not taken: mesh: is not a zlib stream of 44 bytes; "))
      << reply.meshes;
  RobotRegistry none(*store_, {.max_mesh_bytes = 0});
  EXPECT_EQ(none.register_robot(uploading, 2).meshes, "");
  EXPECT_TRUE(none.register_robot(uploading, 2).wanted.empty());
  EXPECT_EQ(store_->mesh_use().count, 0U);
}

TEST_F(Registry, MeshesAreKnownFromMemoryWhileASharedStoreCannotBeReached) {
  store::TroubledStore shared(*store_);
  shared.has_others = true;
  RobotRegistry registry(shared);
  registry.register_robot(with_named_meshes(), 1);
  shared.on_register = shared.on_robot_read = [] {
    throw Failure(ErrorCode::Storage, "the database does not answer");
  };
  const auto known = registry.register_known(with_named_meshes());
  ASSERT_TRUE(known);
  EXPECT_EQ(known->wanted.size(), 2U);
  RobotDescription uploading = with_named_meshes();
  uploading.contents = {bar().content()};
  EXPECT_FALSE(registry.register_known(uploading)) << "that is to be written";
}

TEST_F(Registry, UnknownRobotsAreNotFound) {
  const auto found = registry_.find(Digest{});
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::NotFound);
  EXPECT_EQ(found.error().message, "robot 000000000000 is not known here; register it first");
}

TEST_F(Registry, ADescriptionThatReadsAsAnotherRobotIsNotUsed) {
  const Digest wrong = fleet::chain_of(fleet::pupil()).digest();
  ASSERT_TRUE(store_->register_robot(
      {.digest = wrong, .description = fleet::teacher(), .dof = 3, .registered_ms = 1}));
  const auto found = registry_.find(wrong);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::Storage) << "nobody's report is refused for it";
}

TEST_F(Registry, KeepsThoseThatWereUsedLast) {
  std::vector<std::string> unreadable;
  RobotRegistry registry(*store_, {.max_robots = 2, .on_unreadable = [&](const std::string& why) {
                                     unreadable.push_back(why);
                                   }});
  std::vector<Digest> robots;
  for (const char* const label : {"a", "b", "c"})
    robots.push_back(
        registry.register_robot(fleet::planar(label, {0.1 * (label[0] - 'a' + 1), 0.3}), 1).robot);
  EXPECT_EQ(registry.in_memory(), 2U);
  EXPECT_EQ(registry.find_in_memory(robots[0]), nullptr);
  EXPECT_TRUE(registry.find(robots[0])) << "it is read again";
  EXPECT_EQ(registry.find_in_memory(robots[1]), nullptr) << "it was not used for longest";
  EXPECT_NE(registry.find_in_memory(robots[2]), nullptr);
  EXPECT_TRUE(unreadable.empty());
  store::damage_robot(directory_ / "fleet.db", "b");
  EXPECT_FALSE(registry.find(robots[1]));
  EXPECT_EQ(unreadable.size(), 1U);
}

TEST_F(Registry, ADamagedRobotIsAnErrorOfTheStoreAndNoException) {
  const Digest robot = RobotRegistry(*store_).register_robot(fleet::teacher(), 1).robot;
  store::damage_robot(directory_ / "fleet.db", "teacher");
  const auto found = registry_.find(robot);
  ASSERT_FALSE(found);
  EXPECT_EQ(found.error().code, ErrorCode::Storage);
}

}  // namespace
}  // namespace kinship::runtime::robot_registry_test
