#include "server/fitting/distribution_key.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <set>
#include <vector>

namespace kinship::fitting::distribution_key_test {
namespace {

FetchRequest request() {
  FetchRequest request;
  request.task = "shelf";
  request.robot.bytes[3] = 7;
  request.T_task_base = Eigen::Isometry3d::Identity();
  return request;
}

TEST(DistributionKey, EveryPartOfTheKeyMakesAnotherId) {
  const DistributionKey key = make_key(request()).value_or_throw();
  const std::vector<std::function<void(DistributionKey&)>> changes = {
      [](DistributionKey&) {},
      [](DistributionKey& k) { k.task = "shelf2"; },
      [](DistributionKey& k) { k.robot.bytes[0] = 1; },
      [](DistributionKey& k) { k.T_task_base.reset(); },
      [](DistributionKey& k) { k.T_task_base->translation().z() = 0.001; },
      [](DistributionKey& k) { k.profile.transfer.pose_spacing = 0.2; },
      [](DistributionKey& k) { k.profile.transfer.max_poses_per_path = 3; },
      [](DistributionKey& k) { k.profile.transfer.max_solutions = 3; },
      [](DistributionKey& k) { k.profile.transfer.min_distance = 0.3; },
      [](DistributionKey& k) { k.profile.transfer.dropped_end_share = 0; },
      [](DistributionKey& k) { k.profile.transfer.tracks = 0; },
      [](DistributionKey& k) { k.profile.transfer.least_coverage = 0.5; },
      [](DistributionKey& k) { k.profile.transfer.track_candidates = 4; },
      [](DistributionKey& k) { k.profile.transfer.shape_noise = 0; },
      [](DistributionKey& k) { k.profile.transfer.shape_steps = 0; },
      [](DistributionKey& k) { k.profile.transfer.avoid_self_collision = false; },
      [](DistributionKey& k) { k.profile.transfer.avoid_recorded_scene = false; },
      [](DistributionKey& k) { k.profile.transfer.take_over = false; },
      [](DistributionKey& k) { k.geometry_revision = 1; },
      [](DistributionKey& k) { k.geometry_revision = 2; },
      [](DistributionKey& k) { k.profile.thin_share = 0.6; },
      [](DistributionKey& k) { k.profile.density.components = 7; },
      [](DistributionKey& k) { k.profile.density.covariance_floor = 1e-3; },
      [](DistributionKey& k) { k.profile.density.covariance_floor_m2 = 1e-3; },
      [](DistributionKey& k) { k.profile.density.equal_path_weights = false; },
      [](DistributionKey& k) { k.profile.density.weighting = Weighting::Paths; },
      [](DistributionKey& k) { k.profile.density.warm_refits = false; },
      [](DistributionKey& k) { k.profile.density.estimator = Estimator::Kernels; },
      [](DistributionKey& k) { k.profile.recommended_share = 0.5; },
      [](DistributionKey& k) { k.sources = {Digest{}}; },
      [](DistributionKey& k) { k.sources = {k.robot}; },
      [](DistributionKey& k) { k.since_ms = 1; },
      [](DistributionKey& k) { k.profile.seed = 9; }};
  std::set<Digest> ids;
  for (const auto& change : changes) {
    DistributionKey changed = key;
    change(changed);
    ids.insert(identify(changed));
  }
  EXPECT_EQ(ids.size(), changes.size());
}

TEST(DistributionKey, TheNameOfAProfileIsNotPartOfIt) {
  DistributionKey key = make_key(request()).value_or_throw();
  const Digest id = identify(key);
  key.profile.name = "mine";
  EXPECT_EQ(identify(key), id);
}

TEST(DistributionKey, PlacementsWithinTheGridAreOne) {
  FetchRequest near = request();
  near.T_task_base->translation().x() = 0.0003;
  near.T_task_base->rotate(Eigen::AngleAxisd(0.0003, Eigen::Vector3d::UnitZ()));
  EXPECT_EQ(identify(make_key(near).value_or_throw()),
            identify(make_key(request()).value_or_throw()));
}

TEST(DistributionKey, WantsAndDeadlinesAreNotPartOfIt) {
  FetchRequest other = request();
  other.minimum_generation = 5;
  other.deadline = std::chrono::seconds(3);
  EXPECT_EQ(identify(make_key(other).value_or_throw()),
            identify(make_key(request()).value_or_throw()));
}

TEST(DistributionKey, TheWeightingIsTheRequestsOrElseTheProfiles) {
  FetchRequest asked = request();
  EXPECT_EQ(make_key(asked).value_or_throw().profile.density.weighting, Weighting::Sources);
  const Digest id = identify(make_key(asked).value_or_throw());
  asked.selection.weighting = Weighting::Sources;
  EXPECT_EQ(identify(make_key(asked).value_or_throw()), id);
  asked.selection.weighting = Weighting::Paths;
  EXPECT_EQ(make_key(asked).value_or_throw().profile.density.weighting, Weighting::Paths);
  asked.selection.weighting.reset();
  asked.profile = "paper";
  EXPECT_EQ(make_key(asked).value_or_throw().profile.density.weighting, Weighting::Paths);
}

TEST(DistributionKey, TheOrderOfSelectedSourcesIsNotPartOfIt) {
  Digest a, b;
  a.bytes[0] = 1;
  b.bytes[0] = 2;
  FetchRequest one = request(), other = request();
  one.selection.sources = {a, b};
  other.selection.sources = {b, a, b};
  EXPECT_EQ(identify(make_key(one).value_or_throw()), identify(make_key(other).value_or_throw()));
}

TEST(DistributionKey, RequestsOfAnUnknownProfileAreRefused) {
  FetchRequest bad = request();
  bad.profile = "best";
  EXPECT_EQ(make_key(bad).error().message,
            "profile 'best': it does not begin with default or paper");
}

TEST(DistributionKey, GeometryCountsWhereAFilterIsWanted) {
  EXPECT_EQ(make_key(request(), 3)->geometry_revision, 3U);
  FetchRequest unfiltered = request();
  unfiltered.profile = "default,avoid_self_collision=0,avoid_recorded_scene=0";
  EXPECT_EQ(make_key(unfiltered, 3)->geometry_revision, 0U);
  unfiltered.profile = "default,avoid_self_collision=0";
  EXPECT_EQ(make_key(unfiltered, 3)->geometry_revision, 3U);
}

}  // namespace
}  // namespace kinship::fitting::distribution_key_test
