#include "proto/json/experience_line.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/json/event_json.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/json/task_experience_json.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::json::documents_test {
namespace {

constexpr std::uint64_t kSeed = 17;

std::string message_of(const std::string& text) {
  const auto line = experience_line_from_json(text);
  return line ? "accepted" : line.error().message;
}

TEST(ExperienceLine, AttemptIsReadBack) {
  Attempt attempt = test::RandomValues(kSeed).attempt();
  attempt.T_task_base = Eigen::Isometry3d::Identity();
  const std::string text = to_json(attempt);
  const ExperienceLine line = experience_line_from_json(text).value_or_throw();
  ASSERT_TRUE(std::holds_alternative<NamedAttempt>(line));
  EXPECT_EQ(to_json(std::get<NamedAttempt>(line).attempt), text);
  EXPECT_EQ(std::get<NamedAttempt>(line).label, "");
}

TEST(ExperienceLine, AttemptMayNameItsRobotByLabel) {
  const Attempt attempt = test::RandomValues(kSeed).attempt();
  std::string text = to_json(attempt);
  text.replace(text.find(attempt.robot.hex()), 64, "panda");
  const ExperienceLine line = experience_line_from_json(text).value_or_throw();
  EXPECT_EQ(std::get<NamedAttempt>(line).label, "panda");
  EXPECT_EQ(std::get<NamedAttempt>(line).attempt.robot, Digest{});
}

TEST(ExperienceLine, WhatIsNeitherIsRefusedByName) {
  EXPECT_EQ(message_of("{}"),
            "line of an experience file: needs a member robot_description or report_uuid");
  EXPECT_EQ(message_of(R"({"robot_description":null})"),
            "line of an experience file: needs a member robot_description or report_uuid");
  EXPECT_EQ(message_of(R"({"robot_description":7})"),
            "robot_description: must be an object, is number");
  EXPECT_EQ(message_of(R"({"robot_description":{"label":"my robot"}})"),
            "label: byte 3 is not one of A-Z a-z 0-9 _ . : -");
  EXPECT_EQ(message_of(R"({"report_uuid":"7"})"), "report_uuid: '7' is not a UUID (8-4-4-4-12)");
}

RobotDescription planar_arm() {
  RobotDescription description;
  description.label = "planar-3";
  description.urdf = "<robot name=\"p\">\n  <link name=\"a\"/>\n</robot>";
  description.base_link = "base";
  description.tip_link = "tip";
  description.task_axes.matters = {true, true, false, false, false, true};
  description.held_joints = {{"lift", 0.25}, {"head", -1}};
  description.never_colliding = {{"a", "b"}, {"b", "c"}};
  return description;
}

TEST(DocumentFormat, IsTheFirstMemberAndNotWrittenTwice) {
  EXPECT_EQ(in_format({"robot removal", 2, "-list"}, R"({"rows":[]})"),
            R"({"format":"kinship.robot-removal-list/2","rows":[]})");
  EXPECT_EQ(in_format(kProblemFormat, "{}"), R"({"format":"kinship.problem/1"})");
  const std::string written = in_format(kProblemFormat, R"({"name":"a"})");
  EXPECT_EQ(in_format(kResultFormat, written), written);
}

/// What a reader of problems says of a document with this format.
std::string problem_in(const std::string& format) {
  const auto read = problem_from_json(R"({"name": "a", "format": )" + format +
                                      R"(, "start": [0], "goal": {"configurations": [[1]]}})");
  return read ? "accepted" : read.error().message;
}

TEST(DocumentFormat, AnotherNameAndALaterVersionAreRefusedByBothNames) {
  EXPECT_EQ(problem_in(R"("kinship.problem/1")"), "accepted");
  EXPECT_EQ(problem_in("null"), "accepted");
  EXPECT_EQ(problem_in(R"("kinship.problem/2")"),
            "format: 'kinship.problem/2' is newer than 'kinship.problem/1', the newest that this "
            "program reads");
  for (const char* wrong :
       {"kinship.result/1", "kinship.problem", "kinship.problem/", "kinship.problem/0",
        "kinship.problem/1x", "kinship.problem/-1", "kinship.problem/99999999999", "problem/1", ""})
    EXPECT_EQ(problem_in('"' + std::string(wrong) + '"'),
              "format: '" + std::string(wrong) + "' is not 'kinship.problem/1'");
  EXPECT_EQ(problem_in("1"), "format: must be a string, is number");
}

TEST(DocumentFormat, LinesOfAnExperienceFileAreOfTwo) {
  const std::string attempt = to_json(test::RandomValues(kSeed).attempt());
  const auto with = [&](std::string text, const std::string& from, const std::string& format) {
    return message_of(text.replace(text.find(from), from.size(), format));
  };
  EXPECT_EQ(with(attempt, "kinship.attempt/1", "kinship.experience-robot/1"),
            "format: 'kinship.experience-robot/1' is not 'kinship.attempt/1'");
  EXPECT_EQ(with(to_experience_line(planar_arm()), "kinship.experience-robot/1", "kinship.event/1"),
            "format: 'kinship.event/1' is not 'kinship.experience-robot/1'");
}

TEST(EventJson, IsALine) {
  const Event event{.kind = EventKind::Fit,
                    .time_ms = 1000,
                    .task = "bin_to_shelf",
                    .robot = "panda",
                    .text = "revision 3 \"ready\""};
  EXPECT_EQ(to_json(event),
            R"({"format":"kinship.event/1","time_ms":1000,"kind":"fit","task":"bin_to_shelf",)"
            R"("robot":"panda","text":"revision 3 \"ready\""})");
}

TEST(RobotDescriptionJson, MeshSolidsAreReadBackAndLeftOutWhereThereAreNone) {
  RobotDescription written = planar_arm();
  EXPECT_EQ(to_json(written).find("mesh_solids"), std::string::npos);
  written.mesh_solids.solids = {{"a", CylinderShape{0.1, 0.2}}, {"b", SphereShape{0.4}}};
  written.mesh_solids.unfiltered = {{"a", "b"}};
  const auto back = robot_description_from_json(to_json(written));
  ASSERT_TRUE(back) << back.error().message;
  ASSERT_EQ(back->mesh_solids.solids.size(), 2U);
  EXPECT_EQ(back->mesh_solids.solids[0].link, "a");
  EXPECT_EQ(std::get<CylinderShape>(back->mesh_solids.solids[0].shape).length_m, 0.2);
  EXPECT_EQ(back->mesh_solids.unfiltered, written.mesh_solids.unfiltered);
}

TEST(RobotDescriptionJson, AxesAreWrittenByName) {
  EXPECT_NE(to_json(planar_arm()).find(R"("task_axes":["x","y","yaw"])"), std::string::npos);
  const auto refused = robot_description_from_json(
      R"({"label": "a", "urdf": "", "base_link": "b", "tip_link": "t", "task_axes": ["w"]})");
  ASSERT_FALSE(refused);
  EXPECT_EQ(refused.error().message, "task_axes: 'w' is not one of x, y, z, roll, pitch, yaw");
}

TEST(RobotDescriptionJson, AllAxesMatterIfNothingIsSaid) {
  const auto read = robot_description_from_json(
      R"({"label": "a", "urdf": "", "base_link": "b", "tip_link": "t"})");
  ASSERT_TRUE(read);
  EXPECT_TRUE(read->task_axes.all());
}

TEST(RobotDescriptionJson, SizesAreLimited) {
  RobotDescription description = planar_arm();
  description.urdf.assign(1'000'001, ' ');
  EXPECT_EQ(robot_description_from_json(to_json(description)).error().message,
            "urdf: 1000001 bytes exceed 1000000");
  description = planar_arm();
  for (int i = 0; i < 64; ++i)
    description.held_joints["joint_" + std::to_string(i)] = 0;
  EXPECT_EQ(robot_description_from_json(to_json(description)).error().message,
            "held_joints: 66 members exceed 64");
}

TEST(TaskExperienceJson, HasPathsWithTheirPosesAndARevisionThatNoReaderRounds) {
  TaskExperience experience;
  experience.revision = 0xfedcba9876543210;
  experience.paths_known = 9;
  PosePath path;
  path.source.bytes.fill(0xab);
  path.path = Uuid::parse("00112233-4455-6677-8899-aabbccddeeff").value();
  path.poses = {Eigen::Isometry3d::Identity(), Eigen::Isometry3d(Eigen::Translation3d(1, 2.5, -3))};
  experience.paths = {path};
  EXPECT_EQ(
      to_json(experience),
      R"({"format":"kinship.task-experience/1","revision":"fedcba9876543210","paths_known":9,"paths":[)"
      R"({"path":"00112233-4455-6677-8899-aabbccddeeff","source":")" +
          path.source.hex() +
          R"(","poses":[[0.0,0.0,0.0,0.0,0.0,0.0,1.0],[1.0,2.5,-3.0,0.0,0.0,0.0,1.0]]}]})");
  EXPECT_EQ(
      to_json(TaskExperience{.revision = 1, .paths_known = 0, .paths = {}}),
      R"({"format":"kinship.task-experience/1","revision":"0000000000000001","paths_known":0,"paths":[]})");
}

}  // namespace
}  // namespace kinship::json::documents_test

namespace kinship::json::recorded_search_json_test {
namespace {

RecordedSearch small_search() {
  RecordedSearch search{"shelf 7", Eigen::MatrixXd(2, 3), {-1, -1, 0}, {1, 2, 30}, {0, 2, 1}};
  search.nodes << 0.1, 0.2, 0.3, 1.1, 1.2, 1.3;
  return search;
}

std::string message_of(const RecordedSearch& search) {
  const auto read = recorded_search_from_json(to_json(search));
  return read ? "accepted" : read.error().message;
}

TEST(RecordedSearchJson, IsWhatItWas) {
  const RecordedSearch search = small_search();
  const auto back = recorded_search_from_json(to_json(search));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->name, search.name);
  EXPECT_EQ(back->nodes, search.nodes);
  EXPECT_EQ(back->parents, search.parents);
  EXPECT_EQ(back->checks, search.checks);
  EXPECT_EQ(back->path, search.path);
}

TEST(RecordedSearchJson, ASearchThatWasNotRecordedIsEmpty) {
  const auto back = recorded_search_from_json(to_json(RecordedSearch{"ompl", {}, {}, {}, {}}));
  ASSERT_TRUE(back) << back.error().message;
  EXPECT_EQ(back->nodes.cols(), 0);
}

TEST(RecordedSearchJson, WhatIsNoTreeIsRefused) {
  RecordedSearch search = small_search();
  search.parents[2] = 2;
  EXPECT_NE(message_of(search).find("parents[2]: must be -1 or an earlier node, is 2"),
            std::string::npos)
      << message_of(search);
  search = small_search();
  search.path = {0, 3};
  EXPECT_NE(message_of(search).find("path[1]: must be one of 3 nodes"), std::string::npos)
      << message_of(search);
  search = small_search();
  search.checks.pop_back();
  EXPECT_NE(message_of(search).find("3 nodes, 3 parents and 2 checks"), std::string::npos);
}

}  // namespace
}  // namespace kinship::json::recorded_search_json_test
