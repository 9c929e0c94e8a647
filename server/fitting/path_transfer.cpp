#include "server/fitting/path_transfer.hpp"

#include <algorithm>
#include <atomic>
#include <exception>
#include <new>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/stopped.hpp"
#include "server/density/parallel.hpp"
#include "server/transfer/collision_filter.hpp"
#include "server/transfer/transfer.hpp"

namespace kinship::fitting {
namespace {

constexpr std::size_t kMaxGroup = 16;  // paths that keep the kernels of inverse kinematics busy

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

/// Called where an exception was caught: one that is not the path's fault ends the fit, which would
/// else be made of fewer paths than there are.
void rethrow_if_passing() {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    throw;
  } catch (const Failure& failure) {
    if (failure.code() == ErrorCode::Storage)
      throw;
  } catch (const std::exception&) {
    return;
  }
}

}  // namespace

PathTransfer::PathTransfer(const store::Store& store, const DistributionKey& key,
                           const runtime::Robot& target, const KnownPaths* known, int threads)
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
      lane->self = transfer::collision_filter(target_.chain, target_.shapes);
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
  // Few paths, as a refit has, are shared out; what comes of them does not depend on it.
  const std::size_t share = (unknown.size() + lanes_.size() - 1) / lanes_.size();
  const std::size_t size = std::clamp(share, std::size_t{1}, kMaxGroup);
  const std::size_t groups = (unknown.size() + size - 1) / size;
  const std::size_t lanes = std::min(lanes_.size(), groups);
  std::atomic<std::size_t> next = 0;
  density::for_each_part(static_cast<int>(lanes), static_cast<int>(lanes), [&](int part) {
    Lane& own = lane(static_cast<std::size_t>(part));
    for (std::size_t i = next++; i < groups && !stop.stop_requested(); i = next++) {
      const std::size_t first = i * size;
      const std::size_t count = std::min(size, unknown.size() - first);
      transfer_group(paths, std::span(unknown).subspan(first, count), pair, own, stop, outcomes);
    }
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

void PathTransfer::transfer_group(std::span<const store::StoredPath> paths,
                                  std::span<const std::size_t> group, const transfer::ArmPair& pair,
                                  Lane& lane, const std::stop_token& stop,
                                  std::vector<PathOutcome>& outcomes) const {
  std::vector<Prepared> prepared;
  for (const std::size_t i : group) {
    try {
      prepared.push_back(prepare(paths[i], i, pair, lane));
    } catch (const std::exception& exception) {
      rethrow_if_passing();
      outcomes[i] = {std::nullopt, false, exception.what()};
    }
  }
  try {
    transfer_all(paths, prepared, pair, stop, outcomes);
  } catch (const Stopped&) {
    return;
  } catch (const std::exception&) {  // one by one, the one that is to blame is found
    for (const Prepared& one : prepared) {
      try {
        transfer_all(paths, {&one, 1}, pair, stop, outcomes);
      } catch (const Stopped&) {
        return;
      } catch (const std::exception& exception) {
        rethrow_if_passing();
        outcomes[one.index] = {std::nullopt, false, exception.what()};
      }
    }
  }
}

PathTransfer::Prepared PathTransfer::prepare(const store::StoredPath& stored, std::size_t index,
                                             const transfer::ArmPair& pair, Lane& lane) const {
  if (stored.path.dof() != pair.source().dof())
    throw Failure(ErrorCode::InvalidInput,
                  "a path of " + std::to_string(stored.path.dof()) + " joints");
  const PathScene& scene = lane.scenes.find(stored);
  Prepared prepared{index, {lane.self, scene.keep}, {}};
  prepared.known.report = stored.report_uuid;
  prepared.known.has_scene = static_cast<bool>(scene.keep);
  prepared.known.lacks_scene = scene.is_damaged;
  prepared.known.scene_problem = scene.ignored;
  return prepared;
}

void PathTransfer::transfer_all(std::span<const store::StoredPath> paths,
                                std::span<const Prepared> prepared, const transfer::ArmPair& pair,
                                const std::stop_token& stop,
                                std::vector<PathOutcome>& outcomes) const {
  std::vector<transfer::PathToTransfer> group;
  for (const Prepared& one : prepared) {
    const store::StoredPath& stored = paths[one.index];
    group.push_back(
        {stored.path, T_target_source(key_.T_task_base, stored.T_task_base), one.filters});
  }
  std::vector<transfer::TransferredPath> transferred =
      transfer::transfer_paths(group, pair, key_.profile.transfer, key_.profile.seed, stop);
  for (std::size_t i = 0; i < prepared.size(); ++i) {
    KnownPath known = prepared[i].known;
    known.path = std::make_shared<const transfer::TransferredPath>(std::move(transferred[i]));
    outcomes[prepared[i].index] = {std::move(known), false, {}};
  }
}

}  // namespace kinship::fitting
