// The C library without a server: what it refuses, and in which words; what works all the same.

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <limits>
#include <string>
#include <thread>

#include "client/c/kinship.h"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

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
  ASSERT_EQ(kinship_follower_open(client_, &request, &follower), KINSHIP_OK);
  EXPECT_EQ(kinship_follower_newer(follower, nullptr, 0, &distribution), KINSHIP_UNAVAILABLE);
  kinship_follower_close(follower);
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

TEST_F(CLibraryOffline, AShorterStructureOfAnOlderCallerIsRead) {
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
