// The C library without a server: what it refuses, and in which words; what works all the same.

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "client/c/kinship.h"
#include "client/c/kinship_planning.h"
#include "proto/security/security_folder.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/client/planner/planar_problem.hpp"

extern "C" int version_is_told_in_c(void);

namespace kinship::c_library_test {
namespace {

constexpr double kIdentity[7] = {0, 0, 0, 0, 0, 0, 1};

class CLibraryOffline : public testing::Test {
 protected:
  CLibraryOffline() {
    kinship_client_options options{};
    options.size = sizeof options;
    options.domain = domain_.number();
    options.outbox = outbox_.c_str();
    options.timeout_ms = 200;
    EXPECT_EQ(kinship_client_open(&options, &client_), KINSHIP_OK) << kinship_error_text();
    description_.size = sizeof description_;
    description_.label = "panda";
    description_.urdf = panda_.urdf.c_str();
    description_.base_link = panda_.base_link.c_str();
    description_.tip_link = panda_.tip_link.c_str();
    attempt_.size = sizeof attempt_;
    attempt_.robot = &robot_;
    attempt_.task = "sweep";
    attempt_.T_task_base = kIdentity;
    attempt_.solved = 1;
    attempt_.waypoints = waypoints_;
    attempt_.waypoint_count = 2;
    attempt_.dof = 7;
  }
  void TearDown() override { kinship_client_close(client_); }

  /// So that it may be reported of.
  void register_panda() {
    EXPECT_EQ(kinship_register(client_, &description_, &robot_, nullptr), KINSHIP_UNAVAILABLE);
  }

  static void expect_refused(kinship_code code, const std::string& text) {
    EXPECT_EQ(code, KINSHIP_INVALID_INPUT);
    EXPECT_NE(std::string(kinship_error_text()).find(text), std::string::npos)
        << "no '" << text << "' in: " << kinship_error_text();
  }

  test::ReservedDomain domain_;
  test::TemporaryDirectory directory_;
  const std::string outbox_ = (directory_ / "outbox").string();
  const RobotDescription panda_ = test::model_description("panda");
  kinship_client* client_ = nullptr;
  kinship_robot robot_{};
  kinship_robot_description description_{};
  kinship_attempt attempt_{};
  double waypoints_[14] = {0, 0, 0, -1, 0, 1, 0, 0.5, 0, 0, -1, 0, 1, 0};
};

TEST(CLibrary, TellsItsVersionAlsoInC) {
  EXPECT_STREQ(kinship_version(), KINSHIP_EXPECTED_VERSION);
  EXPECT_EQ(version_is_told_in_c(), 1);
}

TEST_F(CLibraryOffline, TheEnvironmentSaysWhatOptionsLeaveToIt) {
  kinship_client_options options{};
  options.size = sizeof options;
  options.domain = domain_.number();
  options.without_outbox = 1;
  options.timeout_ms = 200;
  const auto open = [&] {
    kinship_client* client = nullptr;
    const kinship_code code = kinship_client_open(&options, &client);
    kinship_client_close(client);
    return code == KINSHIP_OK ? "" : std::string(kinship_error_text());
  };
  setenv("KINSHIP_DOMAIN", "231", 1);
  setenv("KINSHIP_TIMEOUT", "never", 1);
  EXPECT_EQ(open(), "") << "what is said needs no environment";
  options.domain = KINSHIP_ENVIRONMENT;
  EXPECT_EQ(open(), "KINSHIP_DOMAIN '231' is not a domain from 0 to 230");
  setenv("KINSHIP_DOMAIN", std::to_string(domain_.number()).c_str(), 1);
  EXPECT_EQ(open(), "");
  options.timeout_ms = 0;
  EXPECT_EQ(open(), "KINSHIP_TIMEOUT 'never' is no time from 0.01 to 86400 s");
  unsetenv("KINSHIP_TIMEOUT");
  setenv("KINSHIP_SERVER", "<no host>", 1);
  EXPECT_NE(open().find("'<no host>'"), std::string::npos) << open();
  options.server = "127.0.0.1";
  EXPECT_EQ(open(), "");
  unsetenv("KINSHIP_SERVER");
  unsetenv("KINSHIP_DOMAIN");
}

TEST_F(CLibraryOffline, CredentialsThatEndSoonAreTold) {
  EXPECT_STREQ(kinship_client_warning(client_), "");
  EXPECT_STREQ(kinship_client_warning(nullptr), "");
  const auto now = std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now());
  const auto fleet =
      security::SecurityFolder::init(directory_ / "fleet", security::kDefaultDays, now);
  const std::string credentials = (directory_ / "r1").string();
  fleet.add({.name = "r1", .days = std::chrono::days(20)}, credentials, now);
  const test::ReservedDomain domain;  // one with security is another one
  kinship_client_options options{};
  options.size = sizeof options;
  options.domain = domain.number();
  options.without_outbox = 1;
  options.security = credentials.c_str();
  kinship_client* client = nullptr;
  ASSERT_EQ(kinship_client_open(&options, &client), KINSHIP_OK) << kinship_error_text();
  const std::string warning = kinship_client_warning(client);
  EXPECT_EQ(warning.find("the credentials of 'r1' expire in "), 0U) << warning;
  kinship_client_close(client);
}

TEST_F(CLibraryOffline, ARobotIsKnownByItsKinematicsAndItsReportsWait) {
  size_t dof = 0;
  EXPECT_EQ(kinship_register(client_, &description_, &robot_, &dof), KINSHIP_UNAVAILABLE);
  EXPECT_EQ(dof, 7U);
  RobotDescription same = panda_;
  same.T_tip_transfer.setIdentity();
  EXPECT_TRUE(std::ranges::equal(robot_.digest,
                                 kinematics::read_chain(same).value_or_throw().digest().bytes));
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_OK) << kinship_error_text();
  kinship_outbox outbox{};
  outbox.size = sizeof outbox;
  EXPECT_EQ(kinship_flush(client_, 10, &outbox), KINSHIP_UNAVAILABLE);
  EXPECT_EQ(outbox.pending, 1U);
  EXPECT_EQ(outbox.size, sizeof outbox);
}

TEST_F(CLibraryOffline, AFetchEndsAtItsDeadlineWithoutADistribution) {
  kinship_request request{};
  request.size = sizeof request;
  request.robot = &robot_;
  request.task = "sweep";
  request.deadline_ms = 50;
  auto* distribution =
      reinterpret_cast<kinship_distribution*>(this);  // NOLINT: any that is not null
  EXPECT_EQ(kinship_fetch(client_, &request, &distribution), KINSHIP_UNAVAILABLE);
  EXPECT_EQ(distribution, nullptr);
  kinship_follower* follower = nullptr;
  for (const double* const T_task_base : {static_cast<const double*>(nullptr), kIdentity}) {
    request.T_task_base = T_task_base;
    ASSERT_EQ(kinship_follower_open(client_, &request, &follower), KINSHIP_OK);
    EXPECT_EQ(kinship_follower_newer(follower, nullptr, 0, &distribution), KINSHIP_UNAVAILABLE);
    kinship_follower_close(follower);
  }
}

TEST_F(CLibraryOffline, PathsAreRecalledForARobotThatTheClientRegistered) {
  kinship_request request{};
  request.size = sizeof request;
  request.robot = &robot_;
  request.task = "sweep";
  request.deadline_ms = 50;
  request.T_task_base = kIdentity;
  request.with_recall = 1;
  kinship_recall* recall = nullptr;
  kinship_follower* follower = nullptr;
  EXPECT_EQ(kinship_fetch_recall(client_, &request, &recall), KINSHIP_NOT_FOUND);
  EXPECT_EQ(kinship_follower_open(client_, &request, &follower), KINSHIP_NOT_FOUND);
  EXPECT_NE(std::string(kinship_error_text()).find("was not registered by this client"),
            std::string::npos);
  EXPECT_EQ(kinship_register(client_, &description_, &robot_, nullptr), KINSHIP_UNAVAILABLE);
  EXPECT_EQ(kinship_fetch_recall(client_, &request, &recall), KINSHIP_UNAVAILABLE);
  ASSERT_EQ(kinship_follower_open(client_, &request, &follower), KINSHIP_OK);
  EXPECT_EQ(kinship_follower_recall(follower, nullptr, &recall), KINSHIP_PENDING);
  kinship_follower_close(follower);
  request.with_recall = 0;
  ASSERT_EQ(kinship_follower_open(client_, &request, &follower), KINSHIP_OK);
  expect_refused(kinship_follower_recall(follower, nullptr, &recall), "with_recall");
  kinship_follower_close(follower);
  request.start = waypoints_;
  expect_refused(kinship_fetch_recall(client_, &request, &recall), "start_dof is 0");
  EXPECT_EQ(recall, nullptr);
}

TEST_F(CLibraryOffline, WhatBreaksARuleIsRefusedWithNameAndValue) {
  expect_refused(kinship_report(nullptr, &attempt_), "client is NULL");
  expect_refused(kinship_report(client_, nullptr), "attempt is NULL");
  attempt_.size = 0;
  expect_refused(kinship_report(client_, &attempt_), "attempt: its size is 0");
  attempt_.size = sizeof attempt_;
  attempt_.dof = 1000;
  expect_refused(kinship_report(client_, &attempt_), "attempt->dof is 1000");
  attempt_.dof = 7;
  attempt_.waypoint_count = 1;
  expect_refused(kinship_report(client_, &attempt_), "attempt->waypoint_count is 1");
  attempt_.waypoint_count = 2;
  waypoints_[3] = std::numeric_limits<double>::quiet_NaN();
  expect_refused(kinship_report(client_, &attempt_), "finite");
  waypoints_[3] = 0;
  const double no_pose[7] = {0, 0, 0, 0, 0, 0, 2};
  attempt_.T_task_base = no_pose;
  expect_refused(kinship_report(client_, &attempt_), "attempt->T_task_base: ");
  description_.tip_link = "nowhere";
  expect_refused(kinship_register(client_, &description_, &robot_, nullptr), "nowhere");
  expect_refused(kinship_report_line(client_, "{}"), "");
}

TEST_F(CLibraryOffline, HeldJointsAndAxesArePartOfARobot) {
  const RobotDescription planar = guided::test::planar_description();
  kinship_held_joint held = {"j4", 0.5};
  description_.urdf = planar.urdf.c_str();
  description_.base_link = "base";
  description_.tip_link = "l3";
  description_.label = "planar";
  description_.axes = "x,y,yaw";
  description_.held_joints = &held;
  description_.held_joint_count = 1;
  EXPECT_EQ(kinship_register(client_, &description_, &robot_, nullptr), KINSHIP_UNAVAILABLE);
  RobotDescription same = planar;
  same.tip_link = "l3";
  same.T_tip_transfer.setIdentity();
  same.held_joints = {{"j4", 0.5}};
  EXPECT_TRUE(std::ranges::equal(robot_.digest,
                                 kinematics::read_chain(same).value_or_throw().digest().bytes));
  held.name = "j5";
  expect_refused(kinship_register(client_, &description_, &robot_, nullptr), "'j5'");
  held.name = nullptr;
  expect_refused(kinship_register(client_, &description_, &robot_, nullptr), "held_joints is NULL");
  description_.axes = "x,z,yam";
  expect_refused(kinship_register(client_, &description_, &robot_, nullptr), "'yam'");
}

TEST_F(CLibraryOffline, ARobotInFilesIsTheOneThatACommandLineNames) {
  kinship_robot_file file{};
  file.size = sizeof file;
  const std::string folder = test::source_dir() + "/robots/models/ur10e";
  file.source = folder.c_str();
  size_t dof = 0;
  EXPECT_EQ(kinship_register_file(client_, &file, &robot_, &dof), KINSHIP_UNAVAILABLE);
  EXPECT_EQ(dof, 6U);
  EXPECT_TRUE(std::ranges::equal(
      robot_.digest,
      kinematics::read_chain(test::model_description("ur10e")).value_or_throw().digest().bytes));
  const std::string urdf = folder + "/robot.urdf";
  file.source = urdf.c_str();
  expect_refused(kinship_register_file(client_, &file, &robot_, nullptr), "base");
  file.source = nullptr;
  expect_refused(kinship_register_file(client_, &file, &robot_, nullptr), "file->source is NULL");
}

TEST_F(CLibraryOffline, MeshesAreToldAsSolidsAroundThem) {
  std::ofstream(directory_ / "box.stl") << test::BoxMesh({0.1, 0.1, 0.1}).text_stl();
  std::ofstream(directory_ / "arm.urdf")
      << "<robot name='arm'><link name='base'/><link name='tool'><collision><geometry><mesh "
         "filename='package://arm/box.stl'/></geometry></collision></link><joint name='j' "
         "type='revolute'><parent link='base'/><child link='tool'/><axis xyz='0 0 1'/><limit "
         "lower='-1' upper='1' effort='1' velocity='1'/></joint></robot>";
  const std::string source = (directory_ / "arm.urdf").string();
  const std::string package = "arm=" + directory_.path().string();
  const char* const packages[] = {package.c_str()};
  kinship_robot_file file{};
  file.size = sizeof file;
  file.source = source.c_str();
  file.base_link = "base";
  file.tip_link = "tool";
  expect_refused(kinship_register_file(client_, &file, &robot_, nullptr), "package://arm/box.stl");
  file.packages = packages;
  file.package_count = 1;
  EXPECT_EQ(kinship_register_file(client_, &file, &robot_, nullptr), KINSHIP_UNAVAILABLE)
      << kinship_error_text();
}

TEST_F(CLibraryOffline, LinksThatNeedNoSolidAreThere) {
  kinship_robot_file file{};
  file.size = sizeof file;
  const std::string folder = test::source_dir() + "/robots/models/ur10e";
  file.source = folder.c_str();
  file.collision_from_visual = 1;
  EXPECT_EQ(kinship_register_file(client_, &file, &robot_, nullptr), KINSHIP_UNAVAILABLE);
  const char* const links[] = {"elbow"};
  file.without_collision = links;
  file.without_collision_count = 1;
  expect_refused(kinship_register_file(client_, &file, &robot_, nullptr), "'elbow'");
  file.size = offsetof(kinship_robot_file, collision_from_visual);  // of an older caller
  EXPECT_EQ(kinship_register_file(client_, &file, &robot_, nullptr), KINSHIP_UNAVAILABLE);
}

/// A table, and a cup in the hand, which may touch it.
struct TableAndCup {
  kinship_object objects[2] = {};
  const char* allowed[2] = {"table", "cup"};

  explicit TableAndCup(kinship_attempt& attempt) {
    objects[0] = {sizeof(kinship_object), "table", KINSHIP_BOX, 0, {1, 2, 0.1},
                  {0, 0, -1, 0, 0, 0, 1}};
    objects[1] = {sizeof(kinship_object),  "cup", KINSHIP_CYLINDER, 1, {0.04, 0.1, 0},
                  {0, 0, 0.05, 0, 0, 0, 1}};
    attempt.objects = objects;
    attempt.object_count = 2;
    attempt.allowed_collisions = allowed;
    attempt.allowed_collision_pairs = 1;
  }
};

TEST_F(CLibraryOffline, AReportThatItsRobotCannotHaveMadeFailsInTheCall) {
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_NOT_FOUND);
  EXPECT_NE(std::string(kinship_error_text()).find("register it"), std::string::npos)
      << kinship_error_text();
  register_panda();
  attempt_.dof = 6;
  expect_refused(kinship_report(client_, &attempt_), "robot 'panda' (");
  expect_refused(kinship_report(client_, &attempt_), "has 7 joints, the report's path has 6");
  kinship_outbox outbox{};
  outbox.size = sizeof outbox;
  EXPECT_EQ(kinship_flush(client_, 0, &outbox), KINSHIP_OK);
  EXPECT_EQ(outbox.refused, 0U);
  EXPECT_STREQ(outbox.last_refusal, "");
  // The outbox knows it, also of another program.
  kinship_client_close(client_);
  kinship_client_options options{};
  options.size = sizeof options;
  options.domain = domain_.number();
  options.outbox = outbox_.c_str();
  options.resend = "some";
  expect_refused(kinship_client_open(&options, &client_), "'some' is neither 'all' nor 'none'");
  options.resend = "none";
  ASSERT_EQ(kinship_client_open(&options, &client_), KINSHIP_OK) << kinship_error_text();
  expect_refused(kinship_report(client_, &attempt_), "has 7 joints");
  attempt_.dof = 7;
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_OK) << kinship_error_text();
}

TEST_F(CLibraryOffline, AnAttemptTellsItsScene) {
  register_panda();
  TableAndCup scene(attempt_);
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_OK) << kinship_error_text();
  scene.objects[1].shape = static_cast<kinship_shape>(6);
  expect_refused(kinship_report(client_, &attempt_), "object 'cup': its shape is 6");
  scene.objects[1].shape = KINSHIP_SPHERE;
  scene.objects[1].sizes[0] = -1;
  expect_refused(kinship_report(client_, &attempt_), "'cup'");
  scene.objects[1].sizes[0] = 1;
  scene.allowed[1] = "saucer";
  expect_refused(kinship_report(client_, &attempt_), "saucer");
  scene.allowed[1] = "cup";
  scene.objects[1].pose[6] = 3;
  expect_refused(kinship_report(client_, &attempt_), "object 'cup'");
  scene.objects[1].pose[6] = 1;
  scene.objects[1].size = sizeof(kinship_object) + 8;
  expect_refused(kinship_report(client_, &attempt_), "object 1: its size is ");
}

TEST_F(CLibraryOffline, ASceneWithoutObjectsIsToldAndNoneIsNot) {
  register_panda();
  TableAndCup scene(attempt_);
  attempt_.object_count = 0;
  expect_refused(kinship_report(client_, &attempt_), "'table'");
  attempt_.allowed_collision_pairs = 0;
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_OK) << kinship_error_text();
  attempt_.objects = nullptr;
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_OK) << kinship_error_text();
  attempt_.allowed_collision_pairs = 1;
  expect_refused(kinship_report(client_, &attempt_), "attempt->allowed_collision_pairs is 1");
  attempt_.allowed_collision_pairs = 0;
  attempt_.object_count = 2;
  expect_refused(kinship_report(client_, &attempt_), "attempt->objects");
}

TEST_F(CLibraryOffline, ObjectsOfANewerCallerAreSteppedOverByTheirSize) {
  struct Newer {
    kinship_object object;
    double something_new;
  } objects[2] = {};
  for (Newer& each : objects) {
    each.object = {sizeof(Newer), "box", KINSHIP_BOX, 0, {1, 1, 1}, {0, 0, 0, 0, 0, 0, 1}};
    each.something_new = std::numeric_limits<double>::quiet_NaN();
  }
  register_panda();
  objects[1].object.name = "other";
  attempt_.objects = &objects[0].object;
  attempt_.object_count = 2;
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_OK) << kinship_error_text();
}

/// The line that kinship.h shows, for this robot.
std::string line_of_the_header(const std::string& digest) {
  const std::string header = test::read_text(test::source_dir() + "/client/c/kinship.h");
  const std::size_t begin = header.find("{\"report_uuid\"");
  std::string line = header.substr(begin, header.find("*/", begin) - begin);
  std::erase(line, '*');
  std::erase(line, '\n');
  const std::string shortened = "30a1...";
  return line.replace(line.find(shortened), shortened.size(), digest);
}

TEST_F(CLibraryOffline, TheLineInTheHeaderIsOne) {
  EXPECT_EQ(kinship_report_line(client_, line_of_the_header(std::string(64, 'a')).c_str()),
            KINSHIP_NOT_FOUND)
      << kinship_error_text();
  EXPECT_NE(std::string(kinship_error_text()).find("robot aaaa"), std::string::npos)
      << "all else is well: " << kinship_error_text();
  expect_refused(kinship_report_line(client_, line_of_the_header("panda").c_str()), "'panda'");
}

// Who was compiled with a release finds each member where it was. New ones come at the end: the
// number of bytes grows, what stands here stays.
TEST(CLibrary, MembersStayWhereTheyAre) {
  EXPECT_EQ(offsetof(kinship_client_options, timeout_ms), 36U);
  EXPECT_EQ(offsetof(kinship_client_options, security), 40U);
  EXPECT_EQ(offsetof(kinship_client_options, resend), 48U);
  EXPECT_EQ(offsetof(kinship_robot_description, never_colliding_pairs), 56U);
  EXPECT_EQ(offsetof(kinship_robot_description, held_joint_count), 80U);
  EXPECT_EQ(offsetof(kinship_robot_file, package_count), 88U);
  EXPECT_EQ(offsetof(kinship_robot_file, without_collision_count), 112U);
  EXPECT_EQ(offsetof(kinship_robot_file, xacro_count), 128U);
  EXPECT_EQ(offsetof(kinship_object, pose), 48U);
  EXPECT_EQ(offsetof(kinship_object, point_count), 112U);
  EXPECT_EQ(offsetof(kinship_query, user), 120U);
  EXPECT_EQ(offsetof(kinship_plan_info, planner), 72U);
  EXPECT_EQ(sizeof(kinship_held_joint), 16U);
  EXPECT_EQ(offsetof(kinship_attempt, share), 112U);
  EXPECT_EQ(offsetof(kinship_attempt, allowed_collision_pairs), 144U);
  EXPECT_EQ(offsetof(kinship_attempt, processor_time_s), 152U);
  EXPECT_EQ(offsetof(kinship_outbox, refused), 24U);
  EXPECT_EQ(offsetof(kinship_outbox, kept), 40U);
  EXPECT_EQ(offsetof(kinship_request, deadline_ms), 40U);
  EXPECT_EQ(offsetof(kinship_request, with_recall), 64U);
  EXPECT_EQ(offsetof(kinship_request, to_configuration), 80U);
  EXPECT_EQ(offsetof(kinship_distribution_info, recommended_share), 40U);
  EXPECT_EQ(sizeof(kinship_robot), 32U);
  EXPECT_EQ(offsetof(kinship_surroundings, allowed_collision_pairs), 40U);
  EXPECT_EQ(offsetof(kinship_proof, least_clearance_m), 56U);
  EXPECT_EQ(offsetof(kinship_recall_query, step), 96U);
  EXPECT_EQ(offsetof(kinship_recalled, checks), 32U);
}

TEST_F(CLibraryOffline, AShorterStructureOfAnOlderCallerIsRead) {
  register_panda();
  attempt_.size = offsetof(kinship_attempt, sampling);
  attempt_.sampling = static_cast<kinship_sampling>(77);  // not looked at
  EXPECT_EQ(kinship_report(client_, &attempt_), KINSHIP_OK) << kinship_error_text();
}

TEST(CLibrary, EachThreadHasItsOwnErrorText) {
  EXPECT_EQ(kinship_report(nullptr, nullptr), KINSHIP_INVALID_INPUT);
  const std::string here = kinship_error_text();
  std::thread([] { EXPECT_STREQ(kinship_error_text(), ""); }).join();
  EXPECT_EQ(kinship_error_text(), here);
}

}  // namespace
}  // namespace kinship::c_library_test
