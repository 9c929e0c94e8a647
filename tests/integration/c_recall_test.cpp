// Paths that kinshipd makes of what a client of the C library reported, fetched, followed and tried
// by it. Nothing but the C library joins DDS in this process.

#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "client/c/kinship.h"
#include "client/c/kinship_planning.h"
#include "proto/types/pose.hpp"
#include "robots/planning/birrt.hpp"
#include "robots/planning/configuration_sampler.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/unit/robots/recall/shelf_cell.hpp"

namespace kinship::c_recall_test {
namespace {

using recall::PosedQuery;
using recall::test_support::ShelfCell;

constexpr size_t kDof = 7;
constexpr uint32_t kEnough_ms = 120'000;

std::vector<kinship_object> objects_of(const PosedQuery& posed) {
  std::vector<kinship_object> objects;
  for (const SceneObject& object : posed.surroundings.scene.objects) {
    kinship_object box{};
    box.size = sizeof box;
    box.name = object.name.c_str();
    std::ranges::copy(std::get<BoxShape>(object.shape).size, box.sizes);
    std::ranges::copy(to_pose_array(object.T_task_object), box.pose);
    objects.push_back(box);
  }
  return objects;
}

class CRecalls : public testing::Test {
 protected:
  CRecalls() {
    const std::string outbox = (directory_ / "outbox").string();
    kinship_client_options options{};
    options.size = sizeof options;
    options.domain = domain_.number();
    options.outbox = outbox.c_str();
    options.timeout_ms = kEnough_ms;
    EXPECT_EQ(kinship_client_open(&options, &client_), KINSHIP_OK) << kinship_error_text();
    request_.size = sizeof request_;
    request_.robot = &robot_;
    request_.task = "reach";
    request_.deadline_ms = kEnough_ms;
    request_.with_recall = 1;
  }
  void TearDown() override {
    kinship_recall_free(recall_);
    kinship_client_close(client_);
  }

  void register_robot() {
    const std::string folder = test::source_dir() + "/robots/models/panda";
    kinship_robot_file file{};
    file.size = sizeof file;
    file.source = folder.c_str();
    ASSERT_EQ(kinship_register_file(client_, &file, &robot_, nullptr), KINSHIP_OK)
        << kinship_error_text();
  }
  /// A uniform plan, with its scene.
  void report(const PosedQuery& posed, const double* T_task_base = nullptr) {
    collision::CollisionWorld world(cell_.solids, posed.surroundings);
    std::mt19937_64 generator(1);
    const auto plan =
        planning::plan_birrt(posed.start, posed.goals, planning::free_in(world),
                             planning::ConfigurationSampler(posed.bounds), {}, generator);
    ASSERT_TRUE(plan.waypoints);
    const std::vector<kinship_object> objects = objects_of(posed);
    kinship_attempt attempt{};
    attempt.size = sizeof attempt;
    attempt.robot = &robot_;
    attempt.task = "reach";
    attempt.T_task_base = T_task_base;
    attempt.solved = 1;
    attempt.waypoints = plan.waypoints->data();
    attempt.waypoint_count = static_cast<size_t>(plan.waypoints->cols());
    attempt.dof = kDof;
    attempt.collision_checks = plan.collision_checks;
    attempt.planning_time_s = 0.1;
    attempt.objects = objects.data();
    attempt.object_count = objects.size();
    ASSERT_EQ(kinship_report(client_, &attempt), KINSHIP_OK) << kinship_error_text();
  }
  void report_all() {
    for (const PosedQuery& posed : cell_.queries(0, 30))
      ASSERT_NO_FATAL_FAILURE(report(posed));
    ASSERT_EQ(kinship_flush(client_, kEnough_ms, nullptr), KINSHIP_OK) << kinship_error_text();
  }
  /// Whether a path is recalled for a query, which is free then.
  bool recalls(const PosedQuery& posed) {
    collision::CollisionWorld world(cell_.solids, posed.surroundings);
    const std::vector<kinship_object> objects = objects_of(posed);
    std::vector<double> waypoints(kDof * KINSHIP_RECALL_WAYPOINTS);
    kinship_recall_query query{};
    query.size = sizeof query;
    query.dof = kDof;
    query.start = posed.start.data();
    query.goals = posed.goals.data();
    query.goal_count = static_cast<size_t>(posed.goals.cols());
    query.objects = objects.data();
    query.object_count = objects.size();
    query.user = &world;
    query.is_free = [](void* user, const double* q, size_t dof) {
      return static_cast<collision::CollisionWorld*>(user)->collides(
                 Eigen::Map<const Eigen::VectorXd>(q, static_cast<Eigen::Index>(dof)))
                 ? 0
                 : 1;
    };
    kinship_recalled recalled{};
    recalled.size = sizeof recalled;
    EXPECT_EQ(
        kinship_recall_path(recall_, &query, waypoints.data(), KINSHIP_RECALL_WAYPOINTS, &recalled),
        KINSHIP_OK)
        << kinship_error_text();
    for (size_t i = 0; i < recalled.waypoint_count; ++i)
      EXPECT_FALSE(world.collides(Eigen::Map<const Eigen::VectorXd>(&waypoints[i * kDof], kDof)));
    return recalled.is_recalled != 0;
  }

  const ShelfCell cell_;
  const test::TemporaryDirectory directory_;
  const test::ReservedDomain domain_;
  kinship_client* client_ = nullptr;
  kinship_robot robot_{};
  kinship_request request_{};
  kinship_recall* recall_ = nullptr;
};

TEST_F(CRecalls, ARobotStandsWhereItLastReportedTheTask) {
  const test::ServerProcess::Options served{.store = directory_ / "fleet.db",
                                            .domain = domain_.number()};
  std::optional<test::ServerProcess> server(served);
  ASSERT_NO_FATAL_FAILURE(register_robot());
  const double here[7] = {0.5, 0, 0, 0, 0, 0, 1};
  const std::vector<PosedQuery> queries = cell_.queries(0, 6);
  for (const PosedQuery& posed : queries)
    ASSERT_NO_FATAL_FAILURE(report(posed, here));
  ASSERT_EQ(kinship_flush(client_, kEnough_ms, nullptr), KINSHIP_OK) << kinship_error_text();
  kinship_distribution* fetched = nullptr;
  request_.T_task_base = nullptr;
  ASSERT_EQ(kinship_fetch(client_, &request_, &fetched), KINSHIP_OK) << kinship_error_text();

  // A follower that is opened without a server asks the one that comes.
  server.reset();
  kinship_follower* follower = nullptr;
  ASSERT_EQ(kinship_follower_open(client_, &request_, &follower), KINSHIP_OK)
      << kinship_error_text();
  server.emplace(served);
  kinship_distribution* followed = nullptr;
  ASSERT_EQ(kinship_follower_newer(follower, nullptr, kEnough_ms, &followed), KINSHIP_OK)
      << kinship_error_text();
  kinship_follower_close(follower);

  const std::string folder = test::source_dir() + "/robots/models/panda";
  kinship_robot_file file{};
  file.size = sizeof file;
  file.source = folder.c_str();
  kinship_planner* planner = nullptr;
  ASSERT_EQ(kinship_planner_create(&file, &planner, nullptr), KINSHIP_OK) << kinship_error_text();
  kinship_surroundings around{};
  around.size = sizeof around;
  kinship_query query{};
  query.size = sizeof query;
  query.surroundings = &around;
  query.dof = kDof;
  query.start = queries[0].start.data();
  query.goals = queries[0].goals.data();
  query.goal_count = 1;
  kinship_plan* plan = nullptr;
  for (const kinship_distribution* made : {followed, fetched}) {
    query.distribution = made;
    EXPECT_EQ(kinship_plan_find(planner, &query, &plan), KINSHIP_INVALID_INPUT);
    EXPECT_STREQ(
        kinship_error_text(),
        "T_task_base is not given, so identity, the guidance was made for 0.5 0 0 0 0 0 1");
  }
  around.T_task_base = here;
  EXPECT_EQ(kinship_plan_find(planner, &query, &plan), KINSHIP_OK) << kinship_error_text();
  kinship_plan_free(plan);
  kinship_planner_free(planner);
  kinship_distribution_free(followed);
  kinship_distribution_free(fetched);
}

TEST_F(CRecalls, WhatTheServerMadeOfReportsAnswersQueries) {
  const test::ServerProcess::Options here{.store = directory_ / "fleet.db",
                                          .domain = domain_.number()};
  std::optional<test::ServerProcess> server(here);
  ASSERT_NO_FATAL_FAILURE(register_robot());
  EXPECT_EQ(kinship_fetch_recall(client_, &request_, &recall_), KINSHIP_NO_EXPERIENCE);
  EXPECT_EQ(recall_, nullptr);
  ASSERT_NO_FATAL_FAILURE(report_all());
  kinship_distribution* fetched = nullptr;
  ASSERT_EQ(kinship_fetch(client_, &request_, &fetched), KINSHIP_OK) << kinship_error_text();
  kinship_distribution_free(fetched);
  request_.deadline_ms = 0;  // the first rehearsal begins now
  EXPECT_EQ(kinship_fetch_recall(client_, &request_, &recall_), KINSHIP_PENDING);
  request_.deadline_ms = kEnough_ms;
  ASSERT_EQ(kinship_fetch_recall(client_, &request_, &recall_), KINSHIP_OK) << kinship_error_text();
  int recalled = 0;
  for (const PosedQuery& posed : cell_.queries(100, 8)) {
    // Fetched anew, without what this client saw fail: a plan is cheap here, a few failures make
    // paths not worth their checks.
    kinship_recall_free(recall_);
    ASSERT_EQ(kinship_fetch_recall(client_, &request_, &recall_), KINSHIP_OK)
        << kinship_error_text();
    recalled += recalls(posed) ? 1 : 0;
  }
  EXPECT_GT(recalled, 0);

  // The follower's are the same: nothing was reported since.
  kinship_follower* follower = nullptr;
  ASSERT_EQ(kinship_follower_open(client_, &request_, &follower), KINSHIP_OK);
  kinship_distribution* distribution = nullptr;
  ASSERT_EQ(kinship_follower_newer(follower, nullptr, kEnough_ms, &distribution), KINSHIP_OK)
      << kinship_error_text();
  kinship_recall* followed = nullptr;
  EXPECT_EQ(kinship_follower_recall(follower, recall_, &followed), KINSHIP_PENDING);
  EXPECT_EQ(followed, nullptr);
  EXPECT_EQ(kinship_follower_recall(follower, nullptr, &followed), KINSHIP_OK)
      << kinship_error_text();
  kinship_recall_free(followed);

  // What was reported is retired. The follower asks a server that comes up at once, and loses what
  // was made of it.
  const test::Answer reset = test::run_to_end(
      "kinship",
      {"--domain", std::to_string(domain_.number()), "tasks", "reset", "reach", "--yes"});
  ASSERT_EQ(reset.code, 0) << reset.err;
  server.reset();
  server.emplace(here);
  kinship_distribution* newer = nullptr;
  while (kinship_follower_newer(follower, distribution, 100, &newer) != KINSHIP_NO_EXPERIENCE)
    ASSERT_EQ(newer, nullptr);
  EXPECT_EQ(kinship_follower_recall(follower, recall_, &followed), KINSHIP_NO_EXPERIENCE);
  EXPECT_EQ(followed, nullptr);
  EXPECT_EQ(kinship_follower_recall(follower, nullptr, &followed), KINSHIP_PENDING);
  kinship_distribution_free(distribution);
  kinship_follower_close(follower);
}

}  // namespace
}  // namespace kinship::c_recall_test
