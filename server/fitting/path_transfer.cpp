#include "server/fitting/path_transfer.hpp"

#include <algorithm>
#include <exception>
#include <list>
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

/// One thread's share: paths that it takes one after the other, several under way at a time.
class PathTransfer::Share {
 public:
  /// The arguments outlive it.
  Share(const PathTransfer& of, Queue& queue, const transfer::ArmPair& pair, Lane& lane,
        const std::stop_token& stop)
      : of_(of), queue_(queue), pair_(pair), lane_(lane), stop_(stop) {}

  void transfer() {
    try {
      while (!try_stream())
        for (; !under_way_.empty(); under_way_.pop_front())
          transfer_alone(under_way_.front());
    } catch (const Stopped&) {
    }
  }

 private:
  struct UnderWay {
    UnderWay(const PathTransfer& of, const store::StoredPath& stored, Prepared of_it)
        : prepared(std::move(of_it)),
          path{stored.path, T_target_source(of.key_.T_task_base, stored.T_task_base),
               prepared.filters} {}

    Prepared prepared;
    transfer::PathToTransfer path;  // points to the filters
  };

  /// \return whether all are done; otherwise one of the paths under way is to blame.
  bool try_stream() {
    try {
      transfer::transfer_stream(
          {.next = [this] { return next(); },
           .done =
               [this](const transfer::PathToTransfer& path, transfer::TransferredPath transferred) {
                 finish(path, std::move(transferred));
               }},
          pair_, of_.key_.profile.transfer, of_.key_.profile.seed, stop_);
      return true;
    } catch (const Stopped&) {
      throw;
    } catch (const std::exception&) {
      rethrow_if_passing();
      if (under_way_.empty())
        throw;
      return false;
    }
  }

  /// The next path that can be transferred at all.
  const transfer::PathToTransfer* next() {
    for (std::size_t i = queue_.next++; i < queue_.unknown.size(); i = queue_.next++) {
      throw_if_stopped(stop_);
      const std::size_t index = queue_.unknown[i];
      const store::StoredPath& stored = queue_.paths[index];
      try {
        under_way_.emplace_back(of_, stored, of_.prepare(stored, index, pair_, lane_));
        return &under_way_.back().path;
      } catch (const std::exception& exception) {
        rethrow_if_passing();
        queue_.outcomes[index] = {std::nullopt, false, exception.what()};
      }
    }
    return nullptr;
  }

  void finish(const transfer::PathToTransfer& path, transfer::TransferredPath transferred) {
    const auto done = std::ranges::find_if(
        under_way_, [&path](const UnderWay& one) { return &one.path == &path; });
    keep(done->prepared, std::move(transferred));
    under_way_.erase(done);
  }

  void keep(Prepared& prepared, transfer::TransferredPath transferred) {
    prepared.known.path = std::make_shared<const transfer::TransferredPath>(std::move(transferred));
    queue_.outcomes[prepared.index] = {std::move(prepared.known), false, {}};
  }

  void transfer_alone(UnderWay& one) {
    try {
      keep(one.prepared,
           std::move(transfer::transfer_paths({&one.path, 1}, pair_, of_.key_.profile.transfer,
                                              of_.key_.profile.seed, stop_)
                         .front()));
    } catch (const Stopped&) {
      throw;
    } catch (const std::exception& exception) {
      rethrow_if_passing();
      queue_.outcomes[one.prepared.index] = {std::nullopt, false, exception.what()};
    }
  }

  const PathTransfer& of_;
  Queue& queue_;
  const transfer::ArmPair& pair_;
  Lane& lane_;
  const std::stop_token& stop_;
  std::list<UnderWay> under_way_;
};

PathTransfer::PathTransfer(const store::ExperienceStore& store, const DistributionKey& key,
                           const runtime::Robot& target, const transfer::TargetRobot& prepared,
                           const KnownPaths* known, int threads)
    : store_(store),
      key_(key),
      target_(target),
      prepared_target_(prepared),
      known_(known),
      lanes_(static_cast<std::size_t>(std::max(threads, 1))) {}

PathTransfer::Lane& PathTransfer::lane(std::size_t index) {
  std::unique_ptr<Lane>& lane = lanes_[index];
  if (!lane) {
    lane = std::make_unique<Lane>(Lane{{}, SceneFilters(store_, key_, target_, prepared_target_)});
    if (key_.profile.transfer.avoid_self_collision)
      lane->self = transfer::self_filter(prepared_target_);
  }
  return *lane;
}

std::vector<PathOutcome> PathTransfer::transfer(std::span<const store::StoredPath> paths,
                                                const transfer::ArmPair& pair,
                                                const std::stop_token& stop) {
  Queue queue;
  queue.paths = paths;
  queue.outcomes.resize(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i)
    if (const KnownPath* const known = find_known(paths[i]))
      queue.outcomes[i] = {*known, true, {}};
    else
      queue.unknown.push_back(i);
  const std::size_t lanes = std::min(lanes_.size(), queue.unknown.size());
  density::for_each_part(static_cast<int>(lanes), static_cast<int>(lanes), [&](int part) {
    Share(*this, queue, pair, lane(static_cast<std::size_t>(part)), stop).transfer();
  });
  return std::move(queue.outcomes);
}

const KnownPath* PathTransfer::find_known(const store::StoredPath& stored) const {
  if (known_ == nullptr)
    return nullptr;
  const auto found = known_->find(stored.id);
  const bool holds = found != known_->end() && found->second.report == stored.report_uuid &&
                     !found->second.lacks_scene;
  return holds ? &found->second : nullptr;
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
  prepared.known.has_approximate_scene = scene.is_approximate;
  prepared.known.lacks_scene = scene.is_damaged;
  prepared.known.scene_problem = scene.ignored;
  return prepared;
}

}  // namespace kinship::fitting
