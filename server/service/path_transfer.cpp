#include "server/service/path_transfer.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"
#include "server/density/parallel.hpp"
#include "server/transfer/collision_filter.hpp"
#include "server/transfer/transfer.hpp"

namespace kinship::service {
namespace {

/// Pose of the source's base in the target's; exactly the identity if both stand at the same
/// place up to snapping, so that paths of the same arm are taken over.
Eigen::Isometry3d T_target_source(const std::optional<Eigen::Isometry3d>& T_task_target,
                                  const std::optional<Eigen::Isometry3d>& T_task_source) {
  const Eigen::Isometry3d identity = Eigen::Isometry3d::Identity();
  const Eigen::Isometry3d target = T_task_target.value_or(identity);
  const Eigen::Isometry3d source = T_task_source.value_or(identity);
  if (snapped(source).matrix() == target.matrix())
    return identity;
  return target.inverse(Eigen::Isometry) * source;
}

}  // namespace

PathTransfer::PathTransfer(const store::Store& store, const DistributionKey& key,
                           const Robot& target, const KnownPaths* known, int threads)
    : store_(store),
      key_(key),
      target_(target),
      known_(known),
      lanes_(static_cast<std::size_t>(std::max(threads, 1))) {}

PathTransfer::Lane& PathTransfer::lane(std::size_t index) {
  std::unique_ptr<Lane>& lane = lanes_[index];
  if (!lane) {
    lane = std::make_unique<Lane>(Lane{{}, SceneFilters(store_, key_, target_)});
    if (key_.profile.transfer.avoid_self_collision)
      lane->filters.self = transfer::collision_filter(target_.chain, target_.shapes);
  }
  return *lane;
}

std::vector<PathOutcome> PathTransfer::transfer(std::span<const store::StoredPath> paths,
                                                const transfer::ArmPair& pair,
                                                const std::stop_token& stop) {
  std::vector<PathOutcome> outcomes(paths.size());
  std::vector<std::size_t> unknown;
  for (std::size_t i = 0; i < paths.size(); ++i)
    if (const KnownPath* const known = find_known(paths[i]))
      outcomes[i] = {*known, true, {}};
    else
      unknown.push_back(i);
  std::atomic<std::size_t> next = 0;
  const std::size_t lanes = std::min(lanes_.size(), unknown.size());
  density::for_each_part(static_cast<int>(lanes), static_cast<int>(lanes), [&](int part) {
    for (std::size_t i = next++; i < unknown.size() && !stop.stop_requested(); i = next++)
      outcomes[unknown[i]] = outcome(paths[unknown[i]], pair, lane(static_cast<std::size_t>(part)));
  });
  return outcomes;
}

const KnownPath* PathTransfer::find_known(const store::StoredPath& stored) const {
  if (known_ == nullptr)
    return nullptr;
  const auto found = known_->find(stored.id);
  const bool holds = found != known_->end() && found->second.report == stored.report_uuid &&
                     !found->second.lacks_scene;
  return holds ? &found->second : nullptr;
}

PathOutcome PathTransfer::outcome(const store::StoredPath& stored, const transfer::ArmPair& pair,
                                  Lane& lane) {
  try {
    return {transferred(stored, pair, lane), false, {}};
  } catch (const std::exception& exception) {
    return {std::nullopt, false, exception.what()};
  }
}

KnownPath PathTransfer::transferred(const store::StoredPath& stored, const transfer::ArmPair& pair,
                                    Lane& lane) const {
  if (stored.path.dof() != pair.source().dof())
    throw Failure(ErrorCode::InvalidInput,
                  "a path of " + std::to_string(stored.path.dof()) + " joints");
  const PathScene& scene = lane.scenes.find(stored);
  lane.filters.scene = scene.keep;
  KnownPath known;
  known.report = stored.report_uuid;
  known.path = std::make_shared<const transfer::TransferredPath>(transfer::transfer_path(
      stored.path, pair, T_target_source(key_.T_task_base, stored.T_task_base),
      key_.profile.transfer, key_.profile.seed, lane.filters));
  known.has_scene = static_cast<bool>(scene.keep);
  known.lacks_scene = scene.is_damaged;
  known.scene_problem = scene.ignored;
  return known;
}

}  // namespace kinship::service
