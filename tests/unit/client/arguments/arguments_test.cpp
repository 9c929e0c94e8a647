#include "client/arguments/number_range.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <cstdint>
#include <sstream>

#include "client/arguments/command_options.hpp"
#include "proto/types/limits.hpp"

namespace kinship::arguments::arguments_test {
namespace {

std::string complaint(const CLI::Validator& check, const std::string& given) {
  std::string text = given;
  return check(text);
}

TEST(Between, TakesItsEnds) {
  for (const char* given : {"0.01", "86400", "5", "1e3"})
    EXPECT_EQ(complaint(between(0.01, 86'400.0), given), "") << given;
  EXPECT_EQ(complaint(between<std::uint32_t>(0, 230), "230"), "");
}

TEST(Between, NamesTheValueAndTheRange) {
  EXPECT_EQ(complaint(between<std::uint32_t>(0, 230), "231"),
            "'231' is not a number from 0 to 230");
  EXPECT_EQ(complaint(between(0.0, 2'592'000.0), "1e9"), "'1e9' is not a number from 0 to 2592000");
}

TEST(Between, RefusesWhatIsNoNumber) {
  for (const char* given : {"nan", "-nan", "inf", "-1", "", "five", "5s"})
    EXPECT_NE(complaint(between(0.0, 100.0), given), "") << given;
}

std::string profile_of(const std::string& line) {
  std::string profile = "default";
  CLI::App app;
  add_profile_options(app, profile);
  app.parse(line);
  return profile;
}

TEST(ProfileOptions, TheEstimatorIsAppendedWhereverItStands) {
  EXPECT_EQ(profile_of(""), "default");
  EXPECT_EQ(profile_of("--estimator kde"), "default,estimator=kde");
  EXPECT_EQ(profile_of("--profile paper --estimator gmm"), "paper,estimator=gmm");
  EXPECT_EQ(profile_of("--estimator kde --profile paper,tracks=2"), "paper,tracks=2,estimator=kde");
}

TEST(ProfileOptions, AnotherEstimatorIsRefused) {
  EXPECT_THROW(profile_of("--estimator knn"), CLI::ValidationError);
}

using Words = std::vector<std::string>;

TEST(RobotOptions, FillTheArguments) {
  models::RobotArguments robot;
  std::string rest;
  CLI::App app;
  add_robot_options(app, robot);
  app.add_option("rest", rest);
  app.parse(
      "--base b --tip t --label l --transfer \"0 0 1 0 0 0 1\" --axes x,y --hold a=1 --hold b=2 "
      "--srdf s.srdf --package p=/p --package q=/q "
      "--collision-from-visual --without-collision c --without-collision d more");
  EXPECT_EQ(robot.base_link, "b");
  EXPECT_EQ(robot.tip_link, "t");
  EXPECT_EQ(robot.label, "l");
  EXPECT_EQ(robot.transfer, "0 0 1 0 0 0 1");
  EXPECT_EQ(robot.axes, "x,y");
  EXPECT_EQ(robot.held, (Words{"a=1", "b=2"}));
  EXPECT_EQ(robot.srdf, "s.srdf");
  EXPECT_EQ(robot.packages, (Words{"p=/p", "q=/q"}));
  EXPECT_TRUE(robot.collision_from_visual);
  EXPECT_EQ(robot.without_collision, (Words{"c", "d"}));
  EXPECT_EQ(robot.source, "");
  EXPECT_EQ(rest, "more");  // a repeatable option takes one word at a time
}

TEST(RobotOptions, AreAllOptional) {
  models::RobotArguments robot;
  CLI::App app;
  add_robot_options(app, robot);
  app.parse("");
  EXPECT_TRUE(robot.held.empty());
  EXPECT_TRUE(robot.srdf.empty());
}

using Time = std::chrono::system_clock::time_point;

constexpr std::int64_t kMidnight_ms = 1'795'219'200'000;  // 2026-11-21T00:00:00Z, date -d ... +%s
const Time kNow{std::chrono::milliseconds(kMidnight_ms + 1)};

SelectionArguments parse(const std::string& line) {
  SelectionArguments arguments;
  CLI::App app;
  add_selection_options(app, arguments);
  app.parse(line);
  return arguments;
}

TEST(ParseSince, ReadsDatesAndTimesInUtc) {
  EXPECT_EQ(*parse_since("2026-11-21", kNow), kMidnight_ms);
  EXPECT_EQ(*parse_since("2026-11-21T00:00", kNow), kMidnight_ms);
  EXPECT_EQ(*parse_since("2026-11-21T05:32:14Z", kNow),
            kMidnight_ms + ((5 * 60 + 32) * 60 + 14) * 1000);
  EXPECT_EQ(*parse_since("1970-01-01", kNow), 0);
  EXPECT_EQ(*parse_since("2024-02-29", kNow), 1'709'164'800'000);
}

TEST(ParseSince, CountsAgesFromNow) {
  EXPECT_EQ(*parse_since("0s", kNow), kMidnight_ms);
  EXPECT_EQ(*parse_since("90m", kNow), kMidnight_ms - 90 * 60'000);
  EXPECT_EQ(*parse_since("12h", kNow), kMidnight_ms - 12 * 3'600'000);
  EXPECT_EQ(*parse_since("14d", kNow), kMidnight_ms - 14 * std::int64_t{86'400'000});
  for (const int hours : {1, 11, 23})  // all day long the same distribution
    EXPECT_EQ(*parse_since("14d", kNow + std::chrono::hours(hours)), *parse_since("14d", kNow));
  EXPECT_EQ(*parse_since("90m", kNow + std::chrono::seconds(59)), *parse_since("90m", kNow));
  EXPECT_NE(*parse_since("12h", kNow + std::chrono::hours(1)), *parse_since("12h", kNow));
  EXPECT_EQ(*parse_since("2w", kNow), *parse_since("14d", kNow));
  EXPECT_EQ(*parse_since("100d", Time(std::chrono::hours(24))), 0) << "before 1970";
}

TEST(ParseSince, TakesUnixTimeInMsAsJsonPrintsIt) {
  EXPECT_EQ(*parse_since(std::to_string(kMidnight_ms), kNow), kMidnight_ms);
  EXPECT_EQ(*parse_since("1000000000", kNow), 1'000'000'000);
  EXPECT_FALSE(parse_since("999999999", kNow)) << "too short: an age without its letter?";
  EXPECT_FALSE(parse_since("2026", kNow)) << "a year";
  EXPECT_FALSE(parse_since("253402300800000", kNow)) << "the year 10000";
}

TEST(ParseSince, RefusesWhatIsNoTimeAndShowsIt) {
  for (const char* text : {"",
                           "d",
                           "14",
                           "-3d",
                           "1.5h",
                           "14y",
                           "yesterday",
                           "2026-02-30",
                           "2026-13-01",
                           "1969-12-31",
                           "2026-11-21T",
                           "2026-11-21Z",
                           "2026-11-21 05:32",
                           "2026-11-21T24:00",
                           "2026-11-21T05:60",
                           "2026-11-21T05:32:60",
                           "2026-11-21T05:32:14+01:00",
                           "2026-11-2",
                           "26-11-2100",
                           "99999999w",
                           "99999999999999999999s"}) {
    const auto since = parse_since(text, kNow);
    ASSERT_FALSE(since) << text;
    EXPECT_EQ(since.error().code, ErrorCode::InvalidInput);
    EXPECT_NE(since.error().message.find("'" + std::string(text) + "'"), std::string::npos) << text;
  }
}

TEST(ParseRobotNames, SplitsAtCommasAndKeepsEachOnce) {
  EXPECT_EQ(*parse_robot_names("panda,iiwa14,,panda,"),
            (std::vector<std::string>{"panda", "iiwa14"}));
}

TEST(ParseRobotNames, RefusesNoneAndWhatIsNoLabel) {
  for (const char* text : {"", ",", "panda,two words", "a\nb"})
    EXPECT_FALSE(parse_robot_names(text)) << text;
  std::string many;
  for (std::size_t i = 0; i <= kMaxSelectedSources; ++i)
    many += "r" + std::to_string(i) + ",";
  EXPECT_FALSE(parse_robot_names(many));
}

TEST(SelectionOptions, FillASelection) {
  const SelectionArguments arguments =
      parse("--sources panda,iiwa14 --weighting paths --since 2026-11-21");
  EXPECT_EQ(arguments.sources, "panda,iiwa14");
  const Selection selection = *read_selection(arguments, kNow);
  EXPECT_EQ(selection.weighting, Weighting::Paths);
  EXPECT_EQ(selection.since_ms, kMidnight_ms);
  EXPECT_TRUE(selection.sources.empty());
  EXPECT_EQ(*read_selection(parse(""), kNow), Selection{});
}

TEST(SelectionOptions, RefuseWhileTheCommandLineIsParsed) {
  EXPECT_THROW(parse("--sources ,"), CLI::ValidationError);
  EXPECT_THROW(parse("--weighting heavy"), CLI::ValidationError);
  EXPECT_THROW(parse("--since tomorrow"), CLI::ValidationError);
}

}  // namespace
}  // namespace kinship::arguments::arguments_test
