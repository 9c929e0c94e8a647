#include "client/planner/plan_options.hpp"

#include <gtest/gtest.h>

#include <sstream>
#include <vector>

namespace kinship::planner::plan_options_test {
namespace {

struct Parsed {
  std::variant<PlanOptions, int> answer;
  std::string out, err;

  const PlanOptions& options() const { return std::get<PlanOptions>(answer); }
  int code() const { return std::get<int>(answer); }
};

Parsed parsed(std::vector<const char*> arguments) {
  arguments.insert(arguments.begin(), "kinship-plan");
  std::ostringstream out;
  std::ostringstream err;
  auto answer = parse_plan_options(static_cast<int>(arguments.size()), arguments.data(), out, err);
  return {std::move(answer), out.str(), err.str()};
}

TEST(PlanOptions, AModelAndProblemsAreEnoughToPlanUniformly) {
  const PlanOptions options = parsed({"problems.jsonl", "--model", "panda"}).options();
  EXPECT_EQ(options.problems, "problems.jsonl");
  EXPECT_EQ(options.robot.source, "panda");
  EXPECT_EQ(options.guidance, GuidanceMode::Uniform);
  EXPECT_FALSE(options.report);
  EXPECT_EQ(options.settings.clearance_m, 0.001);
  EXPECT_EQ(options.settings.resolution, 0.05);
  EXPECT_EQ(options.settings.shortcut_checks, 300U);
}

TEST(PlanOptions, AResolutionIsInsteadOfAProof) {
  const PlanOptions options = parsed({"p", "--model", "m", "--resolution", "0.1"}).options();
  EXPECT_EQ(options.settings.resolution, 0.1);
  EXPECT_EQ(options.settings.clearance_m, 0);
}

TEST(PlanOptions, WithATaskGuidanceIsUsedIfPossible) {
  const PlanOptions options = parsed({"p", "--model", "m", "--task", "a"}).options();
  EXPECT_EQ(options.guidance, GuidanceMode::Auto);
  EXPECT_FALSE(options.sampling.guided_fraction);
  EXPECT_FALSE(options.sampling.control_fraction);
  EXPECT_EQ(options.selection, Selection{});
  EXPECT_TRUE(options.sources.empty());
}

TEST(PlanOptions, TakesEverythingByName) {
  const Parsed answer = parsed({"--robot",    "arm.urdf",
                                "--base",     "b",
                                "--tip",      "t",
                                "--task",     "a",
                                "--problems", "p.jsonl",
                                "--planner",  "cbirrt2",
                                "--guidance", "auto",
                                "--report",   "yes",
                                "--json",     "--server",
                                "cell3",      "--seed",
                                "7",          "--domain",
                                "9",          "--control-share",
                                "0.1",        "--limit-slack",
                                "0"});
  ASSERT_TRUE(std::holds_alternative<PlanOptions>(answer.answer)) << answer.err;
  const PlanOptions& options = answer.options();
  EXPECT_EQ(options.robot.source, "arm.urdf");
  EXPECT_EQ(options.problems, "p.jsonl");
  EXPECT_EQ(options.settings.planner.kind, guided::PlannerKind::Cbirrt2);
  EXPECT_EQ(options.guidance, GuidanceMode::Auto);
  EXPECT_TRUE(options.report);
  EXPECT_TRUE(options.json);
  EXPECT_EQ(options.server, "cell3");
  EXPECT_EQ(options.seed_offset, 7U);
  EXPECT_EQ(options.settings.limit_slack, 0);
  EXPECT_EQ(options.sampling.control_fraction, 0.1);
  EXPECT_EQ(answer.err, "");
}

TEST(PlanOptions, AlwaysMeansWithoutControlUnlessSaid) {
  const PlanOptions always = parsed({"p", "m", "--task", "a", "--guidance", "always"}).options();
  EXPECT_EQ(always.guidance, GuidanceMode::Always);
  EXPECT_EQ(always.sampling.control_fraction, 0.0);
  EXPECT_EQ(parsed({"p", "m", "--task", "a", "--guidance", "always", "--control-share", "0.2"})
                .options()
                .sampling.control_fraction,
            0.2);
}

TEST(PlanOptions, AGuideThatNeedsNoExperienceNeedsNoTaskAndGuidesEveryQuery) {
  for (const char* guide : {"retreat", "none"}) {
    const Parsed answer = parsed({"p", "m", "--guide", guide});
    ASSERT_TRUE(std::holds_alternative<PlanOptions>(answer.answer)) << answer.err;
    EXPECT_EQ(answer.err, "");
    EXPECT_EQ(answer.options().guidance, GuidanceMode::Always);
    EXPECT_EQ(answer.options().sampling.control_fraction, 0.0);
    EXPECT_FALSE(answer.options().needs_experience());
  }
  const PlanOptions compared =
      parsed({"p", "m", "--guide", "retreat", "--guidance", "auto", "--share", "0.5"}).options();
  EXPECT_EQ(compared.guidance, GuidanceMode::Auto);
  EXPECT_FALSE(compared.sampling.control_fraction);
  EXPECT_TRUE(parsed({"p", "m", "--task", "a", "--guide", "ways"}).options().needs_experience());
  EXPECT_TRUE(parsed({"p", "m", "--task", "a"}).options().needs_experience());
  const Parsed noted = parsed({"p", "m", "--task", "a", "--guide", "retreat", "--wait", "1"});
  EXPECT_NE(noted.err.find("note: --wait has no effect with a guide that needs no experience\n"),
            std::string::npos)
      << noted.err;
  EXPECT_NE(noted.err.find("note: --task"), std::string::npos) << noted.err;
}

TEST(PlanOptions, AGuideThatNeedsExperienceSaysThatTheTaskIsMissing) {
  for (const char* guide : {"ways", "mixture", "retreat+ways", "auto"}) {
    const Parsed answer = parsed({"p", "m", "--guide", guide});
    ASSERT_TRUE(std::holds_alternative<int>(answer.answer)) << guide;
    EXPECT_EQ(answer.code(), 2);
    EXPECT_NE(answer.err.find("--guide: " + std::string(guide) + " needs --task"),
              std::string::npos)
        << answer.err;
  }
}

TEST(PlanOptions, UniformIsAlsoCalledNone) {
  for (const char* word : {"uniform", "none"})
    EXPECT_EQ(parsed({"p", "m", "--guidance", word}).options().guidance, GuidanceMode::Uniform);
}

TEST(PlanOptions, ReportAloneMeansYes) {
  EXPECT_TRUE(parsed({"--report", "p", "m", "--task", "a"}).options().report);
  EXPECT_TRUE(parsed({"p", "m", "--task", "a", "--report"}).options().report);
  EXPECT_FALSE(parsed({"p", "m", "--task", "a", "--report", "no"}).options().report);
}

TEST(PlanOptions, WhatHasNoEffectIsSaid) {
  const Parsed uniform = parsed({"p", "m", "--task", "a", "--guidance", "uniform", "--profile",
                                 "paper", "--machine", "cell 3", "--timeout", "9"});
  ASSERT_TRUE(std::holds_alternative<PlanOptions>(uniform.answer));
  for (const char* option : {"--profile", "--machine", "--timeout", "--task"})
    EXPECT_NE(uniform.err.find(std::string("note: ") + option), std::string::npos) << uniform.err;
  EXPECT_EQ(parsed({"p", "m", "--task", "a", "--profile", "paper", "--timeout", "9"}).err, "");
}

TEST(PlanOptions, ScenesAreRecordedUnlessSaidOtherwise) {
  EXPECT_TRUE(parsed({"p", "--model", "m"}).options().record_scenes);
  EXPECT_TRUE(parsed({"p", "--model", "m", "--record-scenes", "yes"}).options().record_scenes);
  EXPECT_FALSE(parsed({"p", "--model", "m", "--record-scenes", "no"}).options().record_scenes);
  EXPECT_EQ(parsed({"p", "--model", "m", "--record-scenes", "maybe"}).code(), 2);
  const auto record = [&](const char* word) {
    return parsed({"p", "--model", "m", "--task", "t", "--report", "--record-search", word})
        .options()
        .settings.record_search;
  };
  EXPECT_EQ(record("never"), guided::RecordSearch::Never);
  EXPECT_EQ(record("failed"), guided::RecordSearch::Failed);
  EXPECT_EQ(record("slow"), guided::RecordSearch::Slow);
  EXPECT_EQ(record("all"), guided::RecordSearch::All);
  EXPECT_EQ(parsed({"p", "--model", "m"}).options().settings.record_search,
            guided::RecordSearch::Never)
      << "what is not reported needs none";
}

TEST(PlanOptions, ReadsARobotFromAUrdf) {
  const models::RobotArguments robot = parsed({"p",          "dir/arm.urdf",
                                               "--base",     "b",
                                               "--tip",      "t",
                                               "--transfer", "0 0 0.1 0 0 0 1",
                                               "--axes",     "x,y,yaw",
                                               "--hold",     "finger=0.1",
                                               "--hold",     "lid=1",
                                               "--srdf",     "arm.srdf",
                                               "--package",  "a=/a",
                                               "--package",  "b=/b"})
                                           .options()
                                           .robot;
  EXPECT_EQ(robot.source, "dir/arm.urdf");
  EXPECT_EQ(robot.base_link, "b");
  EXPECT_EQ(robot.tip_link, "t");
  EXPECT_EQ(robot.transfer, "0 0 0.1 0 0 0 1");
  EXPECT_EQ(robot.axes, "x,y,yaw");
  EXPECT_EQ(robot.held, (std::vector<std::string>{"finger=0.1", "lid=1"}));
  EXPECT_EQ(robot.srdf, "arm.srdf");
  EXPECT_EQ(robot.packages, (std::vector<std::string>{"a=/a", "b=/b"}));
}

TEST(PlanOptions, TakesAModelFolderByPlaceAndReplacesWhatItSays) {
  const models::RobotArguments robot = parsed({"p", "panda", "--label", "cell3"}).options().robot;
  EXPECT_EQ(robot.source, "panda");
  EXPECT_EQ(robot.label, "cell3");
}

TEST(PlanOptions, ReadsWhatConcernsTheServer) {
  const PlanOptions options = parsed({"p",
                                      "--model",
                                      "m",
                                      "--task",
                                      "a",
                                      "--guidance",
                                      "require",
                                      "--share",
                                      "0",
                                      "--report",
                                      "--machine",
                                      "cell 3",
                                      "--domain",
                                      "7",
                                      "--timeout",
                                      "0.5",
                                      "--wait",
                                      "2",
                                      "--outbox",
                                      "box",
                                      "--profile",
                                      "paper",
                                      "--control-share",
                                      "0.5"})
                                  .options();
  EXPECT_EQ(options.guidance, GuidanceMode::Require);
  EXPECT_EQ(options.sampling.guided_fraction, 0.0);
  EXPECT_EQ(options.sampling.control_fraction, 0.5);
  EXPECT_TRUE(options.report);
  EXPECT_EQ(options.machine, "cell 3");
  EXPECT_EQ(options.domain, 7U);
  EXPECT_EQ(options.timeout.count(), 500);
  EXPECT_EQ(options.wait.count(), 2000);
  EXPECT_EQ(options.outbox, "box");
  EXPECT_EQ(options.profile, "paper");
}

TEST(PlanOptions, ReadsWhichExperienceIsWanted) {
  const PlanOptions options =
      parsed({"p", "--model", "m", "--task", "a", "--sources", "panda,iiwa14", "--weighting",
              "paths", "--since", "1970-01-02"})
          .options();
  EXPECT_EQ(options.sources, (std::vector<std::string>{"panda", "iiwa14"}));
  EXPECT_EQ(options.selection.weighting, Weighting::Paths);
  EXPECT_EQ(options.selection.since_ms, 86'400'000);
}

TEST(PlanOptions, HelpShowsExamplesAndEndsWell) {
  const Parsed help = parsed({"--help"});
  EXPECT_EQ(help.code(), 0);
  EXPECT_NE(help.out.find("Examples:"), std::string::npos);
}

TEST(PlanOptions, WrongUsageIsTwoAndSaysWhy) {
  const std::vector<std::vector<const char*>> wrong = {
      {},
      {"p"},
      {"p", "--model", "m", "arm.urdf"},
      {"p", "--model", "m", "--label", "two words"},
      {"p", "--model", "m", "--report"},
      {"p", "--model", "m", "--guidance", "auto"},
      {"p", "--model", "m", "--task", "a b"},
      {"p", "--model", "m", "--task", "a", "--guidance", "perhaps"},
      {"p", "--model", "m", "--task", "a", "--share", "1.5"},
      {"p", "--model", "m", "--task", "a", "--control-share", "-0.1"},
      {"p", "--model", "m", "--task", "a", "--since", "yesterday"},
      {"p", "--model", "m", "--resolution", "0"},
      {"p", "--model", "m", "--resolution", "nan"},
      {"p", "--model", "m", "--clearance", "0"},
      {"p", "--model", "m", "--clearance", "0.2"},
      {"p", "--model", "m", "--clearance", "0.002", "--resolution", "0.05"},
      {"p", "--model", "m", "--overshoot", "nan"},
      {"p", "--model", "m", "--timeout", "nan"},
      {"p", "--model", "m", "--seed", "-1"},
      {"p", "--model", "m", "--max-checks", "-1"},
      {"p", "--model", "m", "--planner", "rrt*"},
      {"p", "--model", "m", "--planner", "ompl:Nobody"},
      {"p", "--model", "m", "--problems", "q"},
      {"p", "--model", "m", "--robot", "n"},
      {"p", "--model", "m", "--task", ""},
      {"p", "--model", "m", "--report", "maybe"},
      {"p", "--model", "m", "--share", "0.5"},
      {"p", "--model", "m", "--control-share", "0.5"},
      {"p", "--model", "m", "--profile", "paper"},
      {"p", "--model", "m", "--sources", "panda"},
      {"p", "--model", "m", "--sources", "panda", "--guide", "retreat"},
      {"p", "--model", "m", "--report", "--guide", "retreat"},
      {"p", "--model", "m", "--guidance", "always"},
      {"p", "--model", "m", "--task", "a", "--share", "nan"},
      {"p", "--model", "m", "--task", "a", "--wait", "nan"},
      {"p", "--model", "m", "--task", "a", "--guidance", "always", "--share", "0"},
      {"p", "--model", "m", "--domain", "300"},
      {"p", "--model", "m", "--bogus"}};
  for (const auto& arguments : wrong) {
    const Parsed answer = parsed(arguments);
    ASSERT_TRUE(std::holds_alternative<int>(answer.answer)) << arguments.size();
    EXPECT_EQ(answer.code(), 2);
    EXPECT_NE(answer.err, "");
  }
}

}  // namespace
}  // namespace kinship::planner::plan_options_test
