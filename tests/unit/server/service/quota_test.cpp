// One client's flood is its own: what one may have is limited, said in words and counted.

#include <gtest/gtest.h>

#include <mutex>
#include <string>
#include <vector>

#include "server/catalog/freshness.hpp"
#include "tests/unit/server/service/catalog_fixture.hpp"

namespace kinship::service::quota_test {
namespace {

using std::chrono::seconds;

class Quota : public CatalogTest {
 protected:
  void start_with(const std::function<void(ServiceOptions&)>& adjust) {
    adjust_ = adjust;
    start();
  }
  FetchReply ask(const std::string& client, double x_m, seconds follow = seconds(0)) {
    FetchRequest request = at_once(elsewhere(request_for(pupil_), x_m));
    request.follow = follow;
    return begin_fetch(request, client + " " + std::to_string(++number_)).get();
  }
  std::string last(const std::string& what) const {
    for (const TroubleCount& trouble : service_->status().troubles)
      if (trouble.what == what)
        return trouble.last;
    return {};
  }
  std::uint64_t bound(const std::string& what) const {
    for (const BoundUse& bound : service_->status().bounds)
      if (bound.what == what)
        return bound.used;
    throw std::runtime_error("no bound " + what);
  }

  int number_ = 0;
};

TEST_F(Quota, AClientHasSoManyLeasesAndIsToldWhenItAsksForMore) {
  start_with([](ServiceOptions& options) { options.catalog.client_leases = 2; });
  for (int i = 0; i < 2; ++i)
    EXPECT_NE(ask("greedy", 0.001 * i, seconds(60)).status, FetchStatus::Busy);
  const FetchReply reply = ask("greedy", 0.5, seconds(60));
  EXPECT_EQ(reply.status, FetchStatus::Busy);
  EXPECT_EQ(reply.message,
            "this client follows 2 distributions already, the most one client may have (2)");
  EXPECT_GT(reply.retry_after.count(), 0);
  EXPECT_NE(ask("greedy", 0, seconds(90)).status, FetchStatus::Busy) << "its own may be renewed";
  EXPECT_NE(ask("robot", 0.5, seconds(60)).status, FetchStatus::Busy);
  EXPECT_EQ(last("fetch over quota"), reply.message);
}

TEST_F(Quota, AClientWaitsForSoManyRepliesAndFits) {
  fit_threads_ = 1;
  start_with([](ServiceOptions& options) {
    options.catalog.client_waiters = 3;
    options.catalog.client_fits = 2;
  });
  teach(6);
  gate_.close();
  EXPECT_EQ(ask("greedy", 0).status, FetchStatus::Pending);
  EXPECT_EQ(ask("greedy", 0.1).status, FetchStatus::Pending);
  EXPECT_EQ(ask("greedy", 0.2).message,
            "this client has 2 fits under way already, the most one client may have (2)");
  EXPECT_EQ(ask("robot", 0.2).status, FetchStatus::Pending);
  std::vector<std::future<FetchReply>> waiting;
  for (int i = 0; i < 3; ++i)
    waiting.push_back(begin_fetch(request_for(pupil_), "patient " + std::to_string(i)));
  EXPECT_EQ(begin_fetch(request_for(pupil_), "patient 3").get().message,
            "this client waits for 3 replies already, the most one client may have (3)");
  EXPECT_EQ(bound("fetches that wait"), 3U);
  gate_.open();
  for (std::future<FetchReply>& reply : waiting)
    EXPECT_EQ(reply.get().status, FetchStatus::Ready);
}

TEST_F(Quota, ARegistrationThatFindsNoRoomIsToldWhenToComeAgain) {
  start_with([](ServiceOptions& options) { options.client_short_tasks = 1; });
  teach(6);
  std::promise<void> go_on;
  const std::shared_future<void> gate = go_on.get_future().share();
  service_->administration().administer(
      fleet::question(AdminVerb::ListTasks), "other 1",
      [gate](const AdminPage&) { gate.wait(); },  // holds the only thread
      fleet::caller_here());
  const auto ask_again = [this] {
    const auto reply = std::make_shared<std::promise<RegisterReply>>();
    service_->registration().register_robot(
        fleet::pupil(), [reply](const RegisterReply& r) { reply->set_value(r); }, "greedy");
    return reply->get_future();
  };
  std::future<RegisterReply> first = ask_again();
  const RegisterReply second = ask_again().get();
  EXPECT_EQ(second.status, RegisterStatus::Refused);
  EXPECT_GT(second.retry_after.count(), 0);
  EXPECT_NE(second.message.find("busy"), std::string::npos);
  go_on.set_value();
  EXPECT_EQ(first.get().status, RegisterStatus::Known);
}

TEST_F(Quota, WhoTakesWhatIsListedAndCounted) {
  start_with([](ServiceOptions& options) {
    options.client_rates.attempts_per_s = 1;
    options.catalog.client_leases = 1;
  });
  EXPECT_FALSE(service_->admit("greedy", 100, 10));
  EXPECT_TRUE(service_->admit("greedy", 100, 10));
  ask("greedy", 0, seconds(60));
  ask("greedy", 1, seconds(60));
  const AdminPage page = administer(fleet::question(AdminVerb::ListClients));
  ASSERT_EQ(page.rows.size(), 1U);
  const auto& use = std::get<ClientUse>(page.rows[0]);
  EXPECT_EQ(use.client, "greedy");
  EXPECT_EQ(use.attempts, 10U);
  EXPECT_EQ(use.leases, 1U);
  EXPECT_EQ(use.refused, 2U);
  EXPECT_EQ(use.refused_for, "leases");
  metrics::Exposition exposed;
  service_->expose(exposed);
  for (const char* const line : {"kinship_quota_refusals_total{quota=\"attempts\"} 1",
                                 "kinship_quota_refusals_total{quota=\"leases\"} 1",
                                 "kinship_quota_refusals_total{quota=\"fits\"} 0"})
    EXPECT_NE(exposed.text().find(line), std::string::npos) << exposed.text();
  EXPECT_EQ(exposed.text().find("greedy"), std::string::npos) << "no series of a client";
}

TEST_F(Quota, AFitOfAnotherClientComesBeforeTheSecondOfOne) {
  fit_threads_ = 1;
  start();
  teach(6);
  gate_.close();
  std::mutex mutex;
  std::vector<std::string> order;
  std::vector<std::future<FetchReply>> replies;
  const auto begin = [&](const std::string& who, double x_m) {
    const auto reply = std::make_shared<std::promise<FetchReply>>();
    replies.push_back(reply->get_future());
    service_->fetches().fetch(elsewhere(request_for(pupil_), x_m), who,
                              [&, who, reply](const FetchReply& r) {
                                {
                                  const std::lock_guard lock(mutex);
                                  order.push_back(who);
                                }
                                reply->set_value(r);
                              });
    wait_for_short_tasks();  // so that fits are queued in this order
  };
  begin("greedy 0", 0);
  gate_.wait_for_calls(1);
  for (int i = 1; i < 4; ++i)
    begin("greedy " + std::to_string(i), 0.1 * i);
  begin("robot 0", 0.9);
  wait_for_short_tasks();
  gate_.open();
  for (std::future<FetchReply>& reply : replies)
    EXPECT_EQ(reply.get().status, FetchStatus::Ready);
  EXPECT_EQ(order,
            (std::vector<std::string>{"greedy 0", "greedy 1", "robot 0", "greedy 2", "greedy 3"}));
}

TEST_F(Quota, AFitThatCouldNeedTooMuchMemoryIsRefusedInWordsAndTakesNoDistributionsPlace) {
  constexpr std::size_t kMegabyte = std::size_t{1} << 20U;
  const auto with_memory = [](std::size_t bytes) {
    return [bytes](ServiceOptions& options) {
      options.fit = {};
      options.fit_memory_bytes = bytes;
    };
  };
  start_with(with_memory(512 * kMegabyte));
  teach(6);
  FetchRequest request = request_for(pupil_);
  request.profile = "default,pose_spacing=0.01,max_poses_per_path=0,max_solutions=100";
  ASSERT_EQ(fetch(request).status, FetchStatus::Ready);
  start_with(with_memory(16 * kMegabyte));
  teach(5, 100);
  EXPECT_EQ(fetch(request).status, FetchStatus::Ready) << "what is there is served";
  advance(catalog::kRefitInterval);
  const FetchReply own = fetch(elsewhere(request, 0.1));
  EXPECT_EQ(own.status, FetchStatus::Refused);
  for (const std::string word : {"a fit could need ", "11 paths", "100 configurations of 4 joints",
                                 "the limit is 16 MB (kinshipd --fit-memory-mb)", "pose_spacing"})
    EXPECT_NE(own.message.find(word), std::string::npos) << own.message;
  EXPECT_EQ(fetch(request).status, FetchStatus::Ready);  // and a refit is begun behind
  const std::string refit = "distribution " + fetch(request).distribution->id.short_hex();
  const auto give_up = std::chrono::steady_clock::now() + seconds(60);
  while (!last("fit over the memory limit").starts_with(refit) &&
         std::chrono::steady_clock::now() < give_up)
    wait_for_short_tasks();
  EXPECT_TRUE(last("fit over the memory limit").starts_with(refit));
  const FetchReply still = fetch(request);
  EXPECT_EQ(still.status, FetchStatus::Ready) << still.message;
  EXPECT_EQ(still.distribution->revision, 1U);
  request.profile = "default";
  EXPECT_EQ(fetch(request).status, FetchStatus::Ready) << "others are not concerned";
}

}  // namespace
}  // namespace kinship::service::quota_test
