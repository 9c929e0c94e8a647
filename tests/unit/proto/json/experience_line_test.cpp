#include "proto/json/experience_line.hpp"

#include <gtest/gtest.h>

#include <string>

#include "proto/json/event_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "tests/support/random_values.hpp"

namespace kinship::json::experience_line_test {
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

TEST(EventJson, IsALine) {
  const Event event{.kind = EventKind::Fit,
                    .time_ms = 1000,
                    .task = "bin_to_shelf",
                    .robot = "panda",
                    .text = "revision 3 \"ready\""};
  EXPECT_EQ(to_json(event), R"({"time_ms":1000,"kind":"fit","task":"bin_to_shelf",)"
                            R"("robot":"panda","text":"revision 3 \"ready\""})");
}

}  // namespace
}  // namespace kinship::json::experience_line_test
