// Faults of the server's own: no memory, no thread, a store or a robot that cannot be read.
// Nobody's report is refused for them, and nothing good is lost.

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <future>
#include <latch>
#include <new>
#include <system_error>
#include <vector>

#include "server/catalog/fit_troubles.hpp"
#include "server/catalog/freshness.hpp"
#include "tests/unit/server/service/catalog_fixture.hpp"

namespace kinship::service::own_faults_test {
namespace {

using std::chrono::seconds;

class OwnFaults : public CatalogTest {
 protected:
  OwnFaults() {
    may_trouble_store_ = true;
    start();
  }
  std::uint64_t troubles(const std::string& what) const {
    for (const TroubleCount& trouble : service_->status().troubles)
      if (trouble.what == what)
        return trouble.count;
    return 0;
  }
  std::future<AdminPage> begin_reset(const std::string& task) {
    const auto page = std::make_shared<std::promise<AdminPage>>();
    service_->administration().administer(
        fleet::question(AdminVerb::ResetTask, task), "",
        [page](const AdminPage& answer) { page->set_value(answer); }, fleet::caller_here());
    return page->get_future();
  }
  std::string next_fit(const Digest& id) {
    const AdminPage page = administer(fleet::question(AdminVerb::ExplainDistribution, id.hex()));
    return std::get<Explanation>(page.rows.at(0)).next_fit;
  }
};

/// Who may have done nothing wrong, and may find things well again later.
const std::vector<std::function<void()>> kPassing = {
    [] { throw std::bad_alloc(); },
    [] {
      throw std::system_error(std::make_error_code(std::errc::resource_unavailable_try_again));
    },
    [] { throw Failure(ErrorCode::Storage, "disk I/O error"); }};

TEST_F(OwnFaults, ARefitThatEndsForWantOfSomethingTakesNoDistributionsPlace) {
  teach(6);
  for (std::size_t i = 0; i < kPassing.size(); ++i) {
    FetchRequest request = request_for(teacher_);
    request.profile += ",components=" + std::to_string(i + 1);
    ASSERT_EQ(fetch(request).distribution->revision, 1U);
    teach(5, 100 * (i + 1));
    advance(catalog::kRefitInterval);
    const int calls = gate_.calls();
    gate_.set_trouble(kPassing[i]);
    const FetchReply reply = fetch(with_generation(request, i + 2));
    EXPECT_EQ(reply.status, FetchStatus::Busy) << i;
    EXPECT_GT(reply.retry_after.count(), 0);
    EXPECT_EQ(troubles("fit to be tried again"), i + 1);
    for (int again = 0; again < 5; ++again) {
      const FetchReply good = fetch(request);
      EXPECT_EQ(good.status, FetchStatus::Ready) << good.message;
      EXPECT_EQ(good.distribution->revision, 1U);
    }
    EXPECT_EQ(fetch(with_generation(request, i + 2)).status, FetchStatus::Busy);
    wait_for_short_tasks();
    EXPECT_EQ(gate_.calls(), calls + 1) << "it is not tried at each fetch";
    EXPECT_NE(
        next_fit(reply.distribution ? reply.distribution->id : fetch(request).distribution->id)
            .find("the last fit made nothing (1 time): "),
        std::string::npos);
    gate_.set_trouble({});
    advance(catalog::FitTroubles::kFirstRetry);
    EXPECT_EQ(fetch(with_generation(request, i + 2)).distribution->revision, 2U);
  }
  start();
  EXPECT_EQ(fetch(at_once(request_for(teacher_))).status, FetchStatus::Pending)
      << "what failed is not stored under another name";
}

TEST_F(OwnFaults, AFitThatEndsAgainAndAgainIsTriedMoreAndMoreSeldom) {
  teach(6);
  gate_.set_trouble(kPassing[0]);
  int expected = 0;
  for (const int pause : {1, 2, 4, 8}) {
    EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Busy);
    EXPECT_EQ(gate_.calls(), ++expected);
    advance(seconds(pause) - std::chrono::milliseconds(1));
    EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Busy);
    EXPECT_EQ(gate_.calls(), expected) << pause;
    advance(std::chrono::milliseconds(1));
  }
}

TEST_F(OwnFaults, ARobotThatCannotBeReadAnyMoreIsNobodysFault) {
  RobotDescription unreadable = fleet::planar("unreadable", {0.4});
  unreadable.urdf = "<robot name='as an older version took it'/>";
  const RobotDescription other = fleet::planar("reads_as_another", {0.4, 0.1});
  std::uint8_t number = 1;
  for (const RobotDescription& description : {unreadable, other}) {
    Digest digest;
    digest.bytes.fill(number++);
    ASSERT_TRUE(real_store_->register_robot(
        {.digest = digest, .description = description, .dof = 3, .registered_ms = 1}));
    Attempt attempt = fleet::solved(teacher_, "shelf", 1);
    attempt.robot = digest;
    const Receipt receipt = report({attempt}).receipts.at(0);
    EXPECT_EQ(receipt.status, ReceiptStatus::TryAgain) << receipt.message;
    EXPECT_NE(receipt.message.find("robot '" + description.label + "'"), std::string::npos);
    FetchRequest request = request_for(teacher_);
    request.robot = digest;
    EXPECT_EQ(fetch(request).status, FetchStatus::Busy);
  }
  EXPECT_EQ(service_->status().reports_refused, 0U);
  EXPECT_GE(troubles("robot unreadable"), 4U);
  EXPECT_EQ(troubles("report to be sent again"), 2U);
}

TEST_F(OwnFaults, AResetThatFailsMidwayLeavesNothingOfItInMemory) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 6, 1);
  report(attempts);
  EXPECT_EQ(fetch(request_for(pupil_)).distribution->sources[0].paths, 6U);
  troubled_->on_reset = [&](std::string_view) {
    EXPECT_TRUE(real_store_->retire_path(attempts[0].report_uuid));
    throw Failure(ErrorCode::Storage, "disk I/O error");
  };
  EXPECT_EQ(begin_reset("shelf").get().status, AdminStatus::Failed);
  const FetchReply reply = fetch(request_for(pupil_));
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->sources[0].paths, 5U);
}

TEST_F(OwnFaults, AResetKeepsNobodyWaiting) {
  teach(6);
  fetch(request_for(pupil_));
  std::latch begun(1), may_go_on(1);
  troubled_->on_reset = [&](std::string_view) {
    begun.count_down();
    may_go_on.wait();
  };
  std::future<AdminPage> reset = begin_reset("shelf");
  begun.wait();
  std::future<void> others = std::async(std::launch::async, [this] {
    EXPECT_EQ(register_robot(fleet::planar("late", {0.5, 0.1})).status, RegisterStatus::Registered);
    EXPECT_EQ(report({fleet::solved(teacher_, "shelf", 77)}).receipts.at(0).status,
              ReceiptStatus::Stored);
    EXPECT_EQ(fetch(request_for(dwarf_)).status, FetchStatus::Failed);
    EXPECT_EQ(administer(fleet::question(AdminVerb::ListRobots)).rows.size(), 4U);
  });
  EXPECT_EQ(others.wait_for(seconds(60)), std::future_status::ready)
      << "what others asked for waits behind a reset";
  may_go_on.count_down();
  EXPECT_EQ(reset.get().status, AdminStatus::Ok);
  others.get();
}

TEST_F(OwnFaults, AResetEndsWithTheServerAndSaysHowFarItCame) {
  constexpr int kPaths = 1200;  // more than a transaction has
  for (int first = 0; first < kPaths; first += 200)
    report(fleet::solved(teacher_, "shelf", 200, static_cast<std::uint64_t>(first)));
  std::latch begun(1), may_go_on(1);
  troubled_->on_reset = [&](std::string_view) {
    begun.count_down();
    may_go_on.wait();
  };
  std::future<AdminPage> reset = begin_reset("shelf");
  begun.wait();
  std::future<void> end = std::async(std::launch::async, [this] { service_->shutdown(); });
  // Fetches are refused once the server stops, which is after resets were told to.
  while (fetch(at_once(request_for(pupil_))).message != "the server is stopping")
    continue;
  may_go_on.count_down();
  const AdminPage page = reset.get();
  EXPECT_EQ(page.status, AdminStatus::Failed);
  EXPECT_NE(page.message.find("stopping after 500 paths were retired"), std::string::npos)
      << page.message;
  end.get();
}

}  // namespace
}  // namespace kinship::service::own_faults_test
