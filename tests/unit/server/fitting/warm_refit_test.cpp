// Refits: what is transferred again, and when the mixture before is the start.

#include "server/fitting/warm_refit.hpp"

#include <gtest/gtest.h>

#include "proto/mixture/log_density.hpp"
#include "tests/unit/server/fitting/fit_fixture.hpp"

namespace kinship::fitting::warm_refit_test {
namespace {

/// Fits of the pupil, one after the other, each stored as the next revision.
class WarmRefit : public FitDistribution {
 protected:
  WarmRefit() { key_.profile.density.components = 6; }

  Distribution next() {
    FitOutcome outcome = fit(key_);
    outcome.distribution->revision = outcome.warm_state->revision = ++revision_;
    if (outcome.distribution->fit && outcome.distribution->fit->from_revision == 0)
      outcome.warm_state->full.revision = revision_;
    context_.before = outcome.warm_state;
    return *outcome.distribution;
  }
  /// Without anything of an earlier fit.
  Distribution cold() {
    FitContext context = context_;
    context.before = nullptr;
    return fit_distribution(key_, context, {}).distribution.value();
  }
  static FitOrigin origin(std::uint64_t paths, std::uint64_t transferred,
                          const std::string& reason) {
    return {0, 0, paths, paths, transferred, reason};
  }
  /// How well a mixture describes paths of the teacher that no fit saw.
  double score_of_others(const Mixture& mixture) {
    const test::TemporaryDirectory directory;
    const auto store = store::open_sqlite_store(directory / "others.db");
    runtime::RobotRegistry registry(*store);
    for (const RobotDescription& robot : {fleet::teacher(), fleet::pupil()})
      registry.register_robot(robot, 1);
    std::promise<void> done;
    store->commit_reports(fleet::solved(teacher_, "shelf", 20, 9000),
                          [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
    const runtime::RobotRegistry::RobotPointer target =
        registry.find(pupil_.digest).value_or_throw();
    SourceTransfer transfer(*store, registry, key_, *target);
    transfer_sources(transfer, key_, store->experience("shelf"), 20, {});
    return mixture::log_density(mixture, transfer.pool().configurations()).mean();
  }

  DistributionKey key_ = quick_key_of(pupil_);
  std::uint64_t revision_ = 0;
};

void expect_same(const Distribution& a, const Distribution& b) {
  ASSERT_TRUE(a.mixture && b.mixture);
  EXPECT_EQ(a.mixture->weights(), b.mixture->weights());
  EXPECT_EQ(a.mixture->means(), b.mixture->means());
  EXPECT_EQ(a.mixture->covariances(), b.mixture->covariances());
}

TEST_F(WarmRefit, OnlyNewPathsAreTransferredAndTheMixtureIsTheStart) {
  report(fleet::solved(teacher_, "shelf", 20, 1));
  EXPECT_EQ(next().fit, origin(20, 20, "no earlier one in memory"));
  report(fleet::solved(teacher_, "shelf", 2, 100));
  const Distribution warm = next();
  EXPECT_EQ(warm.fit, (FitOrigin{1, 1, 22, 2, 2, ""}));
  report(fleet::solved(teacher_, "shelf", 3, 200));
  EXPECT_EQ(next().fit, (FitOrigin{2, 1, 25, 3, 3, ""}));
  EXPECT_EQ(next().fit, (FitOrigin{3, 1, 25, 0, 0, ""}));
}

TEST_F(WarmRefit, ProvenanceIsThatOfAFitThatTransferredEverything) {
  report(fleet::solved(teacher_, "shelf", 20, 1));
  report(fleet::solved(pupil_, "shelf", 6, 1));
  next();
  report(fleet::solved(teacher_, "shelf", 2, 100));
  const Distribution warm = next(), all = cold();
  EXPECT_EQ(warm.fit->transferred, 2U);
  EXPECT_EQ(all.fit->transferred, 28U);
  EXPECT_EQ(warm.configurations, all.configurations);
  ASSERT_EQ(warm.sources.size(), all.sources.size());
  for (std::size_t i = 0; i < all.sources.size(); ++i) {
    EXPECT_EQ(warm.sources[i].poses, all.sources[i].poses);
    EXPECT_EQ(warm.sources[i].poses_solved, all.sources[i].poses_solved);
    EXPECT_EQ(warm.sources[i].configurations, all.sources[i].configurations);
    EXPECT_EQ(warm.sources[i].paths_used, all.sources[i].paths_used);
    EXPECT_EQ(warm.sources[i].mass, all.sources[i].mass);
  }
}

TEST_F(WarmRefit, DescribesOtherPathsAboutAsWellAsAColdFit) {
  report(fleet::solved(teacher_, "shelf", 60, 1));
  next();
  for (const std::uint64_t seed : {1000U, 2000U, 3000U}) {
    report(fleet::solved(teacher_, "shelf", 6, seed));
    const Distribution warm = next();
    ASSERT_GT(warm.fit->from_revision, 0U);
    const double cold_score = score_of_others(*cold().mixture);
    EXPECT_GT(score_of_others(*warm.mixture), cold_score - 0.1) << seed;
  }
}

TEST_F(WarmRefit, TwiceThePathsAreFittedFully) {
  report(fleet::solved(teacher_, "shelf", 10, 1));
  next();
  report(fleet::solved(teacher_, "shelf", 9, 100));
  EXPECT_EQ(next().fit->from_revision, 1U);
  report(fleet::solved(teacher_, "shelf", 1, 200));
  const Distribution full = next();
  EXPECT_EQ(full.fit, origin(20, 1, "paths have doubled since revision 1"));
  expect_same(full, cold());
  report(fleet::solved(teacher_, "shelf", 19, 300));
  EXPECT_EQ(next().fit->full_revision, 3U);
}

TEST_F(WarmRefit, NothingOfARetiredPathSurvives) {
  const std::vector<Attempt> attempts = fleet::solved(teacher_, "shelf", 20, 1);
  report(attempts);
  const Distribution before = next();
  store_->retire_path(attempts[3].report_uuid).value_or_throw();
  const Distribution after = next();
  EXPECT_EQ(after.fit, origin(19, 0, "1 paths of revision 1 left out or changed"));
  EXPECT_LT(after.configurations, before.configurations);
  expect_same(after, cold());
  EXPECT_EQ(context_.before->paths.size(), 19U);
  // Reported anew, it is another path: nothing old stands for it.
  Attempt again = attempts[3];
  again.report_uuid = Uuid::random();
  report({again});
  EXPECT_EQ(next().fit, (FitOrigin{2, 2, 20, 1, 1, ""}));
}

TEST_F(WarmRefit, AnotherSourceOrOtherMassesAreFittedFully) {
  key_.profile.density.weighting = Weighting::Paths;
  report(fleet::solved(teacher_, "shelf", 20, 1));
  next();
  report(fleet::solved(pupil_, "shelf", 4, 1));
  EXPECT_EQ(next().fit, origin(24, 4, "other source robots than in revision 1"));
  report(fleet::solved(pupil_, "shelf", 1, 50));
  EXPECT_EQ(next().fit->from_revision, 2U);
  report(fleet::solved(pupil_, "shelf", 8, 100));  // 4 of 24 to 13 of 33, 0.17 to 0.39
  const FitOrigin jump = next().fit.value();
  EXPECT_EQ(jump.from_revision, 0U);
  EXPECT_NE(jump.reason.find("the mass of a source moved by 0.2"), std::string::npos)
      << jump.reason;
}

TEST_F(WarmRefit, AProfileMayAskForFullFitsOnly) {
  key_.profile.density.warm_refits = false;
  report(fleet::solved(teacher_, "shelf", 20, 1));
  next();
  report(fleet::solved(teacher_, "shelf", 2, 100));
  const Distribution full = next();
  EXPECT_EQ(full.fit, origin(22, 2, "the profile asks for it"));
  expect_same(full, cold());
  EXPECT_FALSE(find_profile("paper")->density.warm_refits);
}

TEST_F(WarmRefit, SameHistorySameBytesOnAnyThreads) {
  report(fleet::solved(teacher_, "shelf", 40, 1));
  const Distribution first = next();
  const FitMemory::State before = context_.before;
  report(fleet::solved(teacher_, "shelf", 4, 100));
  const Distribution one = next();
  context_.before = before;
  context_.fit_threads = 3;
  const Distribution three = next();
  ASSERT_EQ(one.fit->from_revision, first.revision);
  ASSERT_EQ(three.fit->from_revision, first.revision);
  expect_same(one, three);
}

TEST_F(WarmRefit, ComponentsStayAsChosenUntilAFullFit) {
  key_.profile.density.components = 0;
  report(fleet::solved(teacher_, "shelf", 8, 1));
  EXPECT_TRUE(next().component_scores.empty());
  report(fleet::solved(teacher_, "shelf", 2, 50));
  const Distribution chosen = next();
  EXPECT_EQ(chosen.fit, origin(10, 2, "paths suffice to choose components"));
  ASSERT_FALSE(chosen.component_scores.empty());
  report(fleet::solved(teacher_, "shelf", 5, 100));
  const Distribution warm = next();
  EXPECT_EQ(warm.fit->from_revision, 2U);
  EXPECT_EQ(warm.component_scores, chosen.component_scores);
  EXPECT_EQ(warm.held_out_score, chosen.held_out_score);
  EXPECT_EQ(warm.mixture->size(), chosen.mixture->size());
}

TEST_F(WarmRefit, APathWhoseSceneCameBackIsTransferredAgain) {
  report(fleet::solved(teacher_, "shelf", 20, 1));
  next();
  // As if the first path had been transferred without the scene that it should have kept free of.
  WarmState other = *context_.before;
  KnownPath& path = other.paths.begin()->second;
  auto unfiltered = std::make_shared<transfer::TransferredPath>(*path.path);
  path.lacks_scene = true;
  context_.before = std::make_shared<const WarmState>(other);
  EXPECT_EQ(next().fit, (FitOrigin{1, 1, 20, 0, 1, ""}));  // nothing came of it
  unfiltered->configurations.array() += 0.01;
  path.path = unfiltered;
  context_.before = std::make_shared<const WarmState>(other);
  const Distribution full = next();
  EXPECT_EQ(full.fit, origin(20, 1, "1 paths of revision 1 left out or changed"));
  expect_same(full, cold());
}

TEST_F(WarmRefit, AfterAFailureTheNextFitIsAFullOne) {
  key_.robot = dwarf_.digest;  // reaches nothing
  report(fleet::solved(teacher_, "shelf", 3, 1));
  EXPECT_FALSE(next().fit);
  report(fleet::solved(dwarf_, "shelf", 6, 1));
  EXPECT_EQ(next().fit, origin(9, 6, "no earlier one in memory"));
}

}  // namespace
}  // namespace kinship::fitting::warm_refit_test
