// What a service does when it is told what another server of its store did, and how two servers
// share the fits. The other one writes to the store behind the service's back.

#include <gtest/gtest.h>

#include "tests/support/store_values.hpp"
#include "tests/unit/server/service/catalog_fixture.hpp"

namespace kinship::service::changes_elsewhere_test {
namespace {

class ChangesElsewhere : public CatalogTest {
 protected:
  ChangesElsewhere() {
    may_trouble_store_ = true;
    start();
  }

  /// Reported to the other server.
  void teach_elsewhere(int paths, std::uint64_t first_seed) {
    test::report(*real_store_, fleet::solved(teacher_, "shelf", paths, first_seed));
  }
  void reset_elsewhere() { ASSERT_TRUE(real_store_->reset_task("shelf", {}, nullptr)); }
  /// As the store would tell it now.
  store::StoreChanges changed_experience() const {
    store::StoreChanges changes;
    for (const store::ExperienceSummary& now : real_store_->experience("shelf"))
      changes.experience.push_back({"shelf", now});
    return changes;
  }
  std::uint64_t fetches_from_memory() const { return service_->status().fetches_from_memory; }
};

TEST_F(ChangesElsewhere, NothingIsServedForARobotThatWasRemoved) {
  teach(6);
  ASSERT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
  ASSERT_TRUE(real_store_->remove_robot(teacher_.digest, {}, nullptr));
  ASSERT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready) << "of memory";
  service_->fetches().take_changes(
      {.cursor = {}, .experience = {}, .robots = {teacher_.digest}, .evicted = {}});
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::UnknownRobot);
}

TEST_F(ChangesElsewhere, OfATaskThatWasRenamedNothingIsServedUnderItsFormerName) {
  teach(6);
  ASSERT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
  ASSERT_TRUE(real_store_->rename_task("shelf", "rack", nullptr));
  ASSERT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready) << "of memory";
  store::StoreChanges changes;
  changes.former_tasks = {"shelf"};
  service_->fetches().take_changes(changes);
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::NoExperience);
}

TEST_F(ChangesElsewhere, ARobotThatTheStoreHasLostIsRegisteredAnewByWhoReportsForIt) {
  troubled_->has_others = true;
  ASSERT_EQ(register_robot(fleet::teacher()).status, RegisterStatus::Known);
  ASSERT_TRUE(real_store_->remove_robot(teacher_.digest, {}, nullptr));  // nobody is told of it
  ASSERT_EQ(register_robot(fleet::teacher()).status, RegisterStatus::Known) << "of memory";
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 1, 1);
  EXPECT_EQ(report(attempts).receipts.at(0).status, ReceiptStatus::UnknownRobot);
  EXPECT_EQ(register_robot(fleet::teacher()).status, RegisterStatus::Registered);
  EXPECT_EQ(report(attempts).receipts.at(0).status, ReceiptStatus::Stored);
}

TEST_F(ChangesElsewhere, WhoWaitsForAGenerationGetsItAlsoIfAnotherServerWasToldOfIt) {
  teach(6);
  fetch(request_for(teacher_));
  std::future<FetchReply> reply = begin_fetch(with_generation(request_for(teacher_), 2), "early");
  wait_for_short_tasks();
  ASSERT_NE(reply.wait_for(std::chrono::seconds(0)), std::future_status::ready);
  teach_elsewhere(1, 100);
  service_->fetches().take_changes(changed_experience());
  EXPECT_EQ(reply.get().distribution.value().sources[0].generation, 2U);
}

TEST_F(ChangesElsewhere, WhatIsInMemoryStaysWhenTheSameIsToldAgainOrPathsCame) {
  teach(6);
  reset_elsewhere();
  service_->fetches().take_changes(changed_experience());
  teach(6, 100);
  ASSERT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
  const std::uint64_t before = fetches_from_memory();
  service_->fetches().take_changes(changed_experience());
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
  teach_elsewhere(1, 200);
  service_->fetches().take_changes(changed_experience());
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::Ready);
  EXPECT_EQ(fetches_from_memory(), before + 2);
}

TEST_F(ChangesElsewhere, PathsToRecallStayWhenOthersComeWhateverWasRetiredBeforeTheStart) {
  adjust_ = [this](ServiceOptions&) { troubled_->has_others = true; };
  teach(6);
  reset_elsewhere();
  store::StoredRehearsal made = test::make_rehearsal(teacher_.digest, "shelf", 1);
  const rehearsal::RehearsalKey key{fitting::make_key(request_for(teacher_)).value()};
  made.id = fitting::identify(key.distribution);
  made.retired = real_store_->experience("shelf").at(0).retired_generation;
  real_store_->put_rehearsal(made, {});
  start();
  const rehearsal::RehearsalScheduler& rehearsals = service_->fetches().rehearsals();
  ASSERT_TRUE(rehearsals.library(key));
  teach_elsewhere(1, 100);
  service_->fetches().take_changes(changed_experience());
  EXPECT_TRUE(rehearsals.library(key));
  reset_elsewhere();
  service_->fetches().take_changes(changed_experience());
  EXPECT_FALSE(rehearsals.library(key));
}

TEST_F(ChangesElsewhere, WhatAnErrorOfTheStoreCutShortIsTakenWhenItIsToldAgain) {
  teach(6);
  const Digest id = fetch(request_for(teacher_)).distribution.value().id;
  reset_elsewhere();
  store::StoreChanges changes = changed_experience();
  changes.robots = {teacher_.digest};
  changes.evicted = {id};
  troubled_->on_robot_read = [] {
    throw Failure(ErrorCode::Storage, "the database does not answer");
  };
  EXPECT_THROW(service_->fetches().take_changes(changes), Failure);
  troubled_->on_robot_read = [] {};
  service_->fetches().take_changes(changes);
  EXPECT_EQ(fetch(request_for(teacher_)).status, FetchStatus::NoExperience);
}

TEST_F(ChangesElsewhere, TheServiceLooksForThemItself) {
  std::promise<void> taken;
  std::atomic<bool> is_evicted = false;
  Digest id;
  adjust_ = [&](ServiceOptions&) {
    troubled_->on_changes = [&](std::string_view cursor) -> std::optional<store::StoreChanges> {
      if (cursor == "evicted" && is_evicted.exchange(false))
        taken.set_value();  // who asks for what comes behind it has taken it
      if (!is_evicted)
        return store::StoreChanges{.cursor = "new", .experience = {}, .robots = {}, .evicted = {}};
      return store::StoreChanges{
          .cursor = "evicted", .experience = {}, .robots = {}, .evicted = {id}};
    };
  };
  start();
  teach(6);
  id = fetch(request_for(teacher_)).distribution.value().id;
  ASSERT_TRUE(real_store_->evict_distribution(id, nullptr));
  is_evicted = true;
  taken.get_future().get();
  EXPECT_EQ(fetch(request_for(teacher_)).distribution.value().revision, 2U);
  service_.reset();  // its watch looks at what is on the stack here
}

/// The store has another server, which makes what is asked for before this one may.
class FitsElsewhere : public ChangesElsewhere {
 protected:
  /// A distribution that is not there any more, as another server would make it.
  Distribution evicted() {
    teach(6);
    const Distribution made = fetch(request_for(teacher_)).distribution.value();
    EXPECT_TRUE(real_store_->evict_distribution(made.id, nullptr));
    service_->fetches().take_changes(
        {.cursor = {}, .experience = {}, .robots = {}, .evicted = {made.id}});
    return made;
  }
  void share_fits(std::function<void()> meanwhile = [] {}) {
    troubled_->on_fit_right = [meanwhile = std::move(meanwhile)] {
      meanwhile();
      return store::FitRight{.fence = 1};
    };
  }
};

TEST_F(FitsElsewhere, WhatAnotherServerMadeWhileThisOneWaitedIsNotMadeAgain) {
  const Distribution made = evicted();
  share_fits([&] { real_store_->put_distribution(made, {}); });
  const FetchReply reply = fetch(request_for(teacher_));
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->revision, 2U);
  EXPECT_EQ(gate_.calls(), 1);
  EXPECT_EQ(service_->status().fits, 1U);
}

TEST_F(FitsElsewhere, WhatWasMadeOfLessThanSomebodyWaitsForIsMadeAgain) {
  teach(6);
  fetch(request_for(teacher_));
  share_fits();
  teach(1, 100);
  const FetchReply reply = fetch(with_generation(request_for(teacher_), 2));
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->sources[0].generation, 2U);
}

TEST_F(FitsElsewhere, AFitThatLostItsRightIsBusyAndThenThatOfTheOtherServer) {
  const Distribution made = evicted();
  share_fits();
  troubled_->on_put = [&](const store::FitRight& right) {
    EXPECT_EQ(right.fence, 1U);
    real_store_->put_distribution(made, {});
    throw Failure(ErrorCode::Unavailable, "another server fits it");
  };
  const FetchReply busy = fetch(request_for(teacher_));
  EXPECT_EQ(busy.status, FetchStatus::Busy);
  EXPECT_GT(busy.retry_after.count(), 0);
  advance(busy.retry_after);
  const FetchReply reply = fetch(request_for(teacher_));
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->revision, 2U);
  EXPECT_EQ(gate_.calls(), 2);
  EXPECT_EQ(troubled_->given_back().size(), 2U) << "also of the one that failed";
}

}  // namespace
}  // namespace kinship::service::changes_elsewhere_test
