#include "server/service/source_transfer.hpp"

#include <algorithm>
#include <exception>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/pose.hpp"
#include "server/service/selected_experience.hpp"
#include "server/transfer/collision_filter.hpp"
#include "server/transfer/transfer.hpp"

namespace kinship::service {
namespace {

constexpr std::size_t kPathsPerRead = 64;  // bounds what one read transaction holds in memory

/// Whether item `index` of `count` is one of the `wanted` that are spread evenly over them.
bool is_chosen(std::uint64_t index, std::uint64_t count, std::uint64_t wanted) {
  return wanted >= count || (index + 1) * wanted / count > index * wanted / count;
}

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

Relation relation_of(const transfer::ArmPair& pair) {
  switch (pair.likeness()) {
    case kinematics::ArmLikeness::Exact:
      return Relation::Identical;
    case kinematics::ArmLikeness::Near:
      return Relation::SameArm;
    case kinematics::ArmLikeness::Different:
      return Relation::Other;
  }
  return Relation::Other;
}

void write(const transfer::TransferSummary& total, Source& source) {
  source.poses = total.poses;
  source.poses_solved = total.poses_solved;
  source.out_of_reach = total.out_of_reach;
  source.outside_limits = total.outside_limits;
  source.not_converged = total.not_converged;
  source.configurations = total.configurations;
  source.colliding = total.colliding;
  source.tracks_tried = total.tracks_tried;
  source.tracks_kept = total.tracks_kept;
  source.tracks_through = total.tracks_through;
  source.random_configurations = total.random_configurations;
  source.filter_checks = total.filter_checks;
  source.self_collisions = total.self_collisions;
  source.scene_collisions = total.scene_collisions;
}

/// Calls `visit` with the paths of a robot and task in the order of arrival, until it says false.
template <typename Visit>
void visit_paths(const store::Store& store, const Digest& robot, const DistributionKey& key,
                 Visit visit) {
  store::PathRange range{.after_id = 0, .limit = kPathsPerRead, .since_ms = key.since_ms};
  for (;;) {
    const std::vector<store::StoredPath> page = store.read_paths(robot, key.task, range);
    for (const store::StoredPath& stored : page)
      if (!visit(stored))
        return;
    if (page.empty())
      return;
    range.after_id = page.back().id;
  }
}

}  // namespace

Source source_of(const store::ExperienceSummary& experience) {
  Source source;
  source.robot = experience.robot;
  source.label = experience.robot.short_hex();
  source.paths = experience.paths;
  source.generation = experience.generation;
  return source;
}

SourceTransfer::SourceTransfer(const store::Store& store, RobotRegistry& robots,
                               const DistributionKey& key, const Robot& target)
    : store_(store),
      robots_(robots),
      key_(key),
      target_(target),
      scenes_(store, key, target),
      pool_(target.chain.dof()) {
  if (key.profile.transfer.avoid_self_collision)
    filters_.self = transfer::collision_filter(target.chain, target.shapes);
}

std::uint64_t SourceTransfer::count_selected(const store::ExperienceSummary& experience) const {
  if (key_.since_ms == 0)
    return experience.paths;
  std::uint64_t count = 0;
  visit_paths(store_, experience.robot, key_, [&count](const store::StoredPath&) {
    ++count;
    return true;
  });
  return std::min(count, experience.paths);  // others may arrive meanwhile
}

SourceSummary SourceTransfer::add(const store::ExperienceSummary& experience,
                                  std::uint64_t selected, std::uint64_t wanted,
                                  const std::stop_token& stop) {
  SourceSummary summary;
  summary.source = source_of(experience);
  summary.paths_selected = selected;
  pool_.begin_source(experience.robot == key_.robot);
  const Result<RobotRegistry::RobotPointer> robot = robots_.find(experience.robot);
  if (!robot) {
    summary.problem = robot.error().message;
    return summary;
  }
  summary.source.label = robot.value()->label;
  add_paths(*robot.value(), wanted, stop, summary);
  return summary;
}

void SourceTransfer::add_paths(const Robot& robot, std::uint64_t wanted,
                               const std::stop_token& stop, SourceSummary& summary) {
  const transfer::ArmPair pair(robot.chain, target_.chain);
  summary.source.relation = relation_of(pair);
  transfer::TransferSummary total;
  const std::uint64_t count = summary.paths_selected;
  std::uint64_t index = 0;
  if (count > 0)
    visit_paths(store_, robot.digest, key_, [&](const store::StoredPath& stored) {
      if (stop.stop_requested())
        return false;
      if (is_chosen(index++, count, wanted))
        ++(add_path(stored, pair, summary, total) ? summary.source.paths_used
                                                  : summary.paths_left_out);
      return index < count;
    });
  write(total, summary.source);
}

void SourceTransfer::count_scene(const transfer::TransferSummary& path,
                                 SourceSummary& summary) const {
  if (!filters_.scene || path.filter_checks == 0)
    return;  // nothing was asked: waypoints that were taken over were free on their robot
  ++summary.source.paths_with_scene;
  if (path.configurations == 0 && path.scene_collisions > 0)
    ++summary.paths_blocked;
  summary.scene_problem = scenes_.ignored();
}

bool SourceTransfer::add_path(const store::StoredPath& stored, const transfer::ArmPair& pair,
                              SourceSummary& summary, transfer::TransferSummary& total) {
  try {
    if (stored.path.dof() != pair.source().dof())
      throw Failure(ErrorCode::InvalidInput,
                    "a path of " + std::to_string(stored.path.dof()) + " joints");
    filters_.scene = scenes_.find(stored);
    transfer::TransferredPath moved = transfer::transfer_path(
        stored.path, pair, T_target_source(key_.T_task_base, stored.T_task_base),
        key_.profile.transfer, key_.profile.seed, filters_);
    total.add(moved.summary);
    count_scene(moved.summary, summary);
    pool_.add(std::move(moved), stored.report_uuid);
    (stored.T_task_base ? summary.has_placed : summary.has_unplaced) = true;
    return true;
  } catch (const std::exception& exception) {  // one bad path must not cost the others
    if (summary.problem.empty())
      summary.problem = "path " + stored.report_uuid.text() + ": " + exception.what();
    return false;
  }
}

std::vector<SourceSummary> transfer_sources(SourceTransfer& transfer, const DistributionKey& key,
                                            const std::vector<store::ExperienceSummary>& experience,
                                            std::size_t max_paths, const std::stop_token& stop) {
  std::vector<std::uint64_t> selected;
  selected.reserve(experience.size());
  for (const store::ExperienceSummary& source : experience)
    selected.push_back(transfer.count_selected(source));
  const std::vector<std::uint64_t> wanted =
      share_paths(selected, max_paths, key.profile.density.weighting);
  std::vector<SourceSummary> summaries;
  for (std::size_t i = 0; i < experience.size(); ++i)
    summaries.push_back(transfer.add(experience[i], selected[i], wanted[i], stop));
  return summaries;
}

}  // namespace kinship::service
