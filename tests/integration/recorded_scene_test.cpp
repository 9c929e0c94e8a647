// A scene on its way: kinship-plan reports it with its attempts, kinshipd keeps it once, and the
// configurations of another robot that would touch it are left out and counted.

#include <gtest/gtest.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "client/link/admin_rows.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/problem_json.hpp"
#include "tests/support/cell.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::recorded_scene_test {
namespace {

using std::chrono::seconds;

constexpr int kProblems = 5;

/// A Panda that turns in front of a wall, over a table and below a ceiling: room for its elbow, but
/// not for that of a UR10e that reaches over its shoulder.
Problem turn_before_the_wall(int number) {
  Problem problem;
  problem.name = "turn_" + std::to_string(number);
  problem.T_task_base = Eigen::Isometry3d::Identity();
  const Path sweep = test::panda_sweep(static_cast<std::uint64_t>(number));
  problem.start = sweep.waypoints().col(0);
  problem.goal_configurations = sweep.waypoints().rightCols(1);
  const auto at = [](double x, double z) {
    return Eigen::Isometry3d(Eigen::Translation3d(x, 0, z));
  };
  problem.scene.objects = {{"table", BoxShape{{2, 2, 0.1}}, at(0, -0.25)},
                           {"ceiling", BoxShape{{3, 3, 0.1}}, at(0, 1.0)},
                           {"wall", BoxShape{{0.05, 3, 3}}, at(-0.3, 0)}};
  problem.attached = {
      {"can", "palm", SphereShape{0.02}, at(0, 0.05), {"finger_left", "finger_right"}}};
  problem.allowed_collisions = {{"can", "table"}};
  return problem;
}

class RecordedScenes : public testing::Test {
 protected:
  RecordedScenes() {
    cell_.start();
    std::ofstream file(directory_ / "problems.jsonl");
    for (int i = 0; i < kProblems; ++i)
      file << json::to_json(turn_before_the_wall(i)) << '\n';
  }

  void plan_and_report(const std::string& more) {
    const test::Answer plan = cell_.run(
        "kinship-plan", (directory_ / "problems.jsonl").string() + " --model " +
                            test::source_dir() + "/robots/models/panda --label panda --task turn" +
                            " --guidance none --report --outbox " +
                            (directory_ / "plan_outbox").string() + " --output " +
                            (directory_ / "results.jsonl").string() + ' ' + more);
    ASSERT_EQ(plan.code, 0) << plan.err;
  }

  /// The attempts that `paths export` hands out.
  std::vector<Attempt> exported() {
    std::vector<Attempt> attempts;
    for (const std::string& row :
         link::rows_of(cell_.client(), {.verb = AdminVerb::ExportPaths}).value_or_throw()) {
      const json::ExperienceLine line = json::experience_line_from_json(row).value_or_throw();
      if (const auto* const named = std::get_if<json::NamedAttempt>(&line))
        attempts.push_back(named->attempt);
    }
    return attempts;
  }

  /// What a UR10e at the same place gets of the Panda's experience, as `explain` tells it.
  Source source_of_ur10e() {
    FetchRequest request;
    request.task = "turn";
    request.robot = cell_.register_model("ur10e").robot;
    request.T_task_base = Eigen::Isometry3d::Identity();
    request.deadline = seconds(120);
    const FetchReply reply = cell_.client().fetch(request).value_or_throw();
    EXPECT_TRUE(reply.distribution)
        << reply.message << "; planned: " << test::read_text(directory_ / "results.jsonl");
    const AdminReply row =
        cell_.ask(AdminVerb::ExplainDistribution, reply.distribution.value().id.hex());
    return json::row_from_json<Explanation>(row.rows.at(0))
        .value_or_throw()
        .distribution.sources.at(0);
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
};

TEST_F(RecordedScenes, LeaveOutWhatAnotherRobotWouldTouchThere) {
  plan_and_report("");
  const std::vector<Attempt> attempts = exported();
  ASSERT_EQ(attempts.size(), static_cast<std::size_t>(kProblems));
  for (const Attempt& attempt : attempts) {
    ASSERT_TRUE(attempt.scene);
    EXPECT_EQ(content_digest(*attempt.scene), content_digest(*attempts[0].scene));
  }
  ASSERT_EQ(attempts[0].scene->objects.size(), 3U);
  ASSERT_EQ(attempts[0].scene->held.size(), 1U);
  EXPECT_EQ(attempts[0].scene->held[0].name, "can");
  EXPECT_EQ(attempts[0].scene->allowed_collisions.size(), 1U);

  const Source source = source_of_ur10e();
  EXPECT_EQ(source.paths_with_scene, source.paths_used);
  EXPECT_GT(source.paths_with_scene, 0U);
  EXPECT_GT(source.scene_collisions, 0U);
  EXPECT_LT(source.scene_collisions, source.filter_checks);
  EXPECT_GT(source.configurations, 0U);
}

TEST_F(RecordedScenes, AreNotSentIfTheUserDoesNotWantIt) {
  plan_and_report("--record-scenes no");
  for (const Attempt& attempt : exported())
    EXPECT_FALSE(attempt.scene);
  const Source source = source_of_ur10e();
  EXPECT_GT(source.paths_used, 0U);
  EXPECT_EQ(source.paths_with_scene, 0U);
  EXPECT_EQ(source.scene_collisions, 0U);
}

}  // namespace
}  // namespace kinship::recorded_scene_test
