#include "proto/json/admin_rows_json.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/json/robot_answers_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json::summaries_json_test {
namespace {

/// Law: what was read writes the same text again, so every member went both ways.
template <typename Summary, typename Read>
void expect_same_text_again(const Summary& summary, Read read) {
  const std::string text = to_json(summary);
  const auto back = read(text);
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(to_json(*back), text);
}

Digest digest_of(std::uint8_t byte) {
  Digest digest;
  digest.bytes.fill(byte);
  return digest;
}

TEST(SummariesJson, RobotIsReadBack) {
  const RobotSummary robot{digest_of(1), "panda", "base", "hand",       7,
                           "numeric",    60,      64,     1234567890123};
  EXPECT_EQ(
      to_json(robot),
      R"({"robot":")" + digest_of(1).hex() +
          R"(","label":"panda","base_link":"base","tip_link":"hand","dof":7,)"
          R"("solver":"numeric","paths":60,"attempts":64,"registered_ms":1234567890123,"geometry":"","geometry_ms":0})");
  expect_same_text_again(robot, row_from_json<RobotSummary>);
}

TEST(SummariesJson, TaskIsReadBack) {
  TaskSummary task{"bin_to_shelf", 100, 120, {}};
  task.robots.push_back({digest_of(2), "panda", 60, 70, 12});
  task.robots.push_back({digest_of(3), "iiwa14", 40, 50, 11});
  expect_same_text_again(task, row_from_json<TaskSummary>);
}

TEST(SummariesJson, PathIsReadBack) {
  PathSummary path;
  path.robot = digest_of(4);
  path.label = "panda";
  path.task = "bin_to_shelf";
  path.machine = "cell 3";
  path.record.outcome = Outcome::Solved;
  path.record.distribution_id = digest_of(5);
  path.record.share = 0.1;
  path.waypoints = 17;
  path.length = 1.0 / 3.0;
  path.received_ms = 5;
  path.retired_ms = 6;
  expect_same_text_again(path, row_from_json<PathSummary>);
  path.T_task_base = Eigen::Isometry3d::Identity();
  expect_same_text_again(path, row_from_json<PathSummary>);
}

TEST(SummariesJson, AttemptIsReadBack) {
  AttemptSummary attempt;
  attempt.robot = digest_of(4);
  attempt.label = "panda";
  attempt.task = "bin_to_shelf";
  attempt.record.outcome = Outcome::Timeout;
  attempt.record.collision_checks = 12;
  attempt.received_ms = 5;
  expect_same_text_again(attempt, row_from_json<AttemptSummary>);
}

TEST(SummariesJson, DistributionIsReadBack) {
  expect_same_text_again(
      DistributionSummary{digest_of(6), 2, "bin_to_shelf", digest_of(7), "ur10e",
                          std::string(kMaxProfileBytes, 'p'), DistributionState::Failed,
                          "nothing within reach", 0, 0, 120, 99},
      row_from_json<DistributionSummary>);
}

TEST(SummariesJson, StatusIsReadBack) {
  ServerStatus status;
  status.version = "0.1.0";
  status.store_file = "/var/lib/kinship/store.sqlite";
  status.schema_version = 1;
  std::uint64_t value = 10;  // every counter another value: none is taken for its neighbour
  for (std::uint64_t* counter :
       {&status.uptime_s, &status.robots, &status.tasks, &status.paths, &status.attempts,
        &status.distributions, &status.reports_received, &status.reports_refused, &status.fetches,
        &status.fetches_from_memory, &status.fits, &status.queued_reports, &status.queued_fits,
        &status.followed, &status.jobs, &status.rehearsals, &status.queued_rehearsals,
        &status.rollbacks, &status.store_bytes})
    *counter = ++value;
  status.rehearsal_time_s = 74.25;
  status.writable = false;
  status.storage_message = "disk full";
  UpstreamStatus upstream;
  upstream.name = "postgresql://memory/kinship";
  upstream.connected = true;
  upstream.since_ms = 1;
  for (std::uint64_t* counter :
       {&upstream.tries, &upstream.waiting, &upstream.sent, &upstream.received, &upstream.refused,
        &upstream.left_out, &upstream.retired_above, &upstream.retired_here, &upstream.tasks})
    *counter = ++value;
  status.upstream = upstream;
  status.replicas = {{"postgresql://db2/kinship", value + 1, value + 2, value + 3, "it is behind"}};
  expect_same_text_again(status, row_from_json<ServerStatus>);
  EXPECT_EQ(row_from_json<ServerStatus>(to_json(status))->upstream->tasks, value);
  EXPECT_EQ(row_from_json<ServerStatus>(to_json(status))->replicas.at(0).failed, value + 3);
}

TEST(SummariesJson, StatusOfAServerThatRehearsesNothingIsRead) {
  ServerStatus status;
  status.fits = 3;
  std::string text = to_json(status);
  text = text.substr(0, text.find(R"(,"rehearsals")")) + "}";
  const auto read = row_from_json<ServerStatus>(text);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(to_json(*read), to_json(status));
  status.rehearsal_time_s = -1;
  EXPECT_EQ(row_from_json<ServerStatus>(to_json(status)).error().message,
            "rehearsal_time_s: -1 is below 0");
}

TEST(SummariesJson, RegisteredRobotNamesTheSameArms) {
  RegisterReply reply;
  reply.status = RegisterStatus::Known;
  reply.robot = digest_of(8);
  reply.dof = 6;
  reply.solver = "closed form";
  reply.same_arms = {"ur10e_1", "ur10e_2"};
  reply.geometry_grade = GeometryGrade::Exact;
  reply.took_geometry = true;
  reply.geometry = "3 links by exact shapes";
  EXPECT_EQ(to_json(reply, "ur10e_3"),
            R"({"robot":")" + digest_of(8).hex() +
                R"(","label":"ur10e_3","known":true,"dof":6,"solver":"closed form",)"
                R"("same_arms":["ur10e_1","ur10e_2"],"geometry":"3 links by exact shapes",)"
                R"("geometry_grade":"exact","took_geometry":true})");
}

TEST(SummariesJson, RowOfAnotherKindIsRefusedByItsMissingMember) {
  const auto refused = row_from_json<RobotSummary>(to_json(ServerStatus{}));
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "robot: is missing");
}

TEST(SummariesJson, CountersMustFit) {
  std::string text = to_json(RobotSummary{});
  const std::string member = "\"dof\":0";
  text.replace(text.find(member), member.size(), "\"dof\":4294967296");
  EXPECT_EQ(row_from_json<RobotSummary>(text).error().message,
            "dof: 4294967296 exceeds 4294967295");
}

}  // namespace
}  // namespace kinship::json::summaries_json_test
