#include "client/experiments/pipeline/peer_study.hpp"

#include <gtest/gtest.h>

#include <csignal>
#include <stdexcept>

#include "client/experiments/pipeline/peer_process.hpp"

namespace kinship::experiments::peer_study_test {
namespace {

constexpr std::uint64_t kMax = 1000;

PeerHalves::Half half(bool solved, std::uint64_t checks) {
  return {.solved = solved, .checks = checks, .cpu_s = 1, .length = solved ? 2.0 : 0};
}

TEST(PeerHalves, TwoThreadsAskByTurnsUntilOneHasAPath) {
  const PeerHalves halves{half(true, 100), half(true, 400)};
  const PeerHalves::Half both = halves.both_threads(kMax);
  EXPECT_TRUE(both.solved);
  EXPECT_EQ(both.checks, 200U);
  EXPECT_DOUBLE_EQ(both.cpu_s, 1.25);  // a quarter of the other's
  EXPECT_EQ(halves.faster_thread(kMax).checks, 100U);
}

TEST(PeerHalves, WhatGaveUpEarlyCostsWhatItHadSpent) {
  const PeerHalves halves{half(false, 30), half(true, 400)};
  EXPECT_EQ(halves.both_threads(kMax).checks, 430U);
  EXPECT_DOUBLE_EQ(halves.both_threads(kMax).cpu_s, 2);
  EXPECT_EQ(halves.faster_thread(kMax).checks, 400U);
}

TEST(PeerHalves, TheLimitIsForBothTogether) {
  const PeerHalves halves{half(false, 900), half(true, 600)};
  EXPECT_FALSE(halves.both_threads(kMax).solved);
  EXPECT_EQ(halves.both_threads(kMax).checks, kMax);
  EXPECT_TRUE(halves.faster_thread(kMax).solved);
  const PeerHalves neither{half(false, 900), half(false, 10)};
  EXPECT_FALSE(neither.faster_thread(kMax).solved);
  EXPECT_EQ(neither.faster_thread(kMax).checks, kMax);
}

using Write = std::function<void(const std::string&)>;

TEST(PeerProcess, LinesComeAcross) {
  std::vector<std::string> lines;
  const std::string end = run_apart(
      [](const Write& write) {
        write("one");
        write(std::string(100'000, 'x'));
      },
      [&](const std::string& line) { lines.push_back(line); });
  EXPECT_EQ(end, "");
  ASSERT_EQ(lines.size(), 2U);
  EXPECT_EQ(lines[0], "one");
  EXPECT_EQ(lines[1].size(), 100'000U);
}

TEST(PeerProcess, ACrashIsToldAndWhatCameBeforeIsKept) {
  std::vector<std::string> lines;
  const std::string end = run_apart(
      [](const Write& write) {
        write("one");
        std::raise(SIGKILL);
      },
      [&](const std::string& line) { lines.push_back(line); });
  EXPECT_EQ(end, "signal 9");
  EXPECT_EQ(lines, std::vector<std::string>{"one"});
}

TEST(PeerProcess, WhatIsThrownEndsTheChildOnly) {
  const std::string end = run_apart([](const Write&) { throw std::runtime_error("in the child"); },
                                    [](const std::string&) {});
  EXPECT_EQ(end, "exit code 1");
}

}  // namespace
}  // namespace kinship::experiments::peer_study_test
