// kinshipd that is told to end while it works: it does, soon, whatever it is at.

#include <gtest/gtest.h>
#include <signal.h>

#include <chrono>
#include <functional>
#include <future>
#include <iostream>
#include <memory>
#include <string>
#include <thread>

#include "client/link/client.hpp"
#include "proto/json/admin_rows_json.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/robots.hpp"
#include "tests/support/server_process.hpp"
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
    panda_ = client_.register_robot(test::model_description("panda")).value_or_throw().robot;
    ur10e_ = client_.register_robot(test::model_description("ur10e")).value_or_throw().robot;
  }
  void report(int paths) {
    std::vector<Attempt> attempts;
    for (int i = 0; i < paths; ++i)
      attempts.push_back(test::panda_attempt(panda_, "sweep", next_seed_++));
    for (const Receipt& receipt : client_.deliver(attempts).value_or_throw())
      ASSERT_EQ(receipt.status, ReceiptStatus::Stored) << receipt.message;
  }
  FetchRequest request(const std::string& profile) const {
    FetchRequest request;
    request.task = "sweep";
    request.robot = ur10e_;
    request.profile = profile;
    return request;
  }
  ServerStatus status() {
    AdminRequest request;
    const AdminReply reply = client_.admin(request).value_or_throw();
    return json::row_from_json<ServerStatus>(reply.rows.at(0)).value_or_throw();
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
  /// Asks for a fit and returns when it has begun.
  void begin_fit(const std::string& profile) {
    EXPECT_EQ(client_.fetch(request(profile)).value_or_throw().status, FetchStatus::Pending);
    wait_until([this] { return used(status(), "MB of memory of fits") > 0; });
  }
  /// No fit is complete: one was under way.
  void expect_no_fit() const {
    const std::string log = test::read_text(folder_ / "fleet.db.log");
    EXPECT_EQ(log.find(" configurations from "), std::string::npos) << "it was over: " << log;
  }
  /// Lets it work for a while, then ends it.
  void expect_end_soon(const char* at, milliseconds after) {
    std::this_thread::sleep_for(after);  // what is interrupted is a matter of time
    const auto begin = std::chrono::steady_clock::now();
    EXPECT_EQ(server_.terminate(), 0) << test::read_text(folder_ / "fleet.db.log");
    const auto took =
        std::chrono::duration_cast<milliseconds>(std::chrono::steady_clock::now() - begin);
    EXPECT_LT(took, kSoon) << at;
    std::cout << "ended within " << took.count() << " ms, at " << at << '\n';
  }

  const test::ReservedDomain domain_;
  const test::TemporaryDirectory folder_;
  test::ServerProcess server_{
      {.store = folder_ / "fleet.db", .domain = domain_.number(), .arguments = {}}};
  link::Client client_{
      {.domain = domain_.number(), .outbox = {}, .has_outbox = false, .timeout = seconds(60)}};
  Digest panda_, ur10e_;
  std::uint64_t next_seed_ = 1;
};

TEST_F(Stopping, DuringATransfer) {
  report(200);
  begin_fit("default,pose_spacing=0.01,max_poses_per_path=400,tracks=20,shape_steps=100");
  expect_end_soon("a transfer", milliseconds(300));
  expect_no_fit();
}

TEST_F(Stopping, DuringAFitOfAThousandComponents) {
  report(1500);
  begin_fit("default,pose_spacing=0.01,max_poses_per_path=600,components=1000");
  expect_end_soon("a fit of 1000 components", milliseconds(1500));
  expect_no_fit();
}

TEST_F(Stopping, DuringAFitOfKernels) {
  report(3000);
  begin_fit("default,pose_spacing=0.01,max_poses_per_path=600,estimator=kde");
  expect_end_soon("a fit of kernels", milliseconds(700));
  expect_no_fit();
}

TEST_F(Stopping, DuringARehearsal) {
  report(100);
  FetchRequest rehearsed = request("default");
  rehearsed.experience_bytes = 100'000;
  rehearsed.rehearsed = true;
  rehearsed.deadline = milliseconds(300);
  static_cast<void>(client_.fetch(rehearsed));
  wait_until([this] { return status().queued_rehearsals > 0; });
  EXPECT_EQ(status().rehearsals, 0U) << "it was over";
  expect_end_soon("a rehearsal", milliseconds(1000));
}

TEST_F(Stopping, DuringAReset) {
  for (int i = 0; i < 20; ++i)
    report(250);
  AdminRequest reset;
  reset.verb = AdminVerb::ResetTask;
  reset.argument = "sweep";
  std::future<void> asked =
      std::async(std::launch::async, [&] { static_cast<void>(client_.admin(reset)); });
  expect_end_soon("a reset", milliseconds(20));
  client_.cancel();
  asked.get();
}

}  // namespace
}  // namespace kinship::stop_test
