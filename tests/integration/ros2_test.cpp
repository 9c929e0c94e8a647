// kinshipd --ros2 and nodes that speak as those of ROS 2 do, by Cyclone DDS and by Fast DDS.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "tests/support/places.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::ros2_test {
namespace {

using Words = std::vector<std::string>;

Words words_of(const std::string& line) { return test::words(line); }

/// A server, and nodes of the middleware that is the parameter.
class Ros2 : public testing::TestWithParam<std::string> {
 protected:
  Ros2() { start(); }

  void start(const Words& more = {}) {
    Words arguments = {"--ros2", "--ros2-domain", std::to_string(ros_domain_.number())};
    arguments.insert(arguments.end(), more.begin(), more.end());
    server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
        .store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = arguments});
  }

  Words node_arguments(const std::string& verb, const Words& options) const {
    Words arguments = {std::to_string(ros_domain_.number()), verb};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return arguments;
  }
  static std::string program(const std::string& middleware) {
    return test::bin_dir() + "/../tests/ros_peer_" + middleware;
  }

  /// What a node prints, from its start to its end.
  std::string run(const std::string& verb, const Words& options = {}) const {
    const test::Answer answer =
        test::run_to_end(program(GetParam()), node_arguments(verb, options));
    EXPECT_EQ(answer.err, "");
    return answer.out;
  }

  /// Makes the robot known; its digest and joints then go into reports.
  void register_robot() {
    const std::string urdf = test::source_dir() + "/robots/models/ur10e/robot.urdf";
    const std::string said =
        run("register", {"urdf=" + urdf, "label=arm", "base=base_link", "tip=tool0"});
    const Words answer = words_of(said);
    ASSERT_EQ(answer.size(), 4U) << said;
    EXPECT_EQ(answer[0] + answer[1], "registered0");
    robot_ = "robot=" + answer[2];
    EXPECT_EQ(answer[3],
              "shoulder_pan_joint,shoulder_lift_joint,elbow_joint,wrist_1_joint,wrist_2_joint,"
              "wrist_3_joint");
    joints_ = "joints=" + answer[3];
  }

  /// Status of the receipt.
  std::string report(const Words& options = {}, const std::string& verb = "report") {
    Words all = options;  // the first of a name counts
    all.insert(all.end(), {robot_, joints_});
    const Words answer = words_of(run(verb, all));
    return answer.size() > 2 && answer[0] == "receipt" ? answer[1] : "none";
  }

  /// As another client of Kinship sees the store.
  std::string kinship(const std::string& line) const {
    Words words = words_of(line);
    words.insert(words.end(), {"--domain", std::to_string(domain_.number())});
    const test::Answer answer = test::run_to_end("kinship", words);
    EXPECT_EQ(answer.code, 0) << answer.err;
    return answer.out;
  }

  static constexpr const char* kUuid = "01020304-0506-0708-090a-0b0c0d0e0f10";
  static constexpr const char* kUuidDigits = "uuid=0102030405060708090a0b0c0d0e0f10";

  test::ReservedDomain domain_, ros_domain_;
  test::TemporaryDirectory directory_;
  std::unique_ptr<test::ServerProcess> server_;
  std::string robot_, joints_;
};

INSTANTIATE_TEST_SUITE_P(By, Ros2, testing::Values("cyclone", "fastdds"),
                         [](const auto& each) { return each.param; });

TEST_P(Ros2, ARobotIsRegisteredAndItsPathsAreInTheStore) {
  register_robot();
  EXPECT_EQ(report({kUuidDigits}), "0");
  EXPECT_EQ(report({kUuidDigits}), "1") << "sent again: a duplicate";
  EXPECT_EQ(report({"seed=2"}), "0");
  EXPECT_EQ(report({"joints=elbow_joint"}), "3") << "without all joints: refused";
  const std::string paths = kinship("paths list");
  EXPECT_NE(paths.find(kUuid), std::string::npos) << paths;
  EXPECT_NE(run("status").find("status 1 robots 2 paths"), std::string::npos);
}

TEST_P(Ros2, APathIsStoredInTheOrderOfTheChain) {
  register_robot();
  ASSERT_EQ(report({kUuidDigits, "seed=3"}), "0");
  // The node names the joints from the last one on: what it says first is the last one's.
  const std::filesystem::path file = directory_ / "paths.jsonl";
  kinship("paths export --output " + file.string());
  const std::string text = test::read_text(file);
  const std::size_t waypoints = text.find("\"waypoints\":[[");
  ASSERT_NE(waypoints, std::string::npos) << text.substr(0, 500);
  const std::size_t second = text.find("],[", waypoints) + 3;
  const double first_joint = std::stod(text.substr(second));
  const double last_joint = std::stod(text.substr(text.rfind(',', text.find(']', second)) + 1));
  EXPECT_NEAR(first_joint - last_joint, 0.5 * (std::sin(0.6) - std::sin(0.1)), 1e-9);
}

TEST_P(Ros2, AReceiptIsOfWhatIsDurable) {
  register_robot();
  ASSERT_EQ(report({kUuidDigits}), "0");
  server_->kill();
  start();
  EXPECT_EQ(report({kUuidDigits}), "1") << "known to the server that came after";
}

TEST_P(Ros2, AReportWaitsForAServerThatIsAway) {
  register_robot();
  server_->kill();
  test::Program node(program(GetParam()), node_arguments("report", {robot_, joints_, kUuidDigits}));
  start();
  EXPECT_EQ(node.read_line().substr(0, 10), "receipt 0 ");
  EXPECT_EQ(node.wait(), 0);
}

TEST_P(Ros2, ADistributionComesWithItsQueryAndToWhoIsLate) {
  register_robot();
  EXPECT_EQ(run("fetch", {robot_}).substr(0, 10), "fetched 2 ") << "no experience";
  for (const char* const seed : {"seed=1", "seed=2", "seed=3"})
    ASSERT_EQ(report({seed}), "0");
  const std::string answer = run("fetch", {robot_});
  EXPECT_EQ(answer.substr(0, 12), "fetched 0 1 ") << answer;
  const std::string distribution = "distribution 1 shelf 6 1 6 21 6 6 shoulder_pan_joint\n";
  EXPECT_NE(answer.find(distribution), std::string::npos) << answer;
  EXPECT_EQ(run("listen"), distribution);
}

/// It only listens after its first answer.
TEST_P(Ros2, WhoFollowsGetsTheNextRevision) {
  register_robot();
  for (const char* const seed : {"seed=1", "seed=2", "seed=3"})
    ASSERT_EQ(report({seed}), "0");
  test::Program node(program(GetParam()), node_arguments("fetch", {robot_, "follow=60", "more=1"}));
  EXPECT_EQ(node.read_line().substr(0, 12), "fetched 0 1 ");
  EXPECT_EQ(node.read_line().substr(0, 15), "distribution 1 ");
  for (int seed = 4; seed < 16; ++seed)
    ASSERT_EQ(report({"seed=" + std::to_string(seed)}), "0");
  const std::string newer = node.read_line();
  EXPECT_EQ(newer.substr(0, 13), "distribution ") << newer;
  EXPECT_NE(newer.substr(0, 15), "distribution 1 ");
  EXPECT_EQ(node.wait(), 0);
}

TEST_P(Ros2, WhoHasLeftFollowsNoMore) {
  register_robot();
  for (const char* const seed : {"seed=1", "seed=2", "seed=3"}) {
    ASSERT_EQ(report({seed}), "0");
    ASSERT_EQ(report({seed, "task=bin"}), "0");
  }
  EXPECT_EQ(run("fetch", {robot_}).substr(0, 12), "fetched 0 1 ");
  EXPECT_EQ(run("fetch", {robot_, "follow=3600"}).substr(0, 12), "fetched 0 1 ");
  for (int seed = 4; seed < 16; ++seed)
    ASSERT_EQ(report({"seed=" + std::to_string(seed)}), "0");
  std::string answered;  // a revision that comes with the answer may also be followed to it
  if (run("fetch", {robot_}).starts_with("fetched 0 1 ")) {
    const Words answer = words_of(run("fetch", {robot_, "follow=60", "more=1"}));
    ASSERT_GT(answer.size(), 2U);
    answered = answer[2];
  }
  EXPECT_EQ(run("fetch", {robot_, "task=bin"}).substr(0, 10), "fetched 0 ");
  const Words all = words_of(run("listen", {"until=bin"}));
  std::multiset<std::string> newer;  // revisions; a busy machine may make several
  for (std::size_t i = 0; i + 2 < all.size(); ++i)
    if (all[i] == "distribution" && all[i + 1] != "1" && all[i + 2] == "shelf")
      newer.insert(all[i + 1]);
  EXPECT_FALSE(newer.empty());
  for (const std::string& revision : newer)
    EXPECT_LE(newer.count(revision), revision == answered ? 2U : 1U)
        << "for the node that is there: " << revision;
}

TEST_P(Ros2, ANodeThatFloodsHasItsOwnQuotaAndDelaysNoOther) {
  register_robot();
  for (const char* const quota : {"10", "0"}) {  // refused beyond it, or all served
    server_->terminate();
    start({"--client-attempts-per-s", quota});
    test::Program greedy(program(GetParam()),
                         node_arguments("flood", {robot_, joints_, "task=flood"}));
    ASSERT_EQ(greedy.read_line(), "flooding");
    for (int i = 0; i < 5; ++i) {
      const std::string status = report({"patience=10"});
      EXPECT_TRUE(status == "0" || status == "1") << status << " with a quota of " << quota;
    }
  }
}

TEST_P(Ros2, WhatANodeReportsBeyondTheRateOfItsReceiptsIsToldInTurn) {
  register_robot();
  std::uint32_t told = 0, stored = 0;
  int sent_again = -1, ms_after = -1;
  const std::string said = run("report_many", {robot_, joints_, "rate=300", "seconds=3"});
  ASSERT_EQ(std::sscanf(said.c_str(), "receipts %u of-stored %u sent-again %d ms-after %d", &told,
                        &stored, &sent_again, &ms_after),
            4)
      << said;
  EXPECT_EQ(told, 900U);
  EXPECT_GT(stored, 800U) << "told of once, however often they were sent: " << said;
  EXPECT_LT(sent_again, 2700) << "dropped while it is answered, a second apart: " << said;
  EXPECT_GT(ms_after, 4000) << "a hundred a second: " << said;
}

TEST_P(Ros2, MessagesOfTenMegabytesArriveAndLongerOnesDoNoHarm) {
  register_robot();
  EXPECT_EQ(report({"points=1400", "extra=900"}), "0");
  EXPECT_EQ(report({"points=1400", "extra=1300", "patience=4"}), "none") << "15 MB";
  EXPECT_EQ(report({"points=16385"}), "3") << "more points than a path may have";
  EXPECT_EQ(report({"seed=2"}), "0");
}

using Ros2ByCyclone = Ros2;
INSTANTIATE_TEST_SUITE_P(By, Ros2ByCyclone, testing::Values("cyclone"),
                         [](const auto& each) { return each.param; });

TEST_P(Ros2ByCyclone, ServicesAnswerInTheFormOfItsMiddleware) {
  register_robot();
  EXPECT_EQ(report({kUuidDigits}, "call_report"), "0");
  EXPECT_EQ(report({kUuidDigits}, "call_report"), "1");
  EXPECT_EQ(report({"seed=2"}, "call_report"), "0");
  EXPECT_NE(run("call_fetch", {robot_}).find("distribution 1 shelf 6 1 6 21 6 6"),
            std::string::npos);
}

TEST_P(Ros2ByCyclone, AServerBesideRosNodesTakesTheNextPlaceAndIsFound) {
  test::Program node(program(GetParam()), node_arguments("stay", {}));
  ASSERT_EQ(node.read_line(), "here");
  server_->terminate();
  // Two nodes have two places of the ROS domain: a server of Kinship on that domain takes the
  // third.
  test::Program other(program(GetParam()), node_arguments("stay", {}));
  ASSERT_EQ(other.read_line(), "here");
  server_ = std::make_unique<test::ServerProcess>(test::ServerProcess::Options{
      .store = directory_ / "fleet.db",
      .domain = ros_domain_.number(),
      .arguments = {"--ros2", "--ros2-domain", std::to_string(ros_domain_.number())}});
  register_robot();
  const test::Answer robots = test::run_to_end(
      "kinship", {"robots", "list", "--domain", std::to_string(ros_domain_.number())});
  EXPECT_NE(robots.out.find("arm"), std::string::npos) << robots.out << robots.err;
}

}  // namespace
}  // namespace kinship::ros2_test
