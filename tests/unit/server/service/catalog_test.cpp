#include "server/catalog/catalog.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>
#include <thread>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "server/catalog/freshness.hpp"
#include "server/metrics/exposition.hpp"
#include "tests/support/store_values.hpp"
#include "tests/unit/server/service/catalog_fixture.hpp"
#include "tests/unit/server/troubled_store.hpp"

namespace kinship::service::catalog_test {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

TEST_F(CatalogTest, SaysWhyThereIsNothing) {
  FetchReply reply = fetch(request_for(teacher_));
  EXPECT_EQ(reply.status, FetchStatus::NoExperience);
  EXPECT_EQ(reply.message, "no paths of task 'shelf'");
  FetchRequest request = request_for(teacher_);
  request.robot.bytes[0] ^= 1U;
  reply = fetch(request);
  EXPECT_EQ(reply.status, FetchStatus::UnknownRobot);
  EXPECT_EQ(reply.message,
            "robot " + request.robot.short_hex() + " is not known here; register it first");
  request.profile = "best";
  reply = fetch(request);
  EXPECT_EQ(reply.status, FetchStatus::Refused);
  EXPECT_EQ(reply.message, "profile 'best': it does not begin with default or paper");
  EXPECT_EQ(gate_.calls(), 0);
}

TEST_F(CatalogTest, ATaskWithoutPathsIsComparedWithTheNamesOfOthersNowAndThen) {
  may_trouble_store_ = true;
  start();
  test::report(*real_store_, fleet::solved(teacher_, "shelf", 1, 1));
  FetchRequest request = request_for(teacher_);
  request.task = "shelv";
  for (int i = 0; i < 5; ++i)
    EXPECT_EQ(fetch(request).message, "no paths of task 'shelv' (did you mean 'shelf'?)");
  EXPECT_EQ(troubled_->name_searches, 1U);
  advance(catalog::NearestTasks::kRemembered);
  fetch(request);
  EXPECT_EQ(troubled_->name_searches, 2U);
}

TEST_F(CatalogTest, HoweverManyAskThereIsOneFit) {
  teach(6);
  gate_.close();
  constexpr int kAskers = 16;
  std::vector<std::future<FetchReply>> replies(kAskers);
  std::vector<std::thread> askers;
  askers.reserve(replies.size());
  for (std::size_t i = 0; i < replies.size(); ++i)
    askers.emplace_back([&, i] {
      replies[i] = begin_fetch(request_for(pupil_), "request_key " + std::to_string(i));
    });
  for (std::thread& request_key : askers)
    request_key.join();
  gate_.open();
  for (std::future<FetchReply>& reply : replies) {
    const FetchReply got = reply.get();
    ASSERT_EQ(got.status, FetchStatus::Ready) << got.message;
    EXPECT_EQ(got.distribution->revision, 1U);
  }
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(CatalogTest, TheSecondFetchIsAnsweredFromMemoryDuringTheCall) {
  teach(6);
  const FetchReply first = fetch(request_for(pupil_));
  std::future<FetchReply> second = begin_fetch(at_once(request_for(pupil_)), "two");
  ASSERT_EQ(second.wait_for(seconds(0)), std::future_status::ready);
  EXPECT_EQ(second.get().distribution->id, first.distribution->id);
  const ServerStatus status = service_->status();
  EXPECT_EQ(status.fetches, 2U);
  EXPECT_EQ(status.fetches_from_memory, 1U);
  EXPECT_EQ(status.fits, 1U);
}

TEST_F(CatalogTest, AFetchUnderWayIsAMissForEver) {
  const auto misses = [this] {
    metrics::Exposition page;
    service_->expose(page);
    const std::string name = "\nkinship_cache_misses_total ";
    return std::stoi(page.text().substr(page.text().find(name) + name.size()));
  };
  teach(6);
  gate_.close();
  std::future<FetchReply> first = begin_fetch(request_for(pupil_), "one");
  gate_.wait_for_calls(1);
  EXPECT_EQ(misses(), 1);
  gate_.open();
  EXPECT_EQ(first.get().status, FetchStatus::Ready);
  EXPECT_EQ(misses(), 1);
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
  EXPECT_EQ(misses(), 1) << "a hit";
}

TEST_F(CatalogTest, EqualValuesAreOneDistributionInTheWordsOfEachWhoAsks) {
  teach(6);
  FetchRequest wordy = request_for(pupil_);
  while (wordy.profile.size() + 14 <= kMaxProfileBytes)
    wordy.profile += ",components=3";
  FetchRequest brief = request_for(pupil_);
  brief.profile += ",components=3";
  gate_.close();
  std::future<FetchReply> first = begin_fetch(wordy, "one");
  std::future<FetchReply> beside = begin_fetch(brief, "two");
  gate_.open();
  const FetchReply fitted = first.get();
  ASSERT_EQ(fitted.status, FetchStatus::Ready) << fitted.message;
  EXPECT_EQ(fitted.distribution->profile, wordy.profile);
  const FetchReply waited = beside.get();
  EXPECT_EQ(waited.distribution->profile, brief.profile);
  EXPECT_EQ(waited.distribution->id, fitted.distribution->id);
  EXPECT_EQ(fetch(at_once(brief)).distribution->profile, brief.profile);
  start();
  EXPECT_EQ(fetch(brief).distribution->profile, brief.profile);
  EXPECT_EQ(fetch(wordy).distribution->profile, wordy.profile);
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(CatalogTest, TheStoreHearsOfUsesOncePerHourAlsoOfThoseFromMemory) {
  may_trouble_store_ = true;
  start();
  teach(6);
  fetch(request_for(teacher_));  // fitted and stored now
  for (int i = 0; i < 3; ++i)
    fetch(request_for(teacher_));
  EXPECT_EQ(troubled_->uses_noted, 1);
  advance(std::chrono::minutes(61));
  for (int i = 0; i < 3; ++i)
    fetch(request_for(teacher_));
  EXPECT_EQ(troubled_->uses_noted, 2);
  start();
  fetch(request_for(teacher_));
  EXPECT_EQ(troubled_->uses_noted, 1) << "read from the store";
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(CatalogTest, AGrownExperienceIsServedAsItWasAndFittedBehind) {
  teach(6);
  fetch(request_for(teacher_));
  teach(5, 100);
  EXPECT_EQ(fetch(request_for(teacher_)).distribution->revision, 1U);
  wait_for_short_tasks();
  EXPECT_EQ(gate_.calls(), 1) << "10 s have not passed since the fit";

  advance(catalog::kRefitInterval);
  EXPECT_EQ(fetch(request_for(teacher_)).distribution->revision, 1U);
  gate_.wait_for_calls(2);
  EXPECT_EQ(fetch(with_generation(request_for(teacher_), 2)).distribution->revision, 2U);
  EXPECT_EQ(fetch(request_for(teacher_)).distribution->sources[0].paths, 11U);
  EXPECT_EQ(gate_.calls(), 2);
}

TEST_F(CatalogTest, GrowthIsSeenAfterARestartToo) {
  teach(6);
  fetch(request_for(teacher_));
  teach(5, 100);
  advance(catalog::kRefitInterval);
  start();
  EXPECT_EQ(fetch(request_for(teacher_)).distribution->revision, 1U);
  gate_.wait_for_calls(2);
}

TEST_F(CatalogTest, FourNewPathsAreNoReasonForAFit) {
  teach(6);
  fetch(request_for(teacher_));
  teach(4, 100);
  advance(catalog::kRefitInterval);
  fetch(request_for(teacher_));
  wait_for_short_tasks();
  EXPECT_EQ(service_->status().queued_fits, 0U);
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(CatalogTest, AMinimumGenerationForcesAFitThatKnowsIt) {
  teach(6);
  fetch(request_for(teacher_));
  teach(1, 100);
  const FetchReply reply = fetch(with_generation(request_for(teacher_), 2));
  ASSERT_EQ(reply.status, FetchStatus::Ready);
  EXPECT_EQ(reply.distribution->revision, 2U);
  EXPECT_EQ(reply.distribution->sources[0].generation, 2U);
}

TEST_F(CatalogTest, AGenerationThatHasNotArrivedIsWaitedFor) {
  teach(6);
  fetch(request_for(teacher_));
  std::future<FetchReply> reply = begin_fetch(with_generation(request_for(teacher_), 2), "early");
  wait_for_short_tasks();
  EXPECT_NE(reply.wait_for(seconds(0)), std::future_status::ready);
  teach(1, 100);
  EXPECT_EQ(reply.get().distribution->sources[0].generation, 2U);
}

TEST_F(CatalogTest, PastItsDeadlineAFetchIsPendingAndTheFitGoesOn) {
  teach(6);
  gate_.close();
  FetchRequest request = request_for(pupil_);
  request.deadline = seconds(1);
  const auto now = clock_.now();
  std::future<FetchReply> reply = begin_fetch(request, "one");
  gate_.wait_for_calls(1);
  EXPECT_EQ(service_->next_deadline(), now + seconds(1));
  service_->expire(now + milliseconds(999));
  EXPECT_NE(reply.wait_for(seconds(0)), std::future_status::ready);
  service_->expire(now + seconds(1));
  EXPECT_EQ(reply.get().status, FetchStatus::Pending);
  EXPECT_EQ(service_->next_deadline(), std::nullopt);
  gate_.open();
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(CatalogTest, WithoutADeadlineTheFitIsBegunAndTheReplyIsPending) {
  teach(6);
  gate_.close();
  EXPECT_EQ(fetch(at_once(request_for(pupil_))).status, FetchStatus::Pending);
  gate_.wait_for_calls(1);
  EXPECT_EQ(fetch(at_once(request_for(pupil_))).status, FetchStatus::Pending);
  gate_.open();
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(CatalogTest, MoreFitsThanMayWaitAreBusyWithATimeToRetry) {
  fit_threads_ = 1;
  fit_queue_ = 1;
  start();
  teach(6);
  gate_.close();
  EXPECT_EQ(fetch(at_once(request_for(pupil_))).status, FetchStatus::Pending);
  gate_.wait_for_calls(1);
  EXPECT_EQ(fetch(at_once(elsewhere(request_for(pupil_), 0.1))).status, FetchStatus::Pending);
  const FetchReply reply = fetch(elsewhere(request_for(pupil_), 0.2));
  EXPECT_EQ(reply.status, FetchStatus::Busy);
  EXPECT_GT(reply.retry_after, milliseconds(0));
  gate_.open();
  EXPECT_EQ(fetch(elsewhere(request_for(pupil_), 0.1)).status, FetchStatus::Ready);
  EXPECT_EQ(fetch(elsewhere(request_for(pupil_), 0.2)).status, FetchStatus::Ready);
}

TEST_F(CatalogTest, AFailureIsKeptWithItsReasonUntilTheExperienceChanges) {
  teach(3);
  const FetchReply reply = fetch(request_for(dwarf_));
  ASSERT_EQ(reply.status, FetchStatus::Failed);
  ASSERT_TRUE(reply.distribution);
  EXPECT_EQ(reply.message, reply.distribution->reason);
  EXPECT_NE(reply.message.find("out of reach"), std::string::npos) << reply.message;
  EXPECT_EQ(fetch(request_for(dwarf_)).status, FetchStatus::Failed);
  start();
  EXPECT_EQ(fetch(request_for(dwarf_)).status, FetchStatus::Failed);
  EXPECT_EQ(gate_.calls(), 1);

  report(fleet::solved(dwarf_, "shelf", 5, 7));
  EXPECT_EQ(fetch(request_for(dwarf_)).status, FetchStatus::Failed) << "10 s have not passed";
  advance(catalog::kRefitInterval);
  const FetchReply later = fetch(request_for(dwarf_));
  EXPECT_EQ(later.status, FetchStatus::Ready) << later.message;
  EXPECT_EQ(later.distribution->revision, 2U);
}

TEST_F(CatalogTest, AWaiterThatAsksAgainTakesItsOwnPlace) {
  teach(6);
  gate_.close();
  std::future<FetchReply> first = begin_fetch(request_for(pupil_), "one");
  const auto deadline = service_->next_deadline();
  advance(seconds(5));
  std::future<FetchReply> again = begin_fetch(request_for(pupil_), "one");
  EXPECT_EQ(service_->next_deadline(), deadline) << "the deadline counts from the first time";
  gate_.open();
  EXPECT_EQ(again.get().status, FetchStatus::Ready);
  EXPECT_THROW(first.get(), std::future_error);  // its callback was dropped
}

TEST_F(CatalogTest, ABackgroundFitThatSomebodyWaitsForGoesFirstAndIsDoneOnce) {
  teach(6);
  fetch(request_for(teacher_));
  teach(5, 100);
  advance(catalog::kRefitInterval);
  gate_.close();
  fetch(at_once(request_for(pupil_)));  // these two hold the two workers
  fetch(at_once(elsewhere(request_for(pupil_), 0.1)));
  gate_.wait_for_calls(3);
  fetch(request_for(teacher_));  // queues the background fit
  wait_for_short_tasks();
  std::future<FetchReply> urgent = begin_fetch(with_generation(request_for(teacher_), 2), "now");
  gate_.let_one_pass();  // that worker begins the fit, now urgent
  gate_.wait_for_calls(4);
  gate_.let_one_pass();  // the other finds the background job of the same fit
  while (service_->status().queued_fits > 0)
    std::this_thread::yield();
  gate_.open();
  EXPECT_EQ(urgent.get().distribution->revision, 2U);
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
  service_->shutdown();
  EXPECT_EQ(gate_.calls(), 4);
}

TEST_F(CatalogTest, StoppingAnswersThoseWhoWait) {
  teach(6);
  gate_.close();
  std::future<FetchReply> reply = begin_fetch(request_for(pupil_), "one");
  gate_.wait_for_calls(1);
  std::thread stopper([this] { service_->shutdown(); });
  const FetchReply got = reply.get();
  EXPECT_EQ(got.status, FetchStatus::Busy);
  EXPECT_EQ(got.message, "the server is stopping");
  gate_.open();
  stopper.join();
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Busy);
}

TEST_F(CatalogTest, ManyClientsReportingAndFetchingAtOnceAllGetTheirAnswers) {
  teach(6);
  constexpr int kClients = 4, kRounds = 3;
  std::vector<std::thread> clients;
  clients.reserve(kClients);
  std::atomic<int> ready = 0;
  for (int client = 0; client < kClients; ++client)
    clients.emplace_back([&, client] {
      for (int round = 0; round < kRounds; ++round) {
        const std::uint64_t seed =
            1000 * static_cast<std::uint64_t>(client + 1) + 10 * static_cast<std::uint64_t>(round);
        report(fleet::solved(teacher_, "shelf", 2, seed));
        advance(seconds(4));
        const FetchRequest request =
            elsewhere(request_for(client % 2 == 0 ? teacher_ : pupil_), 0.01 * (client % 2));
        if (begin_fetch(request, std::to_string(client)).get().status == FetchStatus::Ready)
          ++ready;
        service_->expire(clock_.now() - seconds(60));
        administer(fleet::question(AdminVerb::ListDistributions));
      }
    });
  for (std::thread& client : clients)
    client.join();
  EXPECT_EQ(ready, kClients * kRounds);
}

TEST_F(CatalogTest, ADamagedSourceIsLeftOutOfTheFitWhichSaysSo) {
  teach(6);
  report(fleet::solved(dwarf_, "shelf", 2, 50));
  start();  // the fit's registry has nothing in memory
  store::damage_robot(directory_ / "fleet.db", "dwarf");
  const FetchReply reply = fetch(request_for(pupil_));
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_NE(reply.distribution->reason.find(dwarf_.digest.short_hex() + "': left out"),
            std::string::npos)
      << reply.distribution->reason;
}

TEST_F(CatalogTest, AFitThatThrowsIsAFailureWithItsReasonAndNotTriedForEver) {
  teach(6);
  gate_.set_trouble([] { throw std::length_error("too long"); });
  const FetchReply reply = fetch(request_for(teacher_));
  ASSERT_EQ(reply.status, FetchStatus::Failed) << reply.message;
  EXPECT_EQ(reply.distribution->reason, "the fit ended: too long");
  EXPECT_EQ(reply.distribution->revision, 1U);
  ASSERT_EQ(reply.distribution->sources.size(), 1U);
  EXPECT_EQ(reply.distribution->sources[0].label, "teacher");
  advance(catalog::kRefitInterval);
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Failed);
  EXPECT_EQ(gate_.calls(), 1);
}

TEST_F(CatalogTest, AFitThatTheStoreEndedIsBusyAndTriedAgain) {
  teach(6);
  gate_.set_trouble([] { throw Failure(ErrorCode::Storage, "disk I/O error"); });
  const FetchReply reply = fetch(request_for(teacher_));
  EXPECT_EQ(reply.status, FetchStatus::Busy);
  EXPECT_EQ(reply.message, "disk I/O error");
  gate_.set_trouble({});
  advance(catalog::FitTroubles::kFirstRetry);
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
}

TEST_F(CatalogTest, TheReasonOfAFailureIsCutBetweenCharacters) {
  teach(6);
  std::string words = "x";
  while (words.size() < 2 * kMaxMessageBytes)
    words += "\xE2\x82\xAC";
  for (int shift = 0; shift < 3; ++shift, words.insert(0, "x")) {
    gate_.set_trouble([words] { throw std::runtime_error(words); });
    const FetchReply reply = fetch(elsewhere(request_for(teacher_), 0.1 * shift));
    ASSERT_EQ(reply.status, FetchStatus::Failed);
    EXPECT_FALSE(check_text("reason", reply.distribution->reason, kMaxMessageBytes));
  }
}

TEST_F(CatalogTest, ALookThatTheDeskHadNoRoomForIsTakenLater) {
  short_task_queue_ = 2;
  start();
  teach(6);
  fetch(request_for(teacher_));
  std::future<FetchReply> early = begin_fetch(with_generation(request_for(teacher_), 2), "early");
  wait_for_short_tasks();

  std::promise<void> release;
  const std::shared_future<void> released = release.get_future().share();
  const auto question = fleet::question(AdminVerb::ListTasks);
  for (bool is_held = false; !is_held;) {  // refused ones are answered on this thread
    std::promise<bool> begun;
    service_->administration().administer(
        question, "",
        [&begun, released](const AdminPage& page) {
          const bool is_short_task = page.status == AdminStatus::Ok;
          begun.set_value(is_short_task);
          if (is_short_task)
            released.wait();
        },
        fleet::caller_here());
    is_held = begun.get_future().get();
  }
  for (bool is_full = false; !is_full;) {
    const auto refused = std::make_shared<std::atomic<bool>>(false);
    service_->administration().administer(
        question, "",
        [refused](const AdminPage& page) { *refused = page.status != AdminStatus::Ok; },
        fleet::caller_here());
    is_full = *refused;
  }
  teach(1, 100);  // its robot is in memory: no need of the short task pool
  const auto retry = service_->next_deadline();
  ASSERT_TRUE(retry);
  EXPECT_LT(*retry, clock_.now() + seconds(1));
  release.set_value();
  while (early.wait_for(milliseconds(1)) != std::future_status::ready)
    service_->expire(*retry);  // again if other work of the short task pool came first
  const FetchReply reply = early.get();
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->sources[0].generation, 2U);
}

TEST_F(CatalogTest, AReplyFromMemoryCarriesTheAdviceOfTheMoment) {
  teach(6);
  const FetchReply before = fetch(request_for(pupil_));
  wait_for_short_tasks();
  std::vector<Attempt> attempts;
  for (int i = 0; i < 24; ++i) {
    attempts.push_back(fleet::unsolved(pupil_.digest, "shelf"));
    attempts.back().record.sampling_mode =
        i % 2 == 0 ? SamplingMode::Guided : SamplingMode::Control;
    attempts.back().record.collision_checks = 100;
  }
  report(attempts);
  FetchReply after = fetch(at_once(request_for(pupil_)));
  while (!after.distribution->advice.control) {  // the sums may still be on their way
    wait_for_short_tasks();
    after = fetch(at_once(request_for(pupil_)));
  }
  EXPECT_EQ(after.distribution->advice.control->attempts, 12U);
  EXPECT_NE(after.distribution->advice.evidence, before.distribution->advice.evidence);
  EXPECT_EQ(after.distribution->revision, 1U);
  EXPECT_EQ(gate_.calls(), 1);
}

}  // namespace
}  // namespace kinship::service::catalog_test
