// Followers of distributions, with kinshipd as a process that may be killed.

#include <gtest/gtest.h>

#include "tests/support/cell.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::following_test {
namespace {

using std::chrono::seconds;
using Clock = std::chrono::steady_clock;

constexpr seconds kEnough{250};  // a refit waits ten; the machine may have other work

class Following : public testing::Test {
 protected:
  Following() {
    cell_.start();
    panda_ = cell_.register_model("panda").robot;
    request_.task = "sweep";
    request_.robot = cell_.register_model("ur10e").robot;
    request_.profile = "paper";  // the cheapest fits: every vertex once
  }

  /// So many sweeps more, durable on return.
  void report(std::uint64_t count) {
    cell_.report(panda_, seed_, count);
    seed_ += count;
  }
  static std::uint64_t paths_of(const Distribution& distribution) {
    std::uint64_t paths = 0;
    for (const Source& source : distribution.sources)
      paths += source.paths;
    return paths;
  }

  const test::TemporaryDirectory directory_;
  test::Cell cell_{{.folder = directory_.path()}};
  FetchRequest request_;
  Digest panda_;
  std::uint64_t seed_ = 0;
};

TEST_F(Following, AFollowerHearsOfTheFirstFitAndOfTheNextAndALateJoinerGetsTheNewest) {
  const auto follower = cell_.client().follow(request_);
  EXPECT_EQ(follower->wait_for_newer(nullptr, Clock::now() + seconds(1)), nullptr);
  report(6);
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first) << follower->state().reason;
  EXPECT_GE(paths_of(*first), 1U);  // the six may have come in two batches, a fit between them
  report(12);
  const auto second = follower->wait_for_newer(first, Clock::now() + kEnough);
  ASSERT_NE(second, first) << follower->state().reason;
  EXPECT_GT(second->revision, first->revision);
  EXPECT_GE(paths_of(*second), paths_of(*first) + 5);

  link::Client other({.domain = cell_.domain(), .outbox = directory_ / "other_outbox"});
  const auto late = other.follow(request_);
  const auto joined = late->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(joined) << late->state().reason;
  EXPECT_GE(joined->revision, second->revision);
  EXPECT_EQ(joined->id, second->id);
}

TEST_F(Following, AKilledServerIsMissedByNobodyAndFollowedAgainWhenItIsBack) {
  report(6);
  const auto follower = cell_.client().follow(request_);
  const auto first = follower->wait_for_newer(nullptr, Clock::now() + kEnough);
  ASSERT_TRUE(first) << follower->state().reason;
  cell_.kill();
  EXPECT_EQ(follower->newest(), first);
  cell_.start();
  report(6);
  const auto second = follower->wait_for_newer(first, Clock::now() + kEnough);
  ASSERT_NE(second, first) << follower->state().reason;
  EXPECT_EQ(second->revision, first->revision + 1);
  EXPECT_EQ(second->store_epoch, first->store_epoch);
}

}  // namespace
}  // namespace kinship::following_test
