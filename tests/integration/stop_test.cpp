// kinshipd that is told to end while it works: it does, soon, whatever it is at.

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <future>
#include <iostream>
#include <string>
#include <thread>

#include "tests/support/cell.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::stop_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

/// On a machine that does nothing else it is a fraction of a second; tests share theirs.
constexpr seconds kSoon{10};

class Stopping : public testing::Test {
 protected:
  Stopping() {
    cell_.start();
    panda_ = cell_.register_model("panda").robot;
    ur10e_ = cell_.register_model("ur10e").robot;
  }
  FetchRequest request(const std::string& profile) const {
    FetchRequest request;
    request.task = "sweep";
    request.robot = ur10e_;
    request.profile = profile;
    return request;
  }
  std::uint64_t used(const ServerStatus& status, const std::string& what) const {
    for (const BoundUse& bound : status.bounds)
      if (bound.what == what)
        return bound.used;
    return 0;
  }
  static void wait_until(const std::function<bool()>& holds) {
    const auto give_up = std::chrono::steady_clock::now() + seconds(60);
    while (!holds())
      ASSERT_LT(std::chrono::steady_clock::now(), give_up);
  }
  /// Lets it work for a while, then ends it.
  void expect_end_soon(const char* at, milliseconds after) {
    std::this_thread::sleep_for(after);  // what is interrupted is a matter of time
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(cell_.terminate(), 0) << cell_.log();
    const auto took =
        std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - begin);
    EXPECT_LT(took, kSoon) << at;
    std::cout << "ended within " << took.count() << " ms, at " << at << '\n';
  }

  const test::TemporaryDirectory folder_;
  /// Rehearsals rest so much that none is over before it is seen.
  test::Cell cell_{{.folder = folder_.path(), .arguments = {"--rehearsal-cpu", "0.01"}}};
  Digest panda_, ur10e_;
};

TEST_F(Stopping, DuringATransfer) {
  cell_.report(panda_, 1, 200);
  EXPECT_EQ(cell_.client()
                .fetch(request(
                    "default,pose_spacing=0.01,max_poses_per_path=400,tracks=20,shape_steps=100"))
                .value_or_throw()
                .status,
            FetchStatus::Pending);
  wait_until([this] { return used(cell_.status(), "MB of memory of fits") > 0; });
  expect_end_soon("a transfer", milliseconds(300));
  EXPECT_EQ(cell_.log().find(" configurations from "), std::string::npos) << "the fit was over";
}

TEST_F(Stopping, DuringARehearsal) {
  cell_.report(panda_, 1, 100);
  FetchRequest rehearsed = request("default");
  rehearsed.experience_bytes = 100'000;
  rehearsed.rehearsed = true;
  static_cast<void>(cell_.client().fetch(rehearsed));
  wait_until([this] { return cell_.status().queued_rehearsals > 0; });
  EXPECT_EQ(cell_.status().rehearsals, 0U) << "it was over";
  expect_end_soon("a rehearsal", milliseconds(1000));
}

TEST_F(Stopping, DuringAReset) {
  cell_.report(panda_, 1, 5000);
  std::future<void> asked = std::async(std::launch::async, [this] {
    static_cast<void>(cell_.client().admin({.verb = AdminVerb::ResetTask, .argument = "sweep"}));
  });
  expect_end_soon("a reset", milliseconds(20));
  cell_.client().cancel();
  asked.get();
}

}  // namespace
}  // namespace kinship::stop_test
