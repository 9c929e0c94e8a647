#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <vector>

#include "proto/types/exit_code.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/temporary_directory.hpp"
#include "tests/support/urdf_parses.hpp"
#include "tests/unit/client/cli/run_command.hpp"

namespace kinship::cli::commands_test {
namespace {

const std::string kModels = test::source_dir() + "/robots/models/";

/// A command for a server that is not there.
Answer run_without_server(std::vector<std::string> command, const char* timeout_s = "0.1") {
  const test::ReservedDomain domain;
  command.insert(command.begin(),
                 {"--domain", std::to_string(domain.number()), "--timeout", timeout_s});
  return run_command(command);
}

TEST(Register, ParsesTheUrdfOnce) {
  const test::TemporaryDirectory folder;
  const auto write = [&](const std::string& name, const std::string& text) {
    const std::filesystem::path file = folder / name.c_str();
    std::ofstream(file, std::ios::binary) << text;
    return file.string();
  };
  write("bar.stl", test::BoxMesh({0.3, 0.1, 0.1}).binary_stl());
  const std::string urdf = write(
      "arm.urdf",
      "<robot name='arm'><link name='base'/><link name='bar'><collision><geometry><mesh "
      "filename='bar.stl'/></geometry></collision></link><joint name='j' type='revolute'><parent "
      "link='base'/><child link='bar'/><axis xyz='0 0 1'/><limit lower='-1' upper='1' effort='1' "
      "velocity='1'/></joint></robot>");
  const std::string srdf = write(
      "arm.srdf",
      "<robot name='arm'><disable_collisions link1='base' link2='bar' reason='Adjacent'/></robot>");
  std::vector<std::string> command = {"robots", "register", urdf, "--base", "base", "--tip", "bar"};
  for (const bool has_srdf : {false, true}) {
    if (has_srdf)
      command.insert(command.end(), {"--srdf", srdf});
    const std::size_t before = test::urdf_parses();
    const Answer answer = run_without_server(command);
    EXPECT_EQ(answer.err.find("collision geometry"), std::string::npos) << answer.err;
    EXPECT_EQ(test::urdf_parses() - before, 1U);
  }
}

TEST(Commands, APageAndADocumentAreNotBothForStandardOutput) {
  const Answer answer =
      run_without_server({"robots", "compare", "--task", "pick", "--json", "--output", "-"});
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_NE(answer.err.find("--json and --output -"), std::string::npos) << answer.err;
}

TEST(Commands, AHostThatNobodyKnowsIsNamedAtOnce) {
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer = run_command({"--server", "nobody..invalid", "--timeout", "30", "status"});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(15));
  EXPECT_EQ(answer.code, kNoServer);
  EXPECT_TRUE(answer.err.starts_with("kinship: --server 'nobody..invalid': ")) << answer.err;
}

TEST(Commands, ABackupNeedsANameOrAVerb) {
  const Answer answer = run_command({"backup"});
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_NE(answer.err.find("name is required"), std::string::npos) << answer.err;
  EXPECT_EQ(run_command({"backup", "download"}).code, kWrongUsage);
}

TEST(Commands, ALimitOfClientsNeedsThemToBeAskedFor) {
  EXPECT_EQ(run_command({"status", "--limit", "3"}).code, kWrongUsage);
}

TEST(Commands, HelpIsOfWordsThatOneCanType) {
  const Answer answer = run_command({"backup", "--help"});
  EXPECT_NE(answer.out.find("  --no-wait  "), std::string::npos) << answer.out;
  for (const char* const inner : {"{false}", "Excludes", "Needs"})
    EXPECT_EQ(answer.out.find(inner), std::string::npos) << answer.out;
  EXPECT_EQ(answer.out.find("candidates"), std::string::npos) << "is hidden";
}

TEST(Commands, AnOutputFormatIsOneOfThree) {
  EXPECT_EQ(run_command({"paths", "list", "-o", "yaml"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"paths", "list", "-o", "wide", "--json"}).code, kWrongUsage);
}

TEST(Commands, CandidatesAreNothingAndNoComplaintWithoutAServer) {
  const test::ReservedDomain domain;
  const auto begin = std::chrono::steady_clock::now();
  const Answer answer =
      run_command({"--domain", std::to_string(domain.number()), "candidates", "ROBOT"});
  EXPECT_LT(std::chrono::steady_clock::now() - begin, std::chrono::seconds(4));
  EXPECT_EQ(answer.code, kDone);
  EXPECT_EQ(answer.out + answer.err, "");
}

TEST(Commands, WrongUsageIsCodeTwo) {
  EXPECT_EQ(run_command({}).code, kWrongUsage);
  EXPECT_EQ(run_command({"paths"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"paths", "lsit"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"distributions", "fetch", "--task", "pick"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"--domain", "300", "status"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"configurations", "export"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"distributions", "plot", "--output", "-"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"distributions", "plot", "3f9a"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"tasks", "plot", "pick"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"audit", "--since", "soon"}).code, kWrongUsage);
  EXPECT_EQ(run_command({"distributions", "explain", "--task", "pick"}).code, kWrongUsage);
  EXPECT_EQ(
      run_command({"distributions", "explain", "--task", "pick", "--distribution", "3f9a"}).code,
      kWrongUsage);
  EXPECT_EQ(run_command(
                {"distributions", "fetch", "--task", "pick", "--robot", "panda", "--since", "soon"})
                .code,
            kWrongUsage);
}

TEST(Commands, NoNumberIsNoTime) {
  const Answer answer = run_command({"--timeout", "nan", "status"});
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_NE(answer.err.find("'nan' is not a number from 0.01 to 86400"), std::string::npos)
      << answer.err;
}

TEST(Commands, RefusesOptionsThatExcludeEachOther) {
  EXPECT_EQ(run_command({"backup", "copy.db", "--no-wait", "--wait", "3"}).code, kWrongUsage);
  const Answer samples = run_without_server(
      {"distributions", "fetch", "--task", "pick", "--robot", "panda", "--samples", "3", "--json"});
  EXPECT_EQ(samples.code, kWrongUsage);
}

TEST(Commands, AFileThatCannotBeWrittenIsNamedBeforeAServerIsAsked) {
  const std::vector<std::vector<std::string>> exports = {
      {"paths", "export"}, {"configurations", "export", "--distribution", "3f9a0c"}};
  for (std::vector<std::string> command : exports) {
    command.insert(command.end(), {"--output", "/nowhere/rows"});
    const Answer answer = run_without_server(command);
    EXPECT_EQ(answer.code, kFailed) << answer.err;
    EXPECT_NE(answer.err.find("/nowhere/rows"), std::string::npos) << answer.err;
  }
}

TEST(Commands, NumbersMayHaveBlanksOrCommasInOneWordOrSeveral) {
  const std::string robot = test::source_dir() + "/robots/models/ur10e";
  const Answer one = run_command({"robots", "fk", robot, "--q", "0 -1.57 1.57 0 1.57 0"});
  ASSERT_EQ(one.code, kDone) << one.err;
  for (const std::vector<std::string>& words : std::vector<std::vector<std::string>>{
           {robot, "--q", "0,-1.57,1.57,0,1.57,0"},
           {robot, "--q", "0", "-1.57", "1.57", "0", "1.57", "0"},
           {"--q", "0", "-1.57", "1.57", "0", "1.57", "0", robot},
           {"--q", "0", "-1.57", "1.57", "0", "1.57", "0", "--placement", "0", "0", "0", "0", "0",
            "0", "1", robot}}) {
    std::vector<std::string> command = {"robots", "fk"};
    command.insert(command.end(), words.begin(), words.end());
    const Answer answer = run_command(command);
    EXPECT_EQ(answer.code, kDone) << answer.err;
    EXPECT_EQ(answer.out.substr(0, 60), one.out.substr(0, 60));
  }
  const Answer wrong = run_command({"robots", "fk", robot, "--q", "0 zero"});
  EXPECT_EQ(wrong.code, kWrongUsage);
  EXPECT_NE(wrong.err.find("'zero' is no number"), std::string::npos) << wrong.err;
}

TEST(Commands, AMissingFileIsNamedBeforeAServerIsAsked) {
  const Answer answer = run_without_server({"paths", "import", "/nowhere/x.jsonl"});
  EXPECT_EQ(answer.code, kNotFound);
  EXPECT_NE(answer.err.find("/nowhere/x.jsonl"), std::string::npos) << answer.err;
}

TEST(Commands, NamesWhatItDoesNotKnow) {
  const Answer answer = run_command({"robots", "dance"});
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_NE(answer.err.find("'dance'"), std::string::npos) << answer.err;
}

TEST(Commands, RefusesNegativeCounts) {
  EXPECT_EQ(run_command({"paths", "list", "--limit", "-1"}).code, kWrongUsage);
  EXPECT_EQ(run_command(
                {"distributions", "fetch", "--task", "pick", "--robot", "panda", "--samples", "-3"})
                .code,
            kWrongUsage);
}

TEST(Commands, WithoutAServerIsCodeFour) {
  const Answer answer = run_without_server({"status"}, "0.3");
  EXPECT_EQ(answer.code, kNoServer);
  EXPECT_NE(answer.err.find("status: "), std::string::npos) << answer.err;
}

TEST(Commands, LookingAtAServerLeavesTheUsersOutboxAlone) {
  const test::TemporaryDirectory state;
  setenv("XDG_STATE_HOME", state.path().c_str(), 1);
  run_without_server({"status"});
  unsetenv("XDG_STATE_HOME");
  EXPECT_TRUE(std::filesystem::is_empty(state.path()));
}

TEST(RobotsCheck, HeldJointsMayStandBeforeTheRobot) {
  const Answer answer = run_command(
      {"robots", "check", "--hold", "finger_left_joint=0.02", kModels + "panda", "--poses", "1"});
  EXPECT_EQ(answer.code, kDone) << answer.err;
}

TEST(RobotsCheck, GivesTheReasonWhyARobotIsRefused) {
  const Answer answer =
      run_command({"robots", "check", kModels + "panda", "--hold", "panda_joint1=0"});
  EXPECT_NE(answer.code, kDone);
  EXPECT_EQ(answer.err, "robots check: held joint 'panda_joint1': is on the chain\n");
}

TEST(RobotsIk, EqualSeedsGiveEqualSolutions) {
  const auto solutions = [](const std::string& seed) {
    const std::string out = run_command({"robots", "ik", kModels + "panda", "--pose",
                                         "-0.3 0.1 0.5 1 0 0 0", "--json", "--seed", seed})
                                .out;
    return out.substr(0, out.find("\"time_us\""));
  };
  EXPECT_EQ(solutions("5"), solutions("5"));
  EXPECT_NE(solutions("5"), solutions("6"));
}

TEST(RobotsCheck, TellsChainSolverAndYield) {
  const Answer answer = run_command({"robots", "check", kModels + "ur10e", "--poses", "20"});
  EXPECT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find("6 joints"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("Levenberg-Marquardt"), std::string::npos) << answer.out;
}

TEST(RobotsCheck, TellsTheStructureOfTheAxes) {
  const Answer ur10e = run_command({"robots", "check", kModels + "ur10e", "--poses", "1"});
  EXPECT_NE(ur10e.out.find("structure   parallel axes 2-3-4; closed form, 8 branches\n"),
            std::string::npos)
      << ur10e.out;
  const Answer iiwa = run_command({"robots", "check", kModels + "iiwa7", "--poses", "1", "--json"});
  EXPECT_NE(iiwa.out.find("\"structure\":\"spherical "), std::string::npos) << iiwa.out;
  EXPECT_NE(iiwa.out.find("closed form, 8 branches per lock\""), std::string::npos) << iiwa.out;
  const Answer sawyer = run_command({"robots", "check", kModels + "sawyer", "--poses", "1"});
  EXPECT_NE(sawyer.out.find("structure   no closed form"), std::string::npos) << sawyer.out;
}

TEST(RobotsCheck, TellsWhatDecidesTheTransferAndWhatCollides) {
  const Answer planar = run_command({"robots", "check", kModels + "planar_5r_a", "--poses", "1"});
  EXPECT_NE(planar.out.find("axes        x y yaw\n"), std::string::npos) << planar.out;
  const Answer panda = run_command({"robots", "check", kModels + "panda", "--poses", "1"});
  EXPECT_NE(panda.out.find("axes        all\n"), std::string::npos) << panda.out;
  EXPECT_NE(panda.out.find("held        finger_left_joint = 0.0425, "), std::string::npos);
  EXPECT_NE(panda.out.find("pairs of links never checked"), std::string::npos) << panda.out;
}

TEST(RobotsCheck, NamesAMissingFile) {
  const Answer answer =
      run_command({"robots", "check", "/nowhere/arm.urdf", "--base", "a", "--tip", "b"});
  EXPECT_EQ(answer.code, kNotFound);
  EXPECT_NE(answer.err.find("/nowhere/arm.urdf"), std::string::npos) << answer.err;
}

TEST(RobotsCheck, AFileNameTooLongIsAnAnswer) {
  const Answer answer = run_command({"robots", "check", std::string(300, 'x')});
  EXPECT_EQ(answer.code, kNotFound);
  EXPECT_NE(answer.err.find("xxx"), std::string::npos);
}

TEST(RobotsCheck, WantsBaseAndTipForAUrdfFile) {
  const Answer answer = run_command({"robots", "check", kModels + "ur10e/robot.urdf"});
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_NE(answer.err.find("--base"), std::string::npos) << answer.err;
}

TEST(RobotsCheck, ARobotThatCannotBeUsedIsAFailure) {
  const Answer answer =
      run_command({"robots", "check", kModels + "ur10e/robot.urdf", "--base", "a", "--tip", "b"});
  EXPECT_EQ(answer.code, kFailed);
  EXPECT_NE(answer.err.find("'a'"), std::string::npos) << answer.err;
}

TEST(RobotsIk, AnswersAPoseAsJson) {
  const Answer answer = run_command({"robots", "ik", kModels + "panda", "--pose",
                                     "0.4 0.1 0.5 1 0 0 0", "--max-solutions", "2", "--json"});
  EXPECT_EQ(answer.code, kDone) << answer.err;
  EXPECT_TRUE(answer.out.starts_with(R"({"format":"kinship.inverse-kinematics/1","solver":)"))
      << answer.out;
  EXPECT_NE(answer.out.find("\"reason\":null"), std::string::npos) << answer.out;
}

TEST(RobotsIk, AnUnreachablePoseIsAnAnswer) {
  const Answer answer =
      run_command({"robots", "ik", kModels + "panda", "--pose", "5 0 0 0 0 0 1", "--json"});
  EXPECT_EQ(answer.code, kDone) << answer.err;
  EXPECT_NE(answer.out.find("\"reason\":\"out_of_reach\""), std::string::npos) << answer.out;
}

TEST(RobotsIk, SkipsBlankLinesOfAFile) {
  const std::string file = testing::TempDir() + "kinship_blank_poses.jsonl";
  std::ofstream(file) << "\n[5, 0, 0, 0, 0, 0, 1]\n \t\r\n[5, 0, 0, 0, 0, 0, 1]\n\n";
  const Answer answer = run_command({"robots", "ik", kModels + "panda", "--poses", file, "--json"});
  EXPECT_EQ(answer.code, kDone) << answer.err;
  EXPECT_EQ(std::count(answer.out.begin(), answer.out.end(), '\n'), 2) << answer.out;
}

TEST(RobotsIk, AnswersAFileLineByLineAndNamesABrokenLine) {
  const std::string file = testing::TempDir() + "kinship_poses.jsonl";
  std::ofstream(file) << "[0.4, 0.1, 0.5, 1, 0, 0, 0]\n[5, 0, 0, 0, 0, 0, 1]\n[1, 2]\n";
  const Answer answer = run_command({"robots", "ik", kModels + "panda", "--poses", file, "--json"});
  EXPECT_EQ(answer.code, kWrongUsage);
  EXPECT_EQ(std::count(answer.out.begin(), answer.out.end(), '\n'), 2) << answer.out;
  EXPECT_NE(answer.err.find("line 3"), std::string::npos) << answer.err;
}

TEST(RobotsFk, IsWhatIkLeadsBackTo) {
  const Answer answer = run_command(
      {"robots", "fk", kModels + "panda", "--q", "0.3 -0.4 0.1 -2 0.2 1.8 0.7", "--json"});
  ASSERT_EQ(answer.code, kDone) << answer.err;
  EXPECT_TRUE(answer.out.starts_with(
      R"({"format":"kinship.forward-kinematics/1","q":[0.3,-0.4,0.1,-2.0,0.2,1.8,0.7],"frame":"base",)"))
      << answer.out;
  const std::size_t begin = answer.out.find("\"transfer\":[") + 12;
  std::string pose = answer.out.substr(begin, answer.out.find(']', begin) - begin);
  std::ranges::replace(pose, ',', ' ');
  const Answer back = run_command({"robots", "ik", kModels + "panda", "--pose", pose, "--frame",
                                   "transfer", "--collision-free", "--max-solutions", "0"});
  EXPECT_EQ(back.code, kDone) << back.err;
  EXPECT_NE(back.out.find(" solutions in "), std::string::npos) << back.out;
  EXPECT_EQ(back.out.find(": 0 solutions"), std::string::npos) << back.out;
}

TEST(RobotsFk, APlacementMovesPosesIntoTheTaskFrame) {
  const std::string q = "0 0 0 -1.5 0 1.5 0";
  const Answer base = run_command({"robots", "fk", kModels + "panda", "--q", q});
  const Answer task =
      run_command({"robots", "fk", kModels + "panda", "--q", q, "--placement", "0 0 10 0 0 0 1"});
  ASSERT_EQ(base.code, kDone) << base.err;
  EXPECT_NE(base.out.find(" in base link\n"), std::string::npos);
  EXPECT_NE(task.out.find(" 10."), std::string::npos) << task.out;
  EXPECT_NE(task.out.find(" in task frame\n"), std::string::npos) << task.out;
}

TEST(RobotsFk, NamesTheJointAndItsLimit) {
  const Answer far = run_command({"robots", "fk", kModels + "panda", "--q", "9 0 0 -1 0 1 0"});
  EXPECT_EQ(far.code, kWrongUsage);
  EXPECT_NE(far.err.find("'panda_joint1' at 9.0000 is outside -2.89"), std::string::npos)
      << far.err;
  const Answer few = run_command({"robots", "fk", kModels + "panda", "--q", "0 0"});
  EXPECT_EQ(few.code, kWrongUsage);
  EXPECT_NE(few.err.find("2 values, but the robot has 7 joints"), std::string::npos) << few.err;
  EXPECT_EQ(run_command({"robots", "fk", kModels + "panda", "--q", "0 zero"}).code, kWrongUsage);
}

TEST(RobotsIk, LeavesOutWhatTouchesTheScene) {
  const test::TemporaryDirectory folder;
  const std::string file = (folder / "wall.problems.jsonl").string();
  std::ofstream(file)  // a box around the pose
      << R"({"name": "in a box", "start": [0, 0, 0, -1.5, 0, 1.5, 0], "goal": {"pose": [0.5, 0, 0.4, 1, 0, 0, 0]}, )"
      << R"("scene": {"boxes": [{"name": "block", "pose": [0.5, 0, 0.4, 0, 0, 0, 1], "size": [0.3, 0.3, 0.3]}]}})"
      << '\n';
  const std::vector<std::string> ik = {
      "robots",  "ik",       kModels + "panda", "--pose", "0.5 0 0.4 1 0 0 0",
      "--frame", "transfer", "--json"};
  const auto with = [&ik](std::vector<std::string> more) {
    std::vector<std::string> words = ik;
    words.insert(words.end(), more.begin(), more.end());
    return run_command(words);
  };
  EXPECT_NE(with({}).out.find("\"reason\":null"), std::string::npos) << with({}).out;
  EXPECT_NE(with({"--collision-free"}).out.find("\"reason\":null"), std::string::npos);
  const Answer blocked = with({"--collision-free", "--scene", file});
  EXPECT_EQ(blocked.code, kDone) << blocked.err;
  EXPECT_NE(blocked.out.find("\"solutions\":[],\"reason\":\"colliding\""), std::string::npos)
      << blocked.out;
  EXPECT_EQ(with({"--scene", file}).code, kWrongUsage);
  EXPECT_NE(with({"--collision-free", "--scene", file + "x"}).code, kDone);
}

TEST(RobotsCheck, ShowsSolidsOfEachLinkWithTheirExtentAndWarnsOfWhatIsOnlyDrawn) {
  const test::TemporaryDirectory folder;
  std::ofstream(folder / "arm.urdf") << R"(<robot name="arm"><link name="base">
      <collision><geometry><box size="0.1 0.2 0.3"/></geometry></collision></link>
      <link name="arm"><visual><geometry><box size="0.1 0.1 0.5"/></geometry></visual></link>
      <joint name="turn" type="revolute"><parent link="base"/><child link="arm"/>
        <axis xyz="0 0 1"/><limit lower="-1" upper="1" effort="1" velocity="1"/></joint></robot>)";
  const Answer answer = run_command({"robots", "check", (folder / "arm.urdf").string(), "--base",
                                     "base", "--tip", "arm", "--poses", "1"});
  EXPECT_NE(answer.out.find("0.100 x 0.200 x 0.300"), std::string::npos) << answer.out;
  EXPECT_NE(answer.out.find("none (visual only)"), std::string::npos) << answer.out;
  EXPECT_NE(answer.err.find("warning: link 'arm' has <visual> and no <collision>"),
            std::string::npos)
      << answer.err;
}

}  // namespace
}  // namespace kinship::cli::commands_test
