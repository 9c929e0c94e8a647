#include <gtest/gtest.h>

#include <limits>

#include "proto/codec/admin_codec.hpp"
#include "proto/codec/register_codec.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::codec::register_admin_codec_test {
namespace {

constexpr std::uint64_t kSeed = 34;

RobotDescription robot() { return test::RandomValues(kSeed).robot_description(); }

std::string complaint(const RobotDescription& description) {
  const auto error = validate(description);
  return error ? error->message : "";
}

TEST(RegisterCodec, NamesTheRuleThatADescriptionBreaks) {
  RobotDescription bad = robot();
  EXPECT_EQ(complaint(bad), "");
  bad.label = "my robot";
  EXPECT_EQ(complaint(bad), "label: byte 3 is not one of A-Z a-z 0-9 _ . : -");
  bad = robot();
  bad.urdf = "\xff";
  EXPECT_EQ(complaint(bad), "urdf: is not UTF-8");
  bad = robot();
  bad.urdf.assign(1'000'001, ' ');
  EXPECT_EQ(complaint(bad), "urdf: 1000001 bytes exceed 1000000");
  bad = robot();
  bad.tip_link = "";
  EXPECT_EQ(complaint(bad), "tip_link: is empty");
  bad = robot();
  bad.T_tip_transfer.translation().x() = 1001;
  EXPECT_EQ(complaint(bad).find("T_tip_transfer: pose: coordinate 1001"), 0U);
  bad = robot();
  bad.held_joints["finger"] = std::numeric_limits<double>::infinity();
  EXPECT_EQ(complaint(bad), "position of held joint: inf is not finite");
}

TEST(RegisterCodec, UrdfOfTheLargestSizeFitsIntoASample) {
  RobotDescription description = robot();
  description.urdf.assign(1'000'000, ' ');
  EXPECT_TRUE(encode({}, description));
}

TEST(RegisterCodec, MissingTextReadsAsEmptyAndIsRefused) {
  auto message = encode({}, robot()).value_or_throw();
  message.wire.base_link = nullptr;
  EXPECT_EQ(decode(message.wire).error().message, "base_link: is empty");
}

TEST(RegisterCodec, MoreHeldJointsThanMayBeAreRefused) {
  RobotDescription description = robot();
  description.held_joints.clear();
  for (std::size_t i = 0; i < kMaxHeldJoints; ++i)
    description.held_joints["joint_" + std::to_string(i)] = 0;
  auto message = encode({}, description).value_or_throw();
  EXPECT_TRUE(decode(message.wire));
  message.wire.held_joints._length = 65;  // counted before any is read
  EXPECT_EQ(decode(message.wire).error().message, "held_joints: 65 exceeds 64");
  description.held_joints["one more"] = 0;
  EXPECT_EQ(complaint(description), "held_joints: 65 exceeds 64");
}

TEST(RegisterCodec, JointHeldTwiceIsRefused) {
  RobotDescription description = robot();
  description.held_joints = {{"a", 0}, {"b", 0}};
  auto message = encode({}, description).value_or_throw();
  message.wire.held_joints._buffer[1].joint = message.wire.held_joints._buffer[0].joint;
  EXPECT_EQ(decode(message.wire).error().message, "held joint 'a': is there twice");
}

TEST(RegisterCodec, MeshSolidsThatAreNoneAreRefused) {
  RobotDescription bad = robot();
  bad.mesh_solids.solids = {{"arm", SphereShape{0}}};
  EXPECT_EQ(complaint(bad), "mesh_solids: 'arm': size 0 m is not above 0 and at most 1000 m");
  bad.mesh_solids.solids = {{"", SphereShape{1}}};
  EXPECT_EQ(complaint(bad), "mesh_solids: a link's name is empty");
  bad.mesh_solids.solids.assign(1025, {"arm", SphereShape{1}});
  EXPECT_EQ(complaint(bad), "mesh_solids: 1025 solids exceed 1024");
  bad.mesh_solids.solids.resize(1);
  auto message = encode({}, bad).value_or_throw();
  message.wire.mesh_solids._buffer[0].shape = 4;
  EXPECT_FALSE(decode(message.wire));
  message.wire.mesh_solids._buffer = nullptr;  // what a shorter message leaves
  EXPECT_TRUE(decode(message.wire).value_or_throw().mesh_solids.solids.empty());
}

TEST(RegisterCodec, MeshesThatBreakARuleAreRefusedByName) {
  RobotDescription bad = robot();
  bad.meshes = {{"arm"}};
  EXPECT_EQ(complaint(bad), "");
  bad.meshes[0].error_m = 0.001;
  EXPECT_EQ(complaint(bad), "meshes: 'arm': a mesh for collision is altered");
  bad.meshes[0].role = MeshRole::Visual;
  EXPECT_EQ(complaint(bad), "");
  bad.meshes[0].rgba = {0, 0, 0};
  EXPECT_EQ(complaint(bad), "meshes: 'arm': a colour of 3 numbers, not 4");
  bad.meshes[0].rgba = {0, 0, 0, std::numeric_limits<double>::quiet_NaN()};
  EXPECT_EQ(complaint(bad), "meshes: 'arm': colour nan is not between 0 and 1");
  bad.meshes.assign(257, {"arm"});
  EXPECT_EQ(complaint(bad), "meshes: 257 exceed 256");
  bad.meshes.resize(1);
  auto message = encode({}, bad).value_or_throw();
  message.wire.meshes._buffer[0].role = 3;
  EXPECT_FALSE(decode(message.wire));
  message.wire.meshes._buffer = nullptr;  // what a shorter message leaves
  message.wire.contents._buffer = nullptr;
  EXPECT_TRUE(decode(message.wire).value_or_throw().meshes.empty());
}

TEST(RegisterCodec, ContentsAreLimitedBeforeTheyAreCopied) {
  RobotDescription uploading = robot();
  uploading.contents = {{4 * 1024 * 1024, std::vector<std::uint8_t>(512 * 1024)}};
  auto message = encode({}, uploading).value_or_throw();
  EXPECT_EQ(decode(message.wire)->contents.at(0).zlib.size(), 512U * 1024);
  message.wire.contents._buffer[0].bytes += 1;
  EXPECT_EQ(decode(message.wire).error().message, "contents: bytes: 4194305 exceeds 4194304");
  message.wire.contents._buffer[0].bytes = 8;
  message.wire.contents._buffer[0].zlib._length += 1;  // refused before a byte is read
  EXPECT_EQ(decode(message.wire).error().message, "contents: zlib: 524289 exceeds 524288");
  uploading.contents.assign(65, {8, {1}});
  EXPECT_EQ(complaint(uploading), "contents: 65 exceeds 64");
}

TEST(RegisterCodec, SameArmsAreLimited) {
  RegisterReply reply;
  reply.same_arms.assign(1025, "ur10e");
  EXPECT_EQ(encode({}, reply).error().message, "same_arms: 1025 exceeds 1024");
  reply.same_arms = {std::string(65, 'x')};
  EXPECT_EQ(encode({}, reply).error().message, "same_arms: 65 bytes exceed 64");
  reply.same_arms = {"ur10e"};
  auto message = encode({}, reply).value_or_throw();
  message.wire.same_arms._length = 1025;  // refused before any is read
  EXPECT_EQ(decode(message.wire).error().message, "same_arms: 1025 exceeds 1024");
}

AdminRequest request_of(AdminVerb verb, const std::string& argument) {
  AdminRequest request;
  request.verb = verb;
  request.argument = argument;
  return request;
}

TEST(AdminCodec, DeadlineOfARequestComesBackAndIsLimited) {
  AdminRequest request = request_of(AdminVerb::ShowJob, "0a1b2c3d");
  request.deadline = std::chrono::hours(1);
  EXPECT_EQ(decode(encode({}, request)->wire)->deadline, std::chrono::hours(1));
  request.deadline += std::chrono::milliseconds(1);
  EXPECT_EQ(encode({}, request).error().message,
            "deadline_ms: 3600001 is not between 0 and 3600000");
  request.deadline = std::chrono::milliseconds(-1);
  EXPECT_FALSE(encode({}, request));
}

TEST(AdminCodec, AnArgumentIsLimited) {
  AdminRequest request = request_of(AdminVerb::Backup, std::string(128, 'f'));
  EXPECT_EQ(decode(encode({}, request)->wire)->argument, request.argument);
  request.argument += 'f';
  EXPECT_EQ(encode({}, request).error().message, "argument: 129 bytes exceed 128");
}

TEST(AdminCodec, LastRowMayContinueOnTheNextPage) {
  AdminReply reply{AdminStatus::Ok, {"{\"a\":"}, "next", "", true};
  EXPECT_TRUE(decode(encode({}, reply)->wire)->last_row_continues);
  reply.next_cursor.clear();
  EXPECT_EQ(encode({}, reply).error().message, "last_row_continues: without a row or a next page");
  reply = {AdminStatus::Ok, {}, "next", "", true};
  EXPECT_FALSE(encode({}, reply));
}

TEST(AdminCodec, PageIsLimited) {
  AdminReply reply;
  reply.rows.assign(2, std::string(300'000, 'x'));
  EXPECT_EQ(encode({}, reply).error().message, "rows (bytes): 600000 exceeds 524288");
  reply.rows.assign(1001, "x");
  EXPECT_EQ(encode({}, reply).error().code, ErrorCode::TooLarge);
}

TEST(Refusal, MessageIsCutBetweenCharacters) {
  std::string message(kMaxMessageBytes - 1, 'x');
  message += "üü";
  const RegisterReply reply = RegisterConversation::refuse({ErrorCode::InvalidInput, message});
  EXPECT_EQ(reply.message, message.substr(0, kMaxMessageBytes - 1));
  EXPECT_TRUE(encode({}, reply));
}

TEST(Refusal, AdminStatusTellsWhoseFaultItIs) {
  EXPECT_EQ(AdminConversation::refuse({ErrorCode::NotFound, ""}).status, AdminStatus::NotFound);
  EXPECT_EQ(AdminConversation::refuse({ErrorCode::InvalidInput, ""}).status, AdminStatus::Refused);
  EXPECT_EQ(AdminConversation::refuse({ErrorCode::Storage, ""}).status, AdminStatus::Failed);
}

}  // namespace
}  // namespace kinship::codec::register_admin_codec_test
