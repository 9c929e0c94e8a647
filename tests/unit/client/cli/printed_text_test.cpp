#include "client/cli/cell_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <sstream>
#include <string>
#include <vector>

#include "client/cli/clients_of_name.hpp"
#include "client/cli/compare_command.hpp"
#include "client/cli/distribution_commands.hpp"
#include "client/cli/listings.hpp"
#include "client/cli/value_text.hpp"
#include "client/cli/watch_command.hpp"
#include "client/cli/wrapped_lines.hpp"

namespace kinship::cli::printed_text_test {
namespace {

TEST(AgeText, HasOneUnit) {
  constexpr std::int64_t kNow_ms = 1'795'226'587'000;
  const auto age = [](std::int64_t seconds) { return age_text(kNow_ms - 1000 * seconds, kNow_ms); };
  EXPECT_EQ(age(0), "0s");
  EXPECT_EQ(age(119), "119s");
  EXPECT_EQ(age(120), "2m");
  EXPECT_EQ(age(7200), "2h");
  EXPECT_EQ(age(86'400 * 3), "3d");
  EXPECT_EQ(age(-5), "0s") << "of a machine whose clock is ahead";
  EXPECT_EQ(age_text(0, kNow_ms), "-");
}

std::size_t longest_line(const std::string& text) {
  std::size_t longest = 0;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);)
    longest = std::max(longest, line.size());
  return longest;
}

TEST(Wrapped, WordsGoOnBeneathTheTextOfTheirLabel) {
  EXPECT_EQ(wrapped("note    one two three four", 16),
            "note    one two\n        three\n        four");
  EXPECT_EQ(wrapped("kinship: one two three", 14), "kinship: one\n  two three");
  EXPECT_EQ(wrapped("short", 14), "short");
  EXPECT_EQ(wrapped("{\"a\": 1, \"b\": 2, \"c\": 3}", 14), "{\"a\": 1, \"b\": 2, \"c\": 3}");
  EXPECT_EQ(wrapped("a_word_that_is_longer_than_that and more", 14),
            "a_word_that_is_longer_than_that\n  and more");
  std::string words = "why     ";
  for (int i = 0; i < 100; ++i)
    words += "words ";
  EXPECT_LE(longest_line(wrapped(words, 80)), 80U);
}

TEST(WrappedLines, WritesWholeLinesWrappedAndAPartAsItIs) {
  std::ostringstream out;
  {
    WrappedLines lines(out, 10);
    out << "one two three\n"
        << "what is flushed is not wrapped" << std::flush << " at all\nend";
  }
  out << '.';
  std::ostringstream unbuffered;
  unbuffered << std::unitbuf;
  {
    WrappedLines lines(unbuffered, 10);
    unbuffered << "one "
               << "two "
               << "three" << '\n';
  }
  EXPECT_EQ(unbuffered.str(), "one two\n  three\n");
  EXPECT_TRUE(unbuffered.flags() & std::ios_base::unitbuf);
  EXPECT_EQ(out.str(), "one two\n  three\nwhat is flushed is not wrapped at all\nend.");
}

TEST(ByName, ClientsOfAProgramAndHostAreAddedUp) {
  ClientUse call;
  call.client = "7a0e3a52-8f0c-4d0a-9d43-2f6b7f0c1e55";
  call.program = "kinship";
  call.host = "host7";
  call.requests = 2;
  call.robots = {"panda"};
  call.last_seen_ms = 5;
  ClientUse later = call;
  later.client = "another";
  later.last_seen_ms = 9;
  ClientUse robot;
  robot.client = "robot_7";
  const std::vector<ClientsOfName> names = by_name({call, robot, later});
  ASSERT_EQ(names.size(), 2U);
  EXPECT_EQ(names[0].use.client, "kinship on host7");
  EXPECT_EQ(names[0].clients, 2U);
  EXPECT_EQ(names[0].use.requests, 4U);
  EXPECT_EQ(names[0].use.robots, std::vector<std::string>{"panda"});
  EXPECT_EQ(names[0].use.last_seen_ms, 9);
  EXPECT_EQ(names[1].use.client, "robot_7");
}

TEST(SizeText, HasOneDigitBehindThePoint) {
  EXPECT_EQ(size_text(999), "999 B");
  EXPECT_EQ(size_text(1234), "1.2 kB");
  EXPECT_EQ(size_text(3'400'000'000), "3.4 GB");
}

TEST(ShortPoseText, IsWhatPlacementTakes) {
  Eigen::Isometry3d T = Eigen::Isometry3d::Identity();
  T.translation() << 0.5, -0.25, 10;
  EXPECT_EQ(short_pose_text(T), "0.5 -0.25 10 0 0 0 1");
}

std::vector<std::int64_t> shown(AuditSelection selection, const std::vector<std::int64_t>& times) {
  std::vector<std::int64_t> taken;
  for (const std::int64_t time : times) {
    AuditEntry entry;
    entry.time_ms = time;
    if (selection.takes(entry))
      taken.push_back(time);
    if (selection.is_full())
      break;
  }
  return taken;
}

using Times = std::vector<std::int64_t>;

TEST(AuditSelection, AnOldEntryEndsNothing) {
  // The clock was set back between the second and the third.
  const Times newest_first = {500, 100, 450, 90};
  EXPECT_EQ(shown({400, 0}, newest_first), (Times{500, 450}));
  EXPECT_EQ(shown({0, 0}, newest_first), newest_first);
}

TEST(AuditSelection, TheLimitIsOfWhatIsShown) {
  EXPECT_EQ(shown({400, 2}, {500, 100, 450, 440}), (Times{500, 450}));
  EXPECT_EQ(shown({0, 3}, {500, 100, 450, 440}), (Times{500, 100, 450}));
}

Rehearsal rehearsal(double uniform, double guided) {
  return {
      .guide = Guide::Ways,
      .is_complete = true,
      .queries = 50,
      .costs = {{Guide::None, 50, 50, uniform, uniform}, {Guide::Ways, 50, 50, guided, guided}}};
}

Transferability pair(std::uint8_t target, std::uint8_t source, std::optional<Rehearsal> rehearsal) {
  const auto label = [](std::uint8_t robot) { return "arm" + std::to_string(robot); };
  return {Digest{{target}}, Digest{{source}},     label(target),
          label(source),    std::move(rehearsal), ""};
}

TEST(Worth, IsTheBestWithoutExperienceToTheBestWithItByTimeAndByChecks) {
  const Worth found = worth({.guide = Guide::Retreat,
                             .costs = {{Guide::None, 50, 50, 900, 900, 0.009},
                                       {Guide::Retreat, 50, 50, 400, 400, 0.004},
                                       {Guide::RetreatWays, 50, 50, 200, 200, 0.005},
                                       {Guide::Mixture, 50, 50, 250, 250, 0.008}}})
                          .value();
  EXPECT_DOUBLE_EQ(found.by_time.value(), 0.8) << "what the retreat saves is not the fleet's";
  EXPECT_DOUBLE_EQ(found.by_checks, 2);
  EXPECT_DOUBLE_EQ(found.value(), 0.8);
  EXPECT_EQ(found.without, Guide::Retreat);
  EXPECT_EQ(found.with, Guide::RetreatWays);
  EXPECT_EQ(worth_text(found),
            "0.80 by time, 2.00 by checks (best without experience retreat, with it retreat+ways)");
}

TEST(Worth, IsByChecksWhereATimeIsUnknown) {
  const Worth found = worth(rehearsal(900, 300)).value();
  EXPECT_FALSE(found.by_time);
  EXPECT_DOUBLE_EQ(found.value(), 3);
  EXPECT_EQ(worth_text(found), "3.00 by checks (best without experience none, with it ways)");
}

TEST(Worth, IsUnknownWhereNothingWasPlanned) {
  EXPECT_FALSE(worth(Rehearsal{}));
  EXPECT_FALSE(worth({.guide = Guide::Ways, .costs = {{Guide::Ways, 50, 50, 300, 300}}}));
  EXPECT_FALSE(worth({.guide = Guide::None,
                      .costs = {{Guide::None, 50, 50, 300, 300}, {Guide::Retreat, 50, 50, 9, 9}}}));
  EXPECT_FALSE(worth(rehearsal(900, 0)));
}

TEST(NeedsExperience, WhateverUsesMoreThanTheRetreat) {
  EXPECT_FALSE(needs_experience(Guide::None));
  EXPECT_FALSE(needs_experience(Guide::Retreat));
  for (unsigned guide = 2; guide < 16; ++guide)
    EXPECT_TRUE(needs_experience(static_cast<Guide>(guide))) << guide;
}

TEST(PrintWorths, IsAMatrixWithTheBestSourceOfEachTarget) {
  std::ostringstream out;
  print_worths({pair(1, 1, rehearsal(900, 300)), pair(1, 2, rehearsal(900, 450)),
                pair(2, 1, rehearsal(100, 80)), pair(2, 2, {})},
               out);
  EXPECT_EQ(out.str(),
            "TARGET \\ SOURCE  arm1   arm2\n"
            "arm1             3.00*  2.00\n"
            "arm2             1.25*  -\n");
}

std::string printed(const Distribution& distribution) {
  std::ostringstream out;
  print_distribution(distribution, out);
  return out.str();
}

TEST(PrintDistribution, DrawsTheScoresOfNumbersOfComponents) {
  Distribution distribution;
  distribution.component_scores = {{40, 0.5}, {20, 0.75}, {10, -0.25}};
  const std::string text = printed(distribution);
  EXPECT_NE(text.find("20           0.750  " + std::string(41, '#') + " chosen"), std::string::npos)
      << text;
  EXPECT_NE(text.find("40           0.500  " + std::string(31, '#') + "\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("10          -0.250  #\n"), std::string::npos) << text;
}

TEST(PrintDistribution, TellsTheBandwidthOfKernels) {
  Distribution distribution;
  distribution.configurations = 5000;
  distribution.mixture = Mixture(Eigen::Vector2d(0.5, 0.5), Eigen::MatrixXd::Zero(2, 2),
                                 {Eigen::Vector2d(0.04, 0.25).asDiagonal().toDenseMatrix()});
  const std::string text = printed(distribution);
  EXPECT_NE(text.find("kernels       2 in 2 dimensions, fitted to 5000 configurations\n"
                      "bandwidth     0.200 0.500, deviations of a kernel\n"),
            std::string::npos)
      << text;
}

TEST(PrintDistribution, DrawsNothingIfTheNumberWasGiven) {
  EXPECT_EQ(printed({}).find("HELD-OUT"), std::string::npos);
}

TEST(PrintDistribution, OneScoreIsTheBest) {
  Distribution distribution;
  distribution.component_scores = {{1, -3}};
  EXPECT_NE(printed(distribution).find("# chosen"), std::string::npos);
}

constexpr double kInfinity = std::numeric_limits<double>::infinity();

TaskSpaceRegion unbounded() {
  TaskSpaceRegion region;
  region.bounds.row(0).setConstant(-kInfinity);
  region.bounds.row(1).setConstant(kInfinity);
  return region;
}

TEST(RegionText, NamesTheCoordinatesThatHaveABound) {
  TaskSpaceRegion region = unbounded();
  region.bounds.col(2) << 0.25, kInfinity;
  region.bounds.col(3) << -0.15, 0.15;
  region.bounds.col(4) << 0, 0;
  EXPECT_EQ(region_text(region),
            "stays within a task space region: z 0.25..inf m, roll -0.15..0.15 rad, pitch 0..0 "
            "rad");
}

TEST(RegionText, SaysThatNothingIsBounded) {
  EXPECT_EQ(region_text(unbounded()), "stays within a task space region without bounds");
}

TEST(PrintScene, HasALineForTheConstraintIfThereIsOne) {
  const auto printed = [](const RecordedScene& scene) {
    std::ostringstream out;
    print_scene(scene, out);
    return out.str();
  };
  RecordedScene scene;
  EXPECT_EQ(printed(scene), "scene       0 objects, 0 held\n");
  scene.constraint = unbounded();
  scene.constraint->bounds.col(5) << -1, 1;
  EXPECT_EQ(printed(scene),
            "scene       0 objects, 0 held\n"
            "constraint  stays within a task space region: yaw -1..1 rad\n");
}

using std::chrono::seconds;
using TimePoint = ServerRates::TimePoint;

ServerStatus status(std::uint64_t uptime_s, std::uint64_t reports, std::uint64_t fetches) {
  ServerStatus status;
  status.uptime_s = uptime_s;
  status.reports_received = reports;
  status.fetches = fetches;
  return status;
}

TEST(ServerRates, AreThoseOfTheWindowAlone) {
  ServerRates rates(seconds(10));
  rates.add(status(0, 0, 0), TimePoint(seconds(100)));
  EXPECT_EQ(rates.text(), "") << "one reading is no rate";
  rates.add(status(5, 500, 10), TimePoint(seconds(105)));
  EXPECT_EQ(rates.text(), "reports 100.0/s, fetches 2.0/s, fits 0.0/s");
  rates.add(status(15, 500, 20), TimePoint(seconds(115)));  // the burst is over
  EXPECT_EQ(rates.text(), "reports 0.0/s, fetches 1.0/s, fits 0.0/s");
}

TEST(ServerRates, BeginAnewWithAServerThatWasStartedAnew) {
  ServerRates rates(seconds(10));
  rates.add(status(50, 500, 9), TimePoint(seconds(100)));
  rates.add(status(1, 2, 0), TimePoint(seconds(103)));
  EXPECT_EQ(rates.text(), "");
  rates.add(status(2, 4, 0), TimePoint(seconds(104)));
  EXPECT_EQ(rates.text(), "reports 2.0/s, fetches 0.0/s, fits 0.0/s");
}

TEST(ServerRates, TellWhatWaits) {
  ServerRates rates(seconds(10));
  ServerStatus busy = status(5, 1, 1);
  rates.add(busy, TimePoint(seconds(1)));
  busy.queued_reports = 3;
  busy.queued_fits = 1;
  rates.add(busy, TimePoint(seconds(2)));
  EXPECT_NE(rates.text().find("; queued 3 reports, 1 fit"), std::string::npos) << rates.text();
}

TEST(GuidanceText, SaysWhatItBringsOrCosts) {
  TaskRobotSummary robot;
  robot.label = "ur10e";
  robot.guided = ModeEvidence{40, 40, 487};
  EXPECT_EQ(guidance_text("pick", robot), "") << "nothing to compare with";
  robot.control = ModeEvidence{40, 39, 852};
  EXPECT_EQ(guidance_text("pick", robot),
            "ur10e on pick: 487 checks a solution guided, 852 uniform: 1.75 times fewer");
  robot.guided_means = PathMeans{40, 0.0312, 4.213, 1.618, 0.0341};
  EXPECT_EQ(guidance_text("pick", robot),
            "ur10e on pick: 487 checks a solution guided, 852 uniform: 1.75 times fewer; guided: "
            "31.2 ms, 4.21 long, hand 1.62 m, clearance 0.034 m (mean of 40)");
  robot.control->checks_per_solution = 243.5;
  EXPECT_NE(guidance_text("pick", robot).find("2.00 times more"), std::string::npos);
}

}  // namespace
}  // namespace kinship::cli::printed_text_test

namespace kinship::cli::rehearsal_text_test {
namespace {

std::string printed(const std::optional<Rehearsal>& rehearsal) {
  std::ostringstream out;
  print_rehearsal(rehearsal, out);
  return out.str();
}

Rehearsal rehearsed() {
  return {.guide = Guide::Ways,
          .is_complete = true,
          .queries = 100,
          .processor_time_s = 74.31,
          .costs = {{Guide::None, 400, 396, 1552.4, 803, 0.00412},
                    {Guide::Ways, 400, 400, 361, 154, 0.00206},
                    {Guide::RetreatMixture, 100, 99, 3104.8, 1200, 0.00824}}};
}

TEST(PrintRehearsal, ComparesGuidesAndMarksTheOneToUse) {
  EXPECT_EQ(printed(rehearsed()),
            "rehearsed on 100 recorded queries, 74.3 s of processor time\n"
            "GUIDE            PLANS  SOLVED  MEAN      UNIFORM    MEAN  UNIFORM /\n"
            "                                TIME     / GUIDED  CHECKS     GUIDED\n"
            "none               400     396  4.12 ms      1.00    1552       1.00\n"
            "ways               400     400  2.06 ms      2.00     361       4.30  chosen\n"
            "retreat+mixture    100      99  8.24 ms      0.50    3105       0.50\n"
            "worth of the experience: 2.00 by time, 4.30 by checks (best without experience none, "
            "with it ways)\n");
}

TEST(PrintRehearsal, SaysHowManyQueriesWereLeftOutAndWhy) {
  Rehearsal rehearsal = rehearsed();
  rehearsal.queries = 1;
  rehearsal.left_out = 3;
  EXPECT_TRUE(printed(rehearsal).starts_with(
      "rehearsed on 1 recorded query (3 left out: the robot cannot take their start or goal where "
      "it stands), 74.3 s"))
      << printed(rehearsal);
}

TEST(PrintRehearsal, SaysThatThereIsMoreToCome) {
  Rehearsal rehearsal = rehearsed();
  rehearsal.is_complete = false;
  EXPECT_TRUE(printed(rehearsal).starts_with("being rehearsed on 100 recorded queries, "));
}

TEST(PrintRehearsal, SaysWhatBeginsOne) {
  EXPECT_EQ(printed({}), "not rehearsed yet: a fetch that asks for stored ways begins it\n");
}

TEST(PrintRehearsal, SaysWhyThereIsNothingToSay) {
  const std::string why = "no recorded query can be planned by this robot where it stands";
  EXPECT_EQ(printed(Rehearsal{.is_complete = true, .left_out = 4, .message = why}), why + "\n");
  EXPECT_EQ(printed(Rehearsal{}), "not rehearsed: there is no recorded query\n");
}

TEST(PrintRehearsal, ComparesWithNothingIfUniformSamplingWasNotTried) {
  Rehearsal rehearsal = rehearsed();
  rehearsal.costs.erase(rehearsal.costs.begin());
  rehearsal.costs[1].mean_checks = 0;
  EXPECT_NE(printed(rehearsal).find("361  -          chosen\n"), std::string::npos)
      << printed(rehearsal);
}

}  // namespace
}  // namespace kinship::cli::rehearsal_text_test
