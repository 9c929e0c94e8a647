#include "proto/json/attempt_json.hpp"

#include <gtest/gtest.h>

#include <string>

namespace kinship::json::attempt_json_test {
namespace {

constexpr const char* kUuid = "01234567-89ab-4def-8123-456789abcdef";

std::string replaced(std::string text, std::string_view from, std::string_view to) {
  const std::size_t position = text.find(from);
  EXPECT_NE(position, std::string::npos) << from;
  return text.replace(position, from.size(), to);
}

std::string solved_line() {
  return std::string(R"({"report_uuid":")") + kUuid +
         R"(","task":"bin_to_shelf","robot":"panda-2",)" +
         R"("machine":"Zelle 3, Süd","T_task_base":[1,2,3,0,0,0,1],)"
         R"("waypoints":[[0.1,0.2],[0.3,0.4],[0.5,0.6]],)"
         R"("record":{"outcome":"solved","planner":"birrt","planner_options":"step=0.1",)"
         R"("planning_time_s":0.25,"collision_checks":1234,"projections":5,"time_limit_s":10,)"
         R"("sampling_mode":"guided","share":0.9,"distribution_id":")" +
         std::string(64, 'a') + R"(","distribution_revision":7},"scene":null})";
}

std::string message_of(const std::string& line) {
  const auto result = attempt_from_json(line);
  return result ? "accepted" : result.error().message;
}

TEST(AttemptJson, RobotOfSixtyFourDigitsIsADigest) {
  const std::string hex(64, 'B');
  const auto named = attempt_from_json(replaced(solved_line(), "panda-2", hex));
  ASSERT_TRUE(named);
  EXPECT_EQ(named->label, "");
  EXPECT_EQ(named->attempt.robot.hex(), std::string(64, 'b'));
}

TEST(AttemptJson, UnknownMembersAreIgnoredAndOptionalOnesMayBeMissing) {
  const std::string line =
      std::string(R"({"report_uuid":")") + kUuid +
      R"(","task":"t","robot":"r","new_member":{"a":[1]},)"
      R"("record":{"outcome":"timeout","planning_time_s":1,"collision_checks":2}})";
  const auto named = attempt_from_json(line);
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_FALSE(named->attempt.path);
  EXPECT_FALSE(named->attempt.T_task_base);
  EXPECT_EQ(named->attempt.record.sampling_mode, SamplingMode::Uniform);
}

TEST(AttemptJson, PathIsThereExactlyIfSolved) {
  EXPECT_EQ(message_of(replaced(solved_line(), "solved", "timeout")),
            "waypoints: must be null unless record.outcome is 'solved'");
  EXPECT_EQ(message_of(replaced(solved_line(), "[[0.1,0.2],[0.3,0.4],[0.5,0.6]]", "null")),
            "waypoints: must not be null if record.outcome is 'solved'");
  EXPECT_EQ(message_of(replaced(solved_line(), "[[0.1,0.2],[0.3,0.4],[0.5,0.6]]", "[[1,2]]")),
            "waypoints: 1 waypoints of 2 joints, must be at least 2 of 1");
  EXPECT_EQ(message_of(replaced(solved_line(), "[[0.1,0.2],[0.3,0.4],[0.5,0.6]]", "[[],[]]")),
            "waypoints: 2 waypoints of 0 joints, must be at least 2 of 1");
}

TEST(AttemptJson, AStoreMayHaveDroppedAPath) {
  const std::string dropped = replaced(solved_line(), "[[0.1,0.2],[0.3,0.4],[0.5,0.6]]", "null");
  const auto named = stored_attempt_from_json(dropped);
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_FALSE(named->attempt.path);
  EXPECT_EQ(named->attempt.record.outcome, Outcome::Solved);
  EXPECT_EQ(stored_attempt_from_json(solved_line())->attempt.path->size(), 3);
}

TEST(AttemptJson, RefusalNamesFieldValueAndLimit) {
  EXPECT_EQ(message_of(replaced(solved_line(), "bin_to_shelf", "bin to shelf")),
            "task: byte 4 is not one of A-Z a-z 0-9 _ . : -");
  EXPECT_EQ(message_of(replaced(solved_line(), "\"share\":0.9", "\"share\":1.1")),
            "record.share: 1.1 exceeds 1");
  EXPECT_EQ(message_of(replaced(solved_line(), "\"guided\"", "\"lucky\"")),
            "sampling_mode: 'lucky' is not one of guided, control, uniform");
  EXPECT_EQ(message_of(replaced(solved_line(), "[0.3,0.4]", "[0.3]")),
            "waypoints[1]: 1 numbers, the first has 2");
  EXPECT_EQ(message_of(replaced(solved_line(), "panda-2", "")), "robot: label: is empty");
  EXPECT_EQ(message_of(replaced(solved_line(), "Zelle 3", "Zelle\\n3")),
            "machine: byte 6 is a control character");
}

std::string with_scene(const std::string& scene) {
  return replaced(solved_line(), "\"scene\":null", "\"scene\":" + scene);
}

constexpr const char* kUpright =
    R"({"T0_w":[0,0,0,0,0,0,1],"Tw_e":[0,0,0.1,1,0,0,0],)"
    R"("Bw":[[null,null],[-0.5,0.5],[0,null],[-0.1,0.1],[-0.1,0.1],[null,null]]})";

std::string with_constraint(const std::string& constraint) {
  return with_scene(R"({"constraint":)" + constraint + "}");
}

TEST(AttemptJson, ASceneWithoutAConstraintIsWrittenAsEver) {
  const auto named = attempt_from_json(with_constraint("null"));
  ASSERT_TRUE(named) << named.error().message;
  EXPECT_FALSE(named->attempt.scene->constraint);
  EXPECT_EQ(to_json(named->attempt).find("constraint"), std::string::npos);
}

TEST(AttemptJson, BadConstraintIsRefusedByName) {
  EXPECT_EQ(message_of(with_constraint("{}")), "scene.constraint.T0_w: is missing");
  EXPECT_EQ(message_of(with_constraint(replaced(kUpright, "[-0.5,0.5]", "[0.5,-0.5]"))),
            "scene.constraint: Bw of y: lower 0.5 exceeds upper -0.5");
  EXPECT_EQ(message_of(with_constraint(replaced(kUpright, "[0,0,0,", "[0,0,1001,"))),
            "scene.constraint.T0_w: pose: coordinate 1001 m exceeds 1000 m; these are probably "
            "millimetres");
}

TEST(AttemptJson, BadSceneIsRefusedByName) {
  EXPECT_EQ(message_of(with_scene(R"({"boxs":[]})")), "scene: has an unknown member 'boxs'");
  EXPECT_EQ(message_of(with_scene(R"({"meshes":[{"name":"m"}]})")),
            "scene.meshes: only shapes are kept here");
  EXPECT_EQ(message_of(with_scene(R"({"allowed_collisions":[["can","panda_hand"]]})")),
            "scene: allowed_collisions names 'can', which is neither an object nor held");
  EXPECT_EQ(message_of(with_scene(R"({"spheres":[{"name":"ball","center":[0,0,1],"radius":0}]})")),
            "scene.spheres[0].radius: 0 m, must be above 0");
  EXPECT_EQ(
      message_of(with_scene(R"({"held":[{"name":"can","link":"hand","shape":{"sphere":1}}]})")),
      "scene.held[0]: has an unknown member 'link'");
}

TEST(AttemptJson, DofAndLengthAreLimited) {
  std::string wide = "[0";
  for (int i = 0; i < 32; ++i)
    wide += ",0";
  wide += "]";
  EXPECT_EQ(message_of(replaced(solved_line(), "[[0.1,0.2],[0.3,0.4],[0.5,0.6]]",
                                "[" + wide + "," + wide + "]")),
            "waypoints[0]: 33 elements exceed 32");
  std::string many = "[[0]";
  for (int i = 0; i < 16384; ++i)
    many += ",[0]";
  EXPECT_EQ(message_of(replaced(solved_line(), "[[0.1,0.2],[0.3,0.4],[0.5,0.6]]", many + "]")),
            "waypoints: 16385 elements exceed 16384");
}

TEST(AttemptJson, BytesThatAreNotUtf8AreReplacedWhenWritten) {
  Attempt attempt = attempt_from_json(solved_line())->attempt;
  attempt.machine = "cell \xff";
  EXPECT_EQ(attempt_from_json(to_json(attempt))->attempt.machine, "cell \xef\xbf\xbd");
}

}  // namespace
}  // namespace kinship::json::attempt_json_test
