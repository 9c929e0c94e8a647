// The experience of a task in replies to fetches, beside whatever becomes of the distribution.

#include <algorithm>

#include "server/catalog/experience_reply.hpp"
#include "tests/support/random_values.hpp"
#include "tests/unit/server/service/catalog_fixture.hpp"

namespace kinship::service {
namespace {

class ExperienceFetch : public CatalogTest {
 protected:
  static FetchRequest with_experience(FetchRequest request,
                                      std::uint32_t bytes = kDefaultExperienceBytes,
                                      std::uint64_t known = 0) {
    request.experience_bytes = bytes;
    request.known_experience = known;
    return request;
  }
  FetchReply ask(std::uint64_t known = 0) {
    return fetch(with_experience(at_once(request_for(pupil_)), kDefaultExperienceBytes, known));
  }
  static std::vector<Uuid> uuids_of(const FetchReply& reply) {
    std::vector<Uuid> uuids;
    for (const PosePath& path : reply.experience.value().paths)
      uuids.push_back(path.path);
    std::sort(uuids.begin(), uuids.end());
    return uuids;
  }
};

TEST_F(ExperienceFetch, ComesWhileTheDistributionIsPending) {
  gate_.close();
  teach(3);
  const FetchReply reply = ask();
  EXPECT_EQ(reply.status, FetchStatus::Pending);
  ASSERT_TRUE(reply.experience);
  EXPECT_EQ(reply.experience->paths_known, 3U);
  EXPECT_EQ(reply.experience->paths.size(), 3U);
  EXPECT_EQ(reply.experience->paths[0].source, teacher_.digest);
  EXPECT_FALSE(fetch(at_once(request_for(pupil_))).experience) << "it was not asked for";
}

TEST_F(ExperienceFetch, ComesWithAMixtureAFailureAndToARobotThatNobodyKnows) {
  teach(3);
  const FetchReply ready = fetch(with_experience(request_for(pupil_)));
  EXPECT_EQ(ready.status, FetchStatus::Ready);
  EXPECT_TRUE(ready.distribution);
  const FetchReply failed = fetch(with_experience(request_for(dwarf_)));
  EXPECT_EQ(failed.status, FetchStatus::Failed);
  FetchRequest request = with_experience(request_for(pupil_));
  request.robot = Digest{};
  const FetchReply unknown = fetch(request);
  EXPECT_EQ(unknown.status, FetchStatus::UnknownRobot);
  EXPECT_EQ(uuids_of(ready), uuids_of(failed));
  EXPECT_EQ(uuids_of(ready), uuids_of(unknown));
  EXPECT_EQ(ready.experience->revision, unknown.experience->revision);
}

TEST_F(ExperienceFetch, IsThatOfTheSelection) {
  teach(3);
  report(fleet::solved(pupil_, "shelf", 2, 50));
  FetchRequest request = with_experience(at_once(request_for(pupil_)));
  EXPECT_EQ(fetch(request).experience->paths_known, 5U);
  request.selection.sources = {pupil_.digest};
  const FetchReply of_pupil = fetch(request);
  EXPECT_EQ(of_pupil.experience->paths_known, 2U);
  EXPECT_EQ(of_pupil.experience->paths.at(0).source, pupil_.digest);
  request.selection.sources = {dwarf_.digest};
  const FetchReply of_dwarf = fetch(request);
  EXPECT_EQ(of_dwarf.status, FetchStatus::NoExperience);
  EXPECT_FALSE(of_dwarf.experience);
}

TEST_F(ExperienceFetch, IsNotSentAgainUntilItChanges) {
  teach(3);
  const std::uint64_t revision = ask().experience->revision;
  EXPECT_FALSE(ask(revision).experience);
  EXPECT_EQ(ask(revision + 1).experience->revision, revision);
  report({fleet::unsolved(teacher_.digest, "shelf")});
  report({fleet::solved(teacher_, "other", 77)});
  EXPECT_FALSE(ask(revision).experience);
  teach(1, 30);
  const FetchReply newer = ask(revision);
  EXPECT_NE(newer.experience->revision, revision);
  EXPECT_EQ(newer.experience->paths.size(), 4U);
}

TEST_F(ExperienceFetch, OfTheSameStoreHasTheSameRevisionAfterAStart) {
  teach(40);
  const FetchReply before = ask();
  start();
  const FetchReply after = ask();
  EXPECT_EQ(after.experience->revision, before.experience->revision);
  EXPECT_EQ(uuids_of(after), uuids_of(before));
}

TEST_F(ExperienceFetch, LacksWhatWasRetired) {
  teach(3);
  const FetchReply before = ask();
  const Uuid gone = before.experience->paths[0].path;
  administer(fleet::question(AdminVerb::RetirePath, gone.text()));
  const FetchReply after = ask(before.experience->revision);
  const std::vector<Uuid> left = uuids_of(after);
  EXPECT_EQ(left.size(), 2U);
  EXPECT_EQ(std::count(left.begin(), left.end(), gone), 0);
  administer(fleet::question(AdminVerb::ResetTask, "shelf"));
  const FetchReply nothing = ask(after.experience->revision);
  ASSERT_TRUE(nothing.experience) << "who holds some is told";
  EXPECT_EQ(nothing.experience->paths.size(), 0U);
  EXPECT_FALSE(ask(nothing.experience->revision).experience);
  EXPECT_FALSE(ask().experience);
}

TEST_F(ExperienceFetch, KeepsWithinItsBytes) {
  teach(30);
  const std::size_t path = experience_bytes(kExperiencePoses);
  const auto size_of = [&](std::size_t bytes) {
    const FetchReply reply =
        fetch(with_experience(at_once(request_for(pupil_)), static_cast<std::uint32_t>(bytes)));
    EXPECT_EQ(reply.experience->paths_known, 30U);
    return reply.experience->paths.size();
  };
  EXPECT_EQ(size_of(7 * path), 7U);
  EXPECT_EQ(size_of(8 * path - 1), 7U);
  EXPECT_EQ(size_of(kMaxExperienceBytes), 30U);
}

TEST_F(ExperienceFetch, LeavesRoomForTheRestOfItsMessage) {
  teach(2);
  FetchReply reply = fetch(request_for(pupil_));
  EXPECT_GE(catalog::room_for_experience(reply), kMaxExperienceBytes);
  constexpr Eigen::Index kComponents = 1024, kDof = 7;
  reply.distribution->mixture =
      Mixture(Eigen::VectorXd::Constant(kComponents, 1.0 / kComponents),
              Eigen::MatrixXd::Zero(kDof, kComponents),
              std::vector<Eigen::MatrixXd>(kComponents, Eigen::MatrixXd::Identity(kDof, kDof)));
  constexpr std::size_t kMixture = 1024UL * 8 * (1 + 7 + 28);
  EXPECT_LE(catalog::room_for_experience(reply), kMaxSampleBytes - kMixture);
  EXPECT_GT(catalog::room_for_experience(reply), kMaxSampleBytes - kMixture - 20'000);
  const std::size_t without = catalog::room_for_experience(reply);
  reply.rehearsal.emplace();
  reply.rehearsal->costs.resize(kMaxGuideCosts);
  reply.rehearsal->message = std::string(kMaxMessageBytes, 'w');
  const std::size_t taken = without - catalog::room_for_experience(reply);
  EXPECT_GE(taken, kMaxMessageBytes + kMaxGuideCosts * sizeof(GuideCost));
  EXPECT_LT(taken, 3'500U);
  const std::size_t beside = catalog::room_for_experience(reply);
  reply.recall = test::RandomValues(32).recall_library(7);
  EXPECT_EQ(beside - catalog::room_for_experience(reply), recall_bytes(*reply.recall));
}

TEST_F(ExperienceFetch, IsGivenToManyWhoAskWhileReportsComeIn) {
  teach(20);
  std::vector<std::future<FetchReply>> replies;
  for (int i = 0; i < 20; ++i) {
    replies.push_back(
        begin_fetch(with_experience(at_once(request_for(pupil_))), "fetcher " + std::to_string(i)));
    teach(1, 100 + static_cast<std::uint64_t>(i));
  }
  for (std::size_t i = 0; i < replies.size(); ++i)
    EXPECT_GE(replies[i].get().experience->paths_known, 20 + i) << "what was reported before";
}

TEST_F(ExperienceFetch, IsOwedToNobodyAfterShutdown) {
  teach(20);
  std::vector<std::future<FetchReply>> replies;
  for (int i = 0; i < 5; ++i)
    replies.push_back(
        begin_fetch(with_experience(at_once(request_for(pupil_))), "fetcher " + std::to_string(i)));
  service_->shutdown();
  for (std::future<FetchReply>& reply : replies)
    EXPECT_EQ(reply.wait_for(std::chrono::seconds(0)), std::future_status::ready);
}

}  // namespace
}  // namespace kinship::service
