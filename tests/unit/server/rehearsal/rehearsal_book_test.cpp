#include "server/rehearsal/rehearsal_book.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <future>

#include "server/rehearsal/rehearsal_reply.hpp"
#include "tests/unit/server/rehearsal/rehearsal_fixture.hpp"

namespace kinship::rehearsal {
namespace {

using namespace std::chrono_literals;

class RehearsalBooks : public RehearsalTest {
 protected:
  static RehearsalBookOptions quick() {
    RehearsalBookOptions options;
    options.plan = {.rounds = 1, .max_checks = 2000};
    options.max_queries = 4;
    return options;
  }
  RehearsalBook::Parts parts() { return {*store_, registry_, clock_, experience_}; }
  RehearsalKey rehearsal_key(const Digest& robot) const {
    return {key_of(robot), kDefaultExperienceBytes};
  }
  std::future<SharedRehearsal> wait(RehearsalBook& book, const Digest& robot,
                                    std::chrono::seconds patience = 300s) {
    const auto promise = std::make_shared<std::promise<SharedRehearsal>>();
    book.wait(rehearsal_key(robot), clock_.now() + patience,
              [promise](const SharedRehearsal& known) { promise->set_value(known); });
    return promise->get_future();
  }
  /// Reports, as the service does it.
  void learn(RehearsalBook& book, std::size_t count) {
    report_sweeps(count);
    experience_.new_experience("sweep");
    book.new_experience("sweep");
  }

  catalog::ExperienceBook experience_{*store_, registry_};
};

TEST_F(RehearsalBooks, WhoWaitsGetsACompleteRehearsal) {
  report_sweeps(16);  // enough for either half, which their UUIDs say
  RehearsalBook book(parts(), quick());
  for (const Digest& robot : {panda_, ur10e_}) {
    const SharedRehearsal known = wait(book, robot).get();
    ASSERT_TRUE(known);
    EXPECT_TRUE(known->is_complete);
    EXPECT_EQ(known->queries + known->left_out, 4U);
    EXPECT_EQ(known->costs.size(), kMaxGuideCosts) << known->message;
    EXPECT_GT(known->processor_time_s, 0);
    EXPECT_EQ(book.find(identify(key_of(robot))), known);
  }
  EXPECT_EQ(book.totals().done, 2U);
  EXPECT_EQ(book.totals().queued, 0U);
}

TEST_F(RehearsalBooks, WhoDoesNotWaitGetsWhatIsKnown) {
  report_sweeps(6);
  RehearsalBook book(parts(), quick());
  EXPECT_FALSE(book.ask(rehearsal_key(panda_)));
  EXPECT_EQ(book.totals().queued, 1U) << "asking begins it";
  const SharedRehearsal known = wait(book, panda_).get();
  EXPECT_EQ(book.ask(rehearsal_key(panda_)), known);
}

TEST_F(RehearsalBooks, ItIsDoneAnewOnceTheExperienceHasGrownMuch) {
  RehearsalBook book(parts(), quick());
  learn(book, 6);
  wait(book, panda_).get();
  learn(book, 2);
  wait(book, panda_).get();
  EXPECT_EQ(book.totals().done, 1U) << "two paths more are no reason";
  learn(book, 8);
  wait(book, panda_).get();
  EXPECT_EQ(book.totals().done, 2U);
  book.forget("sweep");
  wait(book, panda_).get();
  EXPECT_EQ(book.totals().done, 3U) << "a lost path is one";
}

TEST_F(RehearsalBooks, AtItsDeadlineAWaiterGetsWhatIsKnownByThen) {
  report_sweeps(6);
  int woken = 0;
  RehearsalBookOptions options = quick();
  options.wake = [&woken] { ++woken; };
  options.plan.rounds = 10'000;  // longer than any test
  RehearsalBook book(parts(), options);
  const auto deadline = clock_.now() + 1h;
  std::future<SharedRehearsal> answer = wait(book, panda_, 3600s);
  EXPECT_EQ(woken, 1);
  ASSERT_TRUE(book.next_deadline());
  EXPECT_GE(*book.next_deadline(), deadline);
  book.expire(*book.next_deadline());
  const SharedRehearsal known = answer.get();
  EXPECT_TRUE(!known || !known->is_complete);
  EXPECT_FALSE(book.next_deadline());
}

TEST_F(RehearsalBooks, StoppingAnswersWhoWaits) {
  report_sweeps(6);
  RehearsalBookOptions options = quick();
  options.plan.rounds = 10'000;
  options.processor_fraction = 1e-6;
  RehearsalBook book(parts(), options);
  std::future<SharedRehearsal> answer = wait(book, panda_);
  book.stop();
  answer.get();
  EXPECT_FALSE(wait(book, ur10e_).get()) << "nothing is begun any more";
}

TEST_F(RehearsalBooks, WithoutProcessorTimeNothingIsRehearsed) {
  report_sweeps(6);
  RehearsalBookOptions options = quick();
  options.processor_fraction = 0;
  RehearsalBook book(parts(), options);
  EXPECT_FALSE(wait(book, panda_).get());
  EXPECT_FALSE(book.ask(rehearsal_key(panda_)));
  EXPECT_EQ(book.totals().queued, 0U);
}

TEST_F(RehearsalBooks, AReplyCarriesIt) {
  report_sweeps(6);
  RehearsalBook book(parts(), quick());
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
    with_rehearsal(book, request, clock_.now(),
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
