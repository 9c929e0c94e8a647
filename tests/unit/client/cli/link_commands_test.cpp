#include "client/cli/link_commands.hpp"

#include <gtest/gtest.h>

#include <fstream>
#include <sstream>
#include <string>

#include "client/cli/robot_commands.hpp"
#include "client/cli/srdf_command.hpp"
#include "proto/types/exit_code.hpp"
#include "robots/geometry/srdf.hpp"
#include "robots/kinematics/urdf.hpp"
#include "tests/support/places.hpp"
#include "tests/support/temporary_directory.hpp"

/// The commands that help to bring a robot along, without a server.
namespace kinship::cli::link_commands_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models/";

struct Answer {
  int code = -1;
  std::string out, err;
};

template <typename Options>
Answer answer_of(int (*command)(const Options&, std::ostream&, std::ostream&),
                 const Options& options) {
  std::ostringstream out, err;
  const int code = command(options, out, err);
  return {code, out.str(), err.str()};
}

/// Three links in a row that turn about z, and a hook on the last one that reaches back into the
/// first wherever the arm goes.
std::string hooked_arm() {
  const auto link = [](const std::string& name, const std::string& solids) {
    return "<link name='" + name + "'>" + solids + "</link>";
  };
  const auto ball = [](double x, double radius) {
    return "<collision><origin xyz='" + std::to_string(x) + " 0 0'/><geometry><sphere radius='" +
           std::to_string(radius) + "'/></geometry></collision>";
  };
  const auto joint = [](const std::string& parent, const std::string& child) {
    return "<joint name='" + child + "_joint' type='revolute'><parent link='" + parent +
           "'/><child link='" + child +
           "'/><origin xyz='0.3 0 0'/><axis xyz='0 0 1'/>"
           "<limit lower='-2' upper='2' effort='1' velocity='1'/></joint>";
  };
  return "<robot name='hooked'>" + link("base", ball(0, 0.05)) + link("one", ball(0.1, 0.05)) +
         link("two", ball(0.1, 0.05)) + link("three", ball(0, 0.5)) + joint("base", "one") +
         joint("one", "two") + joint("two", "three") + "</robot>";
}

class UrdfFile {
 public:
  explicit UrdfFile(const std::string& text) : file(folder_ / "arm.urdf") {
    std::ofstream(file) << text;
  }
  std::filesystem::path beside(const char* name) const { return folder_ / name; }

 private:
  const test::TemporaryDirectory folder_;

 public:
  const std::filesystem::path file;
};

TEST(RobotsLinks, OfABareUrdfSayWhatBaseAndTipCouldBe) {
  const Answer answer =
      answer_of(list_links, LinksOptions{.robot = {.source = kModels + "panda/robot.urdf"}});
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find("(suggested: --base panda_link0 --tip "), std::string::npos)
      << answer.out;
  EXPECT_NE(answer.out.find("q7 revolute"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("\npanda_link0 (base)"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("\n.panda_link1 "), std::string::npos) << answer.out;
}

TEST(RobotsLinks, ListWhatThereIsWhereAJointIsWrongAndMarkTheJoint) {
  std::string text = hooked_arm();
  text.insert(text.find("</robot>"),
              "<link name='finger'/><joint name='grip' type='prismatic'><parent link='three'/>"
              "<child link='finger'/><axis xyz='0 1 0'/>"
              "<limit lower='0.045' upper='0' effort='1' velocity='1'/></joint>");
  const UrdfFile urdf(text);
  const Answer answer = answer_of(list_links, LinksOptions{.robot = {.source = urdf.file}});
  EXPECT_EQ(answer.code, kDone);
  EXPECT_NE(answer.err.find("joint 'grip': lower limit 0.045 exceeds upper limit 0"),
            std::string::npos)
      << answer.err;
  EXPECT_NE(answer.out.find("--tip three"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("WRONG"), std::string::npos) << answer.out;
}

TEST(RobotsLinks, TellsHeldJointsSolidsAndUncheckedPairs) {
  const Answer answer =
      answer_of(list_links, LinksOptions{.robot = {.source = kModels + "panda"}, .json = true});
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find(R"("is_suggested":false)"), std::string::npos);
  EXPECT_NE(answer.out.find(R"("held":0.0425)"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find(R"("reason":"adjacent")"), std::string::npos);
  EXPECT_NE(answer.out.find(R"("reason":"described")"), std::string::npos);
}

TEST(RobotsFrames, PlaceTheTransferFrame) {
  const FramesOptions options{.robot = {.source = kModels + "planar_5r_a"},
                              .configuration = "0 0 0 0 0",
                              .placement = "1 2 0 0 0 0 1"};
  const Answer answer = answer_of(list_frames, options);
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find("task frame"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("(transfer frame)  2.0000  2.0000  0.0000"), std::string::npos)
      << answer.out;
}

TEST(RobotsFrames, WantAConfigurationWithinTheLimits) {
  const FramesOptions options{.robot = {.source = kModels + "panda"}, .configuration = "9 0 0 0"};
  const Answer answer = answer_of(list_frames, options);
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_NE(answer.err.find("4 values, but the robot has 7 joints"), std::string::npos)
      << answer.err;
}

TEST(RobotsFrames, AMisspeltLinkIsAnsweredWithTheNearestOne) {
  FramesOptions options{.robot = {.source = kModels + "panda"}};
  options.robot.tip_link = "palmm";
  EXPECT_NE(answer_of(list_frames, options).err.find("(did you mean 'palm'?)"), std::string::npos)
      << answer_of(list_frames, options).err;
}

TEST(SuggestSrdf, IsReadBackAndExceptsWhatAlwaysTouches) {
  const UrdfFile urdf(hooked_arm());
  SuggestSrdfOptions options{.robot = {.source = urdf.file}, .samples = 500};
  options.output = urdf.beside("arm.srdf");
  const Answer answer = answer_of(suggest_srdf, options);
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find("one - three: 100.00 %"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("less than 0.6000 %"), std::string::npos) << answer.out;
  CheckOptions check{.robot = {.source = urdf.file, .base_link = "base", .tip_link = "three"},
                     .poses = 1};
  check.robot.srdf = urdf.beside("arm.srdf");
  const Answer checked = answer_of(check_robot, check);
  EXPECT_EQ(checked.code, kDone) << checked.err;
  EXPECT_EQ(checked.err.find("touch in nearly every"), std::string::npos) << checked.err;
}

TEST(SuggestSrdf, WhatWasSeenTouchingIsChecked) {
  const Answer answer = answer_of(
      suggest_srdf, SuggestSrdfOptions{.robot = {.source = kModels + "ur10e"}, .samples = 2000});
  ASSERT_EQ(answer.code, kDone) << answer.err;
  const auto chain =
      models::read_model(models::describe_robot({.source = kModels + "ur10e"}).value_or_throw())
          .value_or_throw()
          .chain;
  const auto excepted = geometry::read_srdf(answer.out, chain).value_or_throw();
  const std::size_t now_and_then = answer.err.find("touched now and then");
  ASSERT_NE(now_and_then, std::string::npos) << answer.err;
  const std::string checked = answer.err.substr(now_and_then);
  for (const auto& [a, b] : excepted) {
    EXPECT_EQ(checked.find(a + " - " + b), std::string::npos) << a << ' ' << b;
    EXPECT_EQ(checked.find(b + " - " + a), std::string::npos) << a << ' ' << b;
  }
  EXPECT_NE(checked.find(" - "), std::string::npos) << "nothing touched: the test shows nothing";
}

TEST(RobotsCheck, WarnsOfLinksThatAlwaysTouchAndOfAMissingTransferFrame) {
  const UrdfFile urdf(hooked_arm());
  const std::filesystem::path srdf = urdf.beside("other.srdf");
  std::ofstream(srdf)
      << "<robot name='hooked'><disable_collisions link1='base' link2='one'/></robot>";
  CheckOptions check{.robot = {.source = urdf.file, .base_link = "base", .tip_link = "three"},
                     .poses = 1};
  check.robot.srdf = srdf;
  const Answer answer = answer_of(check_robot, check);
  EXPECT_NE(answer.err.find("'one' and 'three' touch in nearly every configuration"),
            std::string::npos)
      << answer.err;
  EXPECT_NE(answer.err.find("kinship robots suggest-srdf"), std::string::npos);
  EXPECT_NE(answer.err.find("without --transfer"), std::string::npos) << answer.err;
  check.robot.transfer = "0 0 0.1 0 0 0 1";
  EXPECT_EQ(answer_of(check_robot, check).err.find("without --transfer"), std::string::npos);
}

}  // namespace
}  // namespace kinship::cli::link_commands_test
