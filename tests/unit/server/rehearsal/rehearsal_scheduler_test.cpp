#include "server/rehearsal/rehearsal_scheduler.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>

#include "server/rehearsal/rehearsal_reply.hpp"
#include "tests/unit/server/rehearsal/rehearsal_fixture.hpp"

namespace kinship::rehearsal {
namespace {

using namespace std::chrono_literals;

class RehearsalSchedulers : public RehearsalTest {
 protected:
  static RehearsalSchedulerOptions quick() {
    RehearsalSchedulerOptions options;
    options.plan = {.rounds = 1, .max_checks = 2000};
    options.max_queries = 4;
    return options;
  }
  RehearsalScheduler::Parts parts() { return {*store_, registry_, clock_, experience_}; }
  /// As a server has them.
  RehearsalScheduler::Parts kept() {
    RehearsalScheduler::Parts parts = this->parts();
    parts.rehearsals = store_.get();
    return parts;
  }
  RehearsalKey rehearsal_key(const Digest& robot) const {
    return {key_of(robot), kDefaultExperienceBytes};
  }
  std::future<SharedRehearsal> wait(RehearsalScheduler& experience_index, const Digest& robot,
                                    std::chrono::seconds patience = 300s) {
    const auto promise = std::make_shared<std::promise<SharedRehearsal>>();
    experience_index.wait(rehearsal_key(robot), clock_.now() + patience,
                          [promise](const SharedRehearsal& known) { promise->set_value(known); });
    return promise->get_future();
  }
  /// Reports, as the service does it.
  void learn(RehearsalScheduler& experience_index, std::size_t count) {
    report_sweeps(count);
    experience_.new_experience("sweep");
    experience_index.new_experience("sweep");
  }

  catalog::ExperienceIndex experience_{*store_, registry_};
};

TEST_F(RehearsalSchedulers, WhoWaitsGetsACompleteRehearsal) {
  report_sweeps(16);  // enough for either half, which their UUIDs say
  RehearsalScheduler experience_index(parts(), quick());
  for (const Digest& robot : {panda_, ur10e_}) {
    const SharedRehearsal known = wait(experience_index, robot).get();
    ASSERT_TRUE(known);
    EXPECT_TRUE(known->is_complete);
    EXPECT_EQ(known->queries + known->left_out, 4U);
    EXPECT_EQ(known->costs.size(), 16U) << "each guide, also after recall: " << known->message;
    EXPECT_GT(known->processor_time_s, 0);
    EXPECT_EQ(experience_index.find(identify(key_of(robot))), known);
  }
  EXPECT_EQ(experience_index.totals().done, 2U);
  EXPECT_EQ(experience_index.totals().queued, 0U);
}

TEST_F(RehearsalSchedulers, WhoDoesNotWaitGetsWhatIsKnown) {
  report_sweeps(6);
  RehearsalScheduler experience_index(parts(), quick());
  EXPECT_FALSE(experience_index.ask(rehearsal_key(panda_)));
  EXPECT_EQ(experience_index.totals().queued, 1U) << "asking begins it";
  const SharedRehearsal known = wait(experience_index, panda_).get();
  EXPECT_EQ(experience_index.ask(rehearsal_key(panda_)), known);
}

TEST_F(RehearsalSchedulers, ItIsDoneAnewOnceTheExperienceHasGrownMuch) {
  RehearsalScheduler experience_index(parts(), quick());
  learn(experience_index, 6);
  wait(experience_index, panda_).get();
  learn(experience_index, 2);
  wait(experience_index, panda_).get();
  EXPECT_EQ(experience_index.totals().done, 1U) << "two paths more are no reason";
  learn(experience_index, 8);
  wait(experience_index, panda_).get();
  EXPECT_EQ(experience_index.totals().done, 2U);
  experience_index.forget("sweep");
  wait(experience_index, panda_).get();
  EXPECT_EQ(experience_index.totals().done, 3U) << "a lost path is one";
}

TEST_F(RehearsalSchedulers, OfATaskThatWasRenamedOrRemovedNothingIsKnown) {
  report_sweeps(6);
  RehearsalScheduler experience_index(parts(), quick());
  wait(experience_index, panda_).get();
  experience_index.forget("another", RehearsalScheduler::Loss::Task);
  ASSERT_TRUE(experience_index.find(identify(key_of(panda_))));
  experience_index.forget("sweep", RehearsalScheduler::Loss::Task);
  EXPECT_FALSE(experience_index.find(identify(key_of(panda_))));
  EXPECT_FALSE(experience_index.library(rehearsal_key(panda_)));
  EXPECT_FALSE(experience_index.ask(rehearsal_key(panda_)));
}

TEST_F(RehearsalSchedulers, ARehearsalThatRunsWhileItsTaskIsRenamedIsNotKeptUnderTheFormerName) {
  report_sweeps(6);
  std::promise<void> renamed;
  std::promise<void> ended;
  RehearsalSchedulerOptions options = quick();
  options.log = [&](std::string_view) {  // before its result is kept
    ended.set_value();
    renamed.get_future().wait();
  };
  RehearsalScheduler scheduler(kept(), options);
  std::future<SharedRehearsal> answer = wait(scheduler, panda_);
  ended.get_future().wait();
  ASSERT_TRUE(store_->rename_task("sweep", "mop", nullptr));
  scheduler.forget("sweep", RehearsalScheduler::Loss::Task);
  renamed.set_value();
  EXPECT_FALSE(answer.get());
  EXPECT_FALSE(scheduler.find(identify(key_of(panda_))));
  EXPECT_FALSE(scheduler.library(rehearsal_key(panda_)));
  EXPECT_EQ(scheduler.totals().done, 0U);
  EXPECT_FALSE(RehearsalScheduler(kept(), quick()).find(identify(key_of(panda_))))
      << "of the store";
}

TEST_F(RehearsalSchedulers, AtItsDeadlineAWaiterGetsWhatIsKnownByThen) {
  report_sweeps(6);
  int woken = 0;
  RehearsalSchedulerOptions options = quick();
  options.wake = [&woken] { ++woken; };
  options.plan.rounds = 10'000;  // longer than any test
  RehearsalScheduler experience_index(parts(), options);
  const auto deadline = clock_.now() + 1h;
  std::future<SharedRehearsal> answer = wait(experience_index, panda_, 3600s);
  EXPECT_EQ(woken, 1);
  ASSERT_TRUE(experience_index.next_deadline());
  EXPECT_GE(*experience_index.next_deadline(), deadline);
  experience_index.expire(*experience_index.next_deadline());
  const SharedRehearsal known = answer.get();
  EXPECT_TRUE(!known || !known->is_complete);
  EXPECT_FALSE(experience_index.next_deadline());
}

TEST_F(RehearsalSchedulers, StoppingAnswersWhoWaits) {
  report_sweeps(6);
  RehearsalSchedulerOptions options = quick();
  options.plan.rounds = 10'000;
  options.processor_fraction = 1e-6;
  RehearsalScheduler experience_index(parts(), options);
  std::future<SharedRehearsal> answer = wait(experience_index, panda_);
  experience_index.stop();
  answer.get();
  EXPECT_FALSE(wait(experience_index, ur10e_).get()) << "nothing is begun any more";
}

TEST_F(RehearsalSchedulers, WithoutProcessorTimeNothingIsRehearsed) {
  report_sweeps(6);
  RehearsalSchedulerOptions options = quick();
  options.processor_fraction = 0;
  RehearsalScheduler experience_index(parts(), options);
  EXPECT_FALSE(wait(experience_index, panda_).get());
  EXPECT_FALSE(experience_index.ask(rehearsal_key(panda_)));
  EXPECT_EQ(experience_index.totals().queued, 0U);
}

TEST_F(RehearsalSchedulers, TheNextOneOverTheStoreAnswersAtOnce) {
  report_sweeps(6);
  Rehearsal made;
  std::uint64_t revision = 0;
  {
    RehearsalScheduler first(kept(), quick());
    made = *wait(first, panda_).get();
    revision = first.library(rehearsal_key(panda_))->revision;
  }
  RehearsalScheduler second(kept(), quick());
  const SharedRehearsal known = second.ask(rehearsal_key(panda_));
  ASSERT_TRUE(known);
  EXPECT_EQ(*known, made);
  EXPECT_EQ(*wait(second, panda_).get(), made);
  EXPECT_EQ(second.totals().done, 0U) << "it compared the paths alone";
  ASSERT_TRUE(second.library(rehearsal_key(panda_)));
  EXPECT_EQ(second.library(rehearsal_key(panda_))->revision, revision);
  EXPECT_EQ(second.find(identify(key_of(panda_))), known);
  EXPECT_FALSE(second.ask(rehearsal_key(ur10e_))) << "it is one robot's";
  RehearsalScheduler alone(parts(), quick());
  EXPECT_FALSE(alone.ask(rehearsal_key(panda_))) << "without the store's rehearsals";
}

TEST_F(RehearsalSchedulers, TheNextOneServesAPlacementNearAStoredOne) {
  report_sweeps(6);
  Rehearsal made;
  {
    RehearsalScheduler first(kept(), quick());
    made = *wait(first, panda_).get();
  }
  RehearsalScheduler second(kept(), quick());
  RehearsalKey near = rehearsal_key(panda_);
  near.distribution.T_task_base = Eigen::Isometry3d(Eigen::Translation3d(0.5, 0, 0));
  const SharedRehearsal known = second.ask(near);
  ASSERT_TRUE(known);
  EXPECT_EQ(*known, made);
  EXPECT_TRUE(second.library(near));
  near.distribution.since_ms = 1;
  EXPECT_FALSE(second.ask(near)) << "of another selection";
}

TEST_F(RehearsalSchedulers, AStoredOneIsComparedWithTheExperienceOfToday) {
  std::vector<Attempt> reports = report_sweeps(6);
  static_cast<void>(wait(*std::make_unique<RehearsalScheduler>(kept(), quick()), panda_).get());
  report_sweeps(10);
  {
    RehearsalScheduler grown(kept(), quick());
    EXPECT_TRUE(grown.find(identify(key_of(panda_)))) << "until there is a newer one";
    static_cast<void>(wait(grown, panda_).get());
    EXPECT_EQ(grown.totals().done, 1U);
  }
  EXPECT_TRUE(RehearsalScheduler(kept(), quick()).ask(rehearsal_key(panda_)));
  ASSERT_TRUE(store_->retire_path(reports[0].report_uuid));
  RehearsalScheduler after(kept(), quick());
  EXPECT_FALSE(after.library(rehearsal_key(panda_))) << "it has a path that is retired";
  EXPECT_FALSE(after.ask(rehearsal_key(panda_)));
}

TEST_F(RehearsalSchedulers, AReplyCarriesIt) {
  report_sweeps(6);
  RehearsalScheduler experience_index(parts(), quick());
  FetchRequest request;
  request.task = "sweep";
  request.robot = panda_;
  request.profile = "default,components=2";
  request.deadline = 300s;
  request.experience_bytes = kDefaultExperienceBytes;
  request.rehearsed = true;
  const auto reply_to = [&](FetchStatus status) {
    std::promise<FetchReply> promise;
    FetchReply reply;
    reply.status = status;
    with_rehearsal(experience_index, request, clock_.now(),
                   [&](const FetchReply& sent) { promise.set_value(sent); })(reply);
    return promise.get_future().get();
  };
  EXPECT_FALSE(reply_to(FetchStatus::Busy).rehearsal);
  const FetchReply ready = reply_to(FetchStatus::Pending);
  ASSERT_TRUE(ready.rehearsal);
  EXPECT_TRUE(ready.rehearsal->is_complete);
  request.rehearsed = false;
  EXPECT_TRUE(reply_to(FetchStatus::Ready).rehearsal) << "it is known by now";
  EXPECT_FALSE(reply_to(FetchStatus::UnknownRobot).rehearsal);
}

}  // namespace
}  // namespace kinship::rehearsal
