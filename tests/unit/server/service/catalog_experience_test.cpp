#include <gtest/gtest.h>

#include "server/catalog/catalog.hpp"
#include "server/catalog/freshness.hpp"
#include "tests/unit/server/service/catalog_fixture.hpp"

/// Of which experience a distribution may be when it is served: selected, not retired, not evicted.
namespace kinship::service::catalog_experience_test {
namespace {

class CatalogExperienceTest : public CatalogTest {};

TEST_F(CatalogExperienceTest, ASelectedSourceThatIsUnknownIsRefusedByName) {
  teach(6);
  FetchRequest request = request_for(pupil_);
  Digest unknown = teacher_.digest;
  unknown.bytes[0] ^= 1U;
  request.selection.sources = {teacher_.digest, unknown};
  const FetchReply reply = fetch(request);
  EXPECT_EQ(reply.status, FetchStatus::Refused);
  EXPECT_EQ(reply.message, "selected source: robot " + unknown.short_hex() +
                               " is not known here; register it first");
  EXPECT_EQ(gate_.calls(), 0);
}

TEST_F(CatalogExperienceTest, WithoutExperienceOfTheSelectionThereIsNothing) {
  teach(6);
  FetchRequest request = request_for(pupil_);
  request.selection.sources = {dwarf_.digest};
  EXPECT_EQ(fetch(request).message, "no paths of task 'shelf' of the 1 selected robots");
  request.selection = {.sources = {}, .weighting = {}, .since_ms = 9'000'000'000'000};
  const FetchReply reply = fetch(request);
  EXPECT_EQ(reply.status, FetchStatus::NoExperience);
  EXPECT_EQ(reply.message, "no paths of task 'shelf' received since 9000000000000 ms");
}

TEST_F(CatalogExperienceTest, GrowthOfARobotThatIsNotSelectedIsNone) {
  teach(6);
  FetchRequest request = request_for(pupil_);
  request.selection.sources = {teacher_.digest};
  fetch(request);
  report(fleet::solved(pupil_, "shelf", 9, 300));
  advance(catalog::kRefitInterval);
  EXPECT_EQ(fetch(request).distribution->revision, 1U);
  wait_for_short_tasks();
  EXPECT_EQ(service_->status().queued_fits, 0U);
  EXPECT_EQ(gate_.calls(), 1);
  // Its own generation is nothing that such a distribution could know.
  EXPECT_EQ(fetch(with_generation(request, 1)).status, FetchStatus::Ready);
}

TEST_F(CatalogExperienceTest, RetiredExperienceIsNotServedAnyMore) {
  const std::vector<Attempt> paths = fleet::solved(teacher_, "shelf", 6, 1);
  report(paths);
  fetch(request_for(pupil_));
  administer(fleet::question(AdminVerb::RetirePath, paths[2].report_uuid.text()));
  EXPECT_EQ(fetch(at_once(request_for(pupil_))).status, FetchStatus::Pending);
  const FetchReply reply = fetch(request_for(pupil_));
  ASSERT_EQ(reply.status, FetchStatus::Ready) << reply.message;
  EXPECT_EQ(reply.distribution->revision, 2U);
  EXPECT_EQ(reply.distribution->sources[0].paths, 5U);
}

TEST_F(CatalogExperienceTest, AFitOfExperienceThatIsRetiredMeanwhileIsDoneAgain) {
  const std::vector<Attempt> paths = fleet::solved(teacher_, "shelf", 6, 1);
  report(paths);
  gate_.close();
  std::future<FetchReply> reply = begin_fetch(request_for(pupil_), "one");
  gate_.wait_for_calls(1);
  std::atomic<int> fits = 0;
  gate_.set_trouble({});
  gate_.set_afterwards([&] {  // this fit has read what it wants; then a path is retired
    if (fits++ == 0)
      administer(fleet::question(AdminVerb::RetirePath, paths[2].report_uuid.text()));
  });
  gate_.open();
  const FetchReply got = reply.get();
  ASSERT_EQ(got.status, FetchStatus::Ready) << got.message;
  EXPECT_EQ(got.distribution->sources[0].paths, 5U);
  EXPECT_EQ(got.distribution->revision, 1U) << "the other one was not kept";
  EXPECT_EQ(gate_.calls(), 2);
}

TEST_F(CatalogExperienceTest, ATaskWhoseExperienceIsAllGoneHasNone) {
  teach(6);
  fetch(request_for(pupil_));
  administer(fleet::question(AdminVerb::ResetTask, "shelf"));
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::NoExperience);
  teach(6);  // the same content once more
  EXPECT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
}

TEST_F(CatalogExperienceTest, DistributionsWithDatesThatNobodyAsksForAnyMoreGo) {
  teach(6);
  const auto count = [this] { return service_->status().distributions; };
  ASSERT_EQ(fetch(request_for(pupil_)).status, FetchStatus::Ready);
  FetchRequest dated = request_for(pupil_);
  constexpr std::int64_t kDay_ms = 86'400'000;
  for (int day = 0; day < 20; ++day) {
    dated.selection.since_ms = 1'600'000'000'000 + day * kDay_ms;
    ASSERT_EQ(fetch(dated).status, FetchStatus::Ready);
    advance(std::chrono::hours(24));
  }
  EXPECT_EQ(count(), 1U + 8U) << "the one without a date, and those of a week";
  FetchRequest undated = request_for(pupil_);
  EXPECT_EQ(fetch(undated).distribution->revision, 1U);
}

TEST_F(CatalogExperienceTest, AFitDuringWhichItIsEvictedAnswersAndIsKept) {
  teach(6);
  const std::string id = fetch(request_for(teacher_)).distribution->id.hex();
  teach(1, 100);
  gate_.close();
  std::future<FetchReply> reply = begin_fetch(with_generation(request_for(teacher_), 2), "one");
  gate_.wait_for_calls(2);
  administer(fleet::question(AdminVerb::EvictDistribution, id));
  EXPECT_EQ(fetch(at_once(request_for(teacher_))).status, FetchStatus::Pending)
      << "the old one is gone";
  gate_.open();
  EXPECT_EQ(reply.get().distribution->revision, 2U);
  EXPECT_EQ(fetch(at_once(request_for(teacher_))).distribution->revision, 2U);
  EXPECT_EQ(gate_.calls(), 2);
}

}  // namespace
}  // namespace kinship::service::catalog_experience_test
