#include "client/cli/init_command.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "client/cli/robot_commands.hpp"
#include "proto/types/exit_code.hpp"
#include "robots/models/text_file.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::cli::init_command_test {
namespace {

const std::string kArm = test::source_dir() + "/docs/tutorial/my_arm/robot.urdf";

struct Answer {
  int code = -1;
  std::string out, err;
};

class Init : public testing::Test {
 protected:
  /// \param typed  on the terminal; null: there is none.
  Answer init(const models::RobotArguments& robot, const char* typed = nullptr,
              bool force = false) const {
    std::istringstream answers(typed == nullptr ? "" : typed);
    std::ostringstream out, err;
    const int code = init_robot({.robot = robot, .folder = made_, .force = force},
                                typed == nullptr ? nullptr : &answers, out, err);
    return {code, out.str(), err.str()};
  }
  std::string text() const { return models::read_text(made_ / "chain.toml", 10'000); }
  bool has(const std::string& line) const { return text().find(line) != std::string::npos; }

  const test::TemporaryDirectory folder_;
  const std::filesystem::path made_ = folder_ / "arm";
};

TEST_F(Init, WithoutATerminalTakesWhatIsLikelyAndSaysWhy) {
  const Answer answer = init({.source = kArm});
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find("the likeliest (--tip names another)"), std::string::npos);
  EXPECT_NE(answer.out.find("possible: base to flange, palm, last"), std::string::npos)
      << answer.out;
  EXPECT_TRUE(has("base = \"base\"\ntip = \"flange\"\n")) << text();
  EXPECT_TRUE(has("label = \"arm\"")) << "the folder's, as the file is called robot";
  const auto read = models::describe_robot({.source = made_}).value_or_throw().description;
  EXPECT_EQ(read.urdf, models::read_text(kArm, 100'000));
}

TEST_F(Init, TakesAllThatIsGiven) {
  const Answer answer = init({.source = kArm,
                              .base_link = "shoulder",
                              .tip_link = "palm",
                              .label = "seven",
                              .transfer = "0 0 0.1 0 0 0 1",
                              .axes = "x,y",
                              .held = {"left_finger_joint=0.02"},
                              .without_collision = {"flange"},
                              .limit_slack = 0.01});
  ASSERT_EQ(answer.code, kDone) << answer.err;
  for (const char* line : {"base = \"shoulder\"", "tip = \"palm\"", "label = \"seven\"",
                           "transfer = [0, 0, 0.1, 0, 0, 0, 1]", "axes = [\"x\", \"y\"]",
                           "without_collision = [\"flange\"]", "limit_slack = 0.01",
                           "[hold]\n\"left_finger_joint\" = 0.02"})
    EXPECT_TRUE(has(line)) << line << " in:\n" << text();
}

TEST_F(Init, OnATerminalAsksAgainUntilTheAnswerFits) {
  const Answer answer =
      init({.source = kArm}, "\nnowhere\npalm\nmine\n0 0 125 0 0 0 1\n0 0 0.1 0 0 0 1\n");
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.err.find("tip link [flange]: "), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find("'nowhere'"), std::string::npos) << answer.err;
  EXPECT_NE(answer.err.find("these are probably millimetres (0.125 m)"), std::string::npos);
  EXPECT_TRUE(has("base = \"base\"\ntip = \"palm\"")) << text();
  EXPECT_TRUE(has("label = \"mine\"")) << text();
  EXPECT_TRUE(has("transfer = [0, 0, 0.1, 0, 0, 0, 1]")) << text();
}

TEST_F(Init, ReplacesAFileOnlyIfItIsSaidSo) {
  ASSERT_EQ(init({.source = kArm}).code, kDone);
  const std::string before = text();
  const Answer refused = init({.source = kArm, .tip_link = "palm"});
  EXPECT_EQ(refused.code, kWrongUsage);
  EXPECT_NE(refused.err.find("--force replaces it"), std::string::npos) << refused.err;
  EXPECT_EQ(text(), before);
  EXPECT_EQ(init({.source = kArm, .tip_link = "palm"}, nullptr, true).code, kDone);
  EXPECT_TRUE(has("tip = \"palm\""));
}

TEST_F(Init, WritesNothingForARobotThatCannotBe) {
  const Answer answer = init({.source = kArm, .transfer = "0 0 125 0 0 0 1"});
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_NE(answer.err.find("probably millimetres"), std::string::npos) << answer.err;
  EXPECT_FALSE(std::filesystem::exists(made_));
  EXPECT_EQ(init({.source = folder_ / "no.urdf"}).code, kNotFound);
}

TEST_F(Init, LeavesNoFileThatSaysNoRobot) {
  const auto strange = folder_ / "no-utf-8-\xff";  // TOML has no such text
  std::filesystem::create_directory(strange);
  std::filesystem::copy(kArm, strange / "robot.urdf");
  const Answer answer = init({.source = strange / "robot.urdf"});
  EXPECT_NE(answer.code, kDone);
  EXPECT_NE(answer.err.find("robot.urdf: no such file"), std::string::npos) << answer.err;
  EXPECT_FALSE(std::filesystem::exists(made_ / "chain.toml"));
  ASSERT_EQ(init({.source = kArm}).code, kDone);
  const std::string before = text();
  EXPECT_NE(init({.source = strange / "robot.urdf"}, nullptr, true).code, kDone);
  EXPECT_EQ(text(), before);
}

TEST_F(Init, NamesAPackageThatIsNotFoundAndAsksForItOnATerminal) {
  std::string urdf = models::read_text(kArm, 100'000);
  const std::string box = R"(<box size="0.06 0.13 0.09"/>)";
  ASSERT_NE(urdf.find(box), std::string::npos);
  urdf.replace(urdf.find(box), box.size(), R"(<mesh filename="package://hand_kit/palm.stl"/>)");
  std::ofstream(folder_ / "my.urdf") << urdf;
  Answer answer = init({.source = folder_ / "my.urdf"});
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find("--package hand_kit=DIR"), std::string::npos) << answer.out;
  EXPECT_FALSE(has("[packages]")) << text();
  std::filesystem::create_directory(folder_ / "kit");
  const std::string typed = "\n\n\n/nowhere\n" + (folder_ / "kit").string() + "\n\n";
  answer = init({.source = folder_ / "my.urdf"}, typed.c_str(), true);
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.err.find("no such folder"), std::string::npos) << answer.err;
  EXPECT_TRUE(has("[packages]\n\"hand_kit\" = \"../kit\"")) << text();
}

TEST(RobotsCheck, TellsReachAndExtents) {
  std::ostringstream out, err;
  EXPECT_EQ(
      check_robot({.robot = {.source = test::source_dir() + "/docs/tutorial/my_arm"}, .poses = 1},
                  out, err),
      kDone);
  EXPECT_NE(out.str().find("reach       1.220 m to the tip link, stretched out; 0.100 m from there "
                           "to the transfer frame\n"),
            std::string::npos)
      << out.str();
  EXPECT_NE(out.str().find("0.120 x 0.120 x 0.420  collision"), std::string::npos) << out.str();
}

}  // namespace
}  // namespace kinship::cli::init_command_test
