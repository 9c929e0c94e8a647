// Plans of the C library: among solids, meshes and voxels, guided, stopped, reported.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <sstream>
#include <string>
#include <vector>

#include "client/c/kinship_planning.h"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/places.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::c_planning_test {
namespace {

constexpr size_t kDof = 7;
using Configuration = std::array<double, kDof>;

Configuration turned(double base_rad) { return {base_rad, 0.5, 0, -1.5, 0, 2, 0.785}; }

/// A post in the middle of a turn of the Panda's arm.
const std::array<double, 7> kPostPose = {0.6, 0, 0.4, 0, 0, 0, 1};
constexpr std::array<double, 3> kPostSize = {0.05, 0.05, 0.8};

/// The same post by its surface: twelve triangles.
std::vector<double> post_triangles() {
  const auto at = [](int corner) {
    return std::array<double, 3>{((corner & 1) != 0 ? 0.5 : -0.5) * kPostSize[0],
                                 ((corner & 2) != 0 ? 0.5 : -0.5) * kPostSize[1],
                                 ((corner & 4) != 0 ? 0.5 : -0.5) * kPostSize[2]};
  };
  constexpr std::array<std::array<int, 4>, 6> kFaces = {
      {{0, 1, 3, 2}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 3, 7, 6}, {0, 2, 6, 4}, {1, 3, 7, 5}}};
  std::vector<double> points;
  for (const auto& [a, b, c, d] : kFaces)
    for (const int corner : {a, b, c, a, c, d})
      for (const double coordinate : at(corner))
        points.push_back(coordinate);
  return points;
}

/// The same post as cubes of 5 cm.
std::vector<double> post_voxels() {
  std::vector<double> points;
  for (int i = -8; i < 8; ++i)
    for (const double coordinate : {0.025, 0.025, 0.025 + 0.05 * i})
      points.push_back(coordinate);
  return points;
}

/// What waits in an outbox.
std::string pending_report(const std::filesystem::path& outbox) {
  std::ostringstream text;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(outbox))
    if (entry.path().extension() == ".json")
      text << std::ifstream(entry.path()).rdbuf();
  return text.str();
}

class CPlanning : public testing::Test {
 protected:
  CPlanning() {
    kinship_robot_file file{};
    file.size = sizeof file;
    const std::string folder = test::source_dir() + "/robots/models/panda";
    file.source = folder.c_str();
    size_t dof = 0;
    EXPECT_EQ(kinship_planner_create(&file, &planner_, &dof), KINSHIP_OK) << kinship_error_text();
    EXPECT_EQ(dof, kDof);
    post_.size = sizeof post_;
    post_.name = "post";
    post_.shape = KINSHIP_BOX;
    std::ranges::copy(kPostSize, post_.sizes);
    std::ranges::copy(kPostPose, post_.pose);
    surroundings_.size = sizeof surroundings_;
    surroundings_.objects = &post_;
    surroundings_.object_count = 1;
    query_.size = sizeof query_;
    query_.surroundings = &surroundings_;
    query_.dof = kDof;
    query_.start = start_.data();
    query_.goals = goal_.data();
    query_.goal_count = 1;
    info_.size = sizeof info_;
    kinship_world* world = nullptr;
    EXPECT_EQ(kinship_world_create(&file, &surroundings_, &world, nullptr), KINSHIP_OK);
    world_ = world;
  }
  void TearDown() override {
    kinship_plan_free(plan_);
    kinship_world_free(world_);
    kinship_planner_free(planner_);
  }

  void plan() {
    kinship_plan_free(plan_);
    plan_ = nullptr;
    ASSERT_EQ(kinship_plan_find(planner_, &query_, &plan_), KINSHIP_OK) << kinship_error_text();
    ASSERT_EQ(kinship_plan_describe(plan_, &info_), KINSHIP_OK) << kinship_error_text();
  }
  std::vector<double> path() {
    std::vector<double> waypoints(info_.waypoint_count * info_.dof);
    EXPECT_EQ(kinship_plan_copy(plan_, waypoints.data()), KINSHIP_OK) << kinship_error_text();
    return waypoints;
  }
  /// Whether a path is proven to miss the post, of whatever it is made.
  bool misses_the_post(const std::vector<double>& waypoints) {
    kinship_proof proof{};
    proof.size = sizeof proof;
    EXPECT_EQ(kinship_world_path_free(world_, waypoints.data(), waypoints.size() / kDof, kDof,
                                      KINSHIP_CLEARANCE_M / 2, &proof),
              KINSHIP_OK)
        << kinship_error_text();
    return proof.is_free == 1;
  }
  void expect_around_the_post() {
    ASSERT_NO_FATAL_FAILURE(plan());
    ASSERT_EQ(info_.is_solved, 1) << info_.reason;
    EXPECT_STREQ(info_.reason, "");
    EXPECT_GT(info_.waypoint_count, 2U);  // the straight line is not free
    EXPECT_GT(info_.collision_checks, 0U);
    const std::vector<double> waypoints = path();
    EXPECT_TRUE(std::equal(start_.begin(), start_.end(), waypoints.begin()));
    EXPECT_TRUE(std::equal(goal_.rbegin(), goal_.rend(), waypoints.rbegin()));
    EXPECT_TRUE(misses_the_post(waypoints));
  }
  void expect_refused(const std::string& text) {
    EXPECT_EQ(kinship_plan_find(planner_, &query_, &plan_), KINSHIP_INVALID_INPUT);
    EXPECT_EQ(plan_, nullptr);
    EXPECT_NE(std::string(kinship_error_text()).find(text), std::string::npos)
        << "no '" << text << "' in: " << kinship_error_text();
  }

  const Configuration start_ = turned(-0.7), goal_ = turned(0.7);
  kinship_planner* planner_ = nullptr;
  kinship_world* world_ = nullptr;  // with the box
  kinship_object post_{};
  kinship_surroundings surroundings_{};
  kinship_query query_{};
  kinship_plan* plan_ = nullptr;
  kinship_plan_info info_{};
};

TEST_F(CPlanning, APathKeepsToItsRegion) {
  kinship_region region{};
  region.size = sizeof region;
  const double upright[] = {0.2, 0.2, 4};
  ASSERT_EQ(kinship_region_keep_orientation(upright, 0, &region), KINSHIP_OK);
  EXPECT_EQ(region.upper[0], HUGE_VAL);
  EXPECT_EQ(region.upper[5], HUGE_VAL);
  EXPECT_NEAR(region.upper[3], 0.2 / std::numbers::sqrt2, 1e-12);
  EXPECT_EQ(region.lower[4], -region.upper[4]);
  region.T_task_region[3] = 1;  // the hand points down
  region.T_region_end[6] = 1;
  query_.region = &region;
  plan();
  ASSERT_EQ(info_.is_solved, 1) << info_.reason;
  EXPECT_STREQ(info_.planner, "CBiRRT2");
  const auto waypoints = path();
  EXPECT_TRUE(misses_the_post(waypoints));
  const kinematics::Chain chain =
      kinematics::read_chain(test::model_description("panda")).value_or_throw();
  for (std::size_t i = 0; i < info_.waypoint_count; ++i) {
    const Eigen::Map<const Eigen::VectorXd> q(&waypoints[i * kDof], kDof);
    EXPECT_LT(kinematics::T_base_transfer(chain, q).linear()(2, 2), -std::cos(0.2)) << i;
  }
  query_.algorithm = "rrtconnect";
  plan();
  EXPECT_EQ(info_.is_solved, 0);
  EXPECT_NE(std::string(info_.reason).find("does not keep to a constraint"), std::string::npos);
  query_.algorithm = nullptr;
  region.lower[3] = 1;
  kinship_plan* none = nullptr;
  EXPECT_EQ(kinship_plan_find(planner_, &query_, &none), KINSHIP_INVALID_INPUT);
  EXPECT_EQ(std::string(kinship_error_text()).find("query->region: "), 0U) << kinship_error_text();
  const double rolling[] = {0.2, 4, 0.2};
  EXPECT_EQ(kinship_region_keep_orientation(rolling, 0, &region), KINSHIP_INVALID_INPUT);
  EXPECT_NE(std::string(kinship_error_text()).find("bound no tilt"), std::string::npos);
}

TEST_F(CPlanning, APathLeadsAroundABoxAMeshAndVoxels) {
  std::vector<double> straight(start_.begin(), start_.end());
  straight.insert(straight.end(), goal_.begin(), goal_.end());
  ASSERT_FALSE(misses_the_post(straight));
  ASSERT_NO_FATAL_FAILURE(expect_around_the_post());
  const std::vector<double> first = path();
  ASSERT_NO_FATAL_FAILURE(plan());
  EXPECT_EQ(path(), first);  // an equal seed
  const std::vector<double> triangles = post_triangles(), voxels = post_voxels();
  post_.shape = KINSHIP_MESH;
  post_.points = triangles.data();
  post_.point_count = triangles.size() / 3;
  ASSERT_NO_FATAL_FAILURE(expect_around_the_post());
  post_.shape = KINSHIP_VOXELS;
  post_.sizes[0] = 0.05;
  post_.points = voxels.data();
  post_.point_count = voxels.size() / 3;
  post_.pose[0] -= 0.025;  // a middle is half an edge beside the grid's corner
  post_.pose[1] -= 0.025;
  ASSERT_NO_FATAL_FAILURE(expect_around_the_post());
}

TEST_F(CPlanning, WhatIsHeldHangsOnTheHandAlsoAsAMesh) {
  std::vector<double> corners;
  for (const double x : {0.0, 0.3, 0.0})
    for (const double coordinate : {x, 0.0, 0.1})
      corners.push_back(coordinate);
  corners[7] = 0.01;
  kinship_object both[2] = {post_, post_};
  both[1].name = "sheet";
  both[1].shape = KINSHIP_MESH;
  both[1].is_held = 1;
  both[1].points = corners.data();
  both[1].point_count = 3;
  for (size_t i = 0; i < 7; ++i)
    both[1].pose[i] = i == 6 ? 1 : 0;
  surroundings_.objects = both;
  surroundings_.object_count = 2;
  const char* allowed[] = {"sheet", "shed"};
  surroundings_.allowed_collisions = allowed;
  surroundings_.allowed_collision_pairs = 1;
  ASSERT_NO_FATAL_FAILURE(expect_refused("shed"));
  surroundings_.allowed_collision_pairs = 0;
  ASSERT_NO_FATAL_FAILURE(plan());
  EXPECT_EQ(info_.is_solved, 1) << info_.reason;
  corners[0] = corners[1] = -3;  // as wide as the room: it touches at the start
  corners[3] = corners[7] = 3;
  ASSERT_NO_FATAL_FAILURE(plan());
  EXPECT_EQ(info_.is_solved, 0);
  EXPECT_NE(std::string(info_.reason).find("sheet"), std::string::npos) << info_.reason;
  both[1].shape = KINSHIP_VOXELS;
  kinship_plan_free(plan_);
  plan_ = nullptr;
  expect_refused("voxels cannot be held");
}

TEST_F(CPlanning, WhyThereIsNoPathIsTold) {
  post_.pose[0] = 0.45;
  post_.sizes[1] = 3;  // a wall
  post_.sizes[0] = 0.02;
  post_.sizes[2] = 3;
  ASSERT_NO_FATAL_FAILURE(plan());
  EXPECT_EQ(info_.is_solved, 0);
  EXPECT_NE(std::string(info_.reason).find("post"), std::string::npos) << info_.reason;
  double waypoint[kDof];
  EXPECT_EQ(kinship_plan_copy(plan_, waypoint), KINSHIP_NOT_FOUND);
}

TEST_F(CPlanning, AnObjectThatIsNoneIsRefused) {
  post_.shape = KINSHIP_MESH;
  ASSERT_NO_FATAL_FAILURE(expect_refused("points"));
  const double points[6] = {};
  post_.points = points;
  post_.point_count = 2;
  ASSERT_NO_FATAL_FAILURE(expect_refused("three points a triangle"));
  post_.shape = KINSHIP_VOXELS;
  post_.sizes[0] = 0;
  ASSERT_NO_FATAL_FAILURE(expect_refused("voxels are 0 m wide"));
  post_.shape = KINSHIP_BOX;
  post_.sizes[0] = 0.1;
  query_.dof = 6;
  ASSERT_NO_FATAL_FAILURE(expect_refused("query->dof is 6"));
  query_.dof = kDof;
  query_.algorithm = "prm";
  expect_refused("prm");
}

TEST_F(CPlanning, StopEndsIt) {
  int calls = 0;
  query_.user = &calls;
  query_.stop = [](void* user) { return ++*static_cast<int*>(user) > 3 ? 1 : 0; };
  ASSERT_NO_FATAL_FAILURE(plan());
  EXPECT_EQ(info_.is_stopped, 1);
  EXPECT_EQ(info_.is_solved, 0);
  EXPECT_EQ(calls, 4);
}

TEST_F(CPlanning, AReportTellsTheSceneAndAStoppedPlanHasNone) {
  const test::TemporaryDirectory directory;
  const std::string outbox = (directory / "outbox").string();
  kinship_client_options options{};
  options.size = sizeof options;
  options.outbox = outbox.c_str();
  kinship_client* client = nullptr;
  options.timeout_ms = 200;
  ASSERT_EQ(kinship_client_open(&options, &client), KINSHIP_OK) << kinship_error_text();
  kinship_robot robot{};
  kinship_robot_file file{};
  file.size = sizeof file;
  const std::string folder = test::source_dir() + "/robots/models/panda";
  file.source = folder.c_str();
  EXPECT_EQ(kinship_register_file(client, &file, &robot, nullptr), KINSHIP_UNAVAILABLE);
  const std::vector<double> triangles = post_triangles();
  post_.shape = KINSHIP_MESH;
  post_.points = triangles.data();
  post_.point_count = triangles.size() / 3;
  ASSERT_NO_FATAL_FAILURE(plan());
  EXPECT_EQ(kinship_plan_report(client, plan_, "sweep", "cell"), KINSHIP_OK)
      << kinship_error_text();
  const std::string report = pending_report(outbox);
  EXPECT_NE(report.find("\"post\""), std::string::npos) << report;
  EXPECT_NE(report.find("\"approximate\""), std::string::npos) << report;
  EXPECT_NE(report.find("\"sweep\""), std::string::npos) << report;
  for (const std::string measure : {"\"hand_length_m\":", "\"least_clearance_m\":"}) {
    EXPECT_NE(report.find(measure), std::string::npos) << report;
    EXPECT_EQ(report.find(measure + "0.0,"), std::string::npos) << report;
    EXPECT_EQ(report.find(measure + "0.0}"), std::string::npos) << report;
  }
  query_.stop = [](void*) { return 1; };
  ASSERT_NO_FATAL_FAILURE(plan());
  EXPECT_EQ(kinship_plan_report(client, plan_, "sweep", "cell"), KINSHIP_INVALID_INPUT);
  kinship_client_close(client);
}

}  // namespace
}  // namespace kinship::c_planning_test
