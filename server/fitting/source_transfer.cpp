#include "server/fitting/source_transfer.hpp"

#include <algorithm>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/fitting/fit_need.hpp"
#include "server/fitting/selected_experience.hpp"

namespace kinship::fitting {
namespace {

// Bounds the memory of one read transaction: megabytes, for paths as planners write them; half a
// gigabyte, were all of them as long and as wide as a report may be.
constexpr std::size_t kPathsPerRead = 128;

/// Whether item `index` of `count` is one of the `wanted` that are spread evenly over them.
bool is_chosen(std::uint64_t index, std::uint64_t count, std::uint64_t wanted) {
  return wanted >= count || (index + 1) * wanted / count > index * wanted / count;
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

/// Calls `visit` with the paths of a robot and task in the order of arrival, page by page, until it
/// says false.
/// \param source  says from which generation of which robot on.
template <typename Visit>
void visit_pages(const store::ExperienceStore& store, const Source& source,
                 const DistributionKey& key, Visit visit) {
  store::PathRange range{.after_id = 0,
                         .limit = kPathsPerRead,
                         .since_ms = key.since_ms,
                         .generation = source.generation};
  for (;;) {
    std::vector<store::StoredPath> page = store.read_paths(source.robot, key.task, range);
    if (page.empty())
      return;
    range.after_id = page.back().id;
    if (!visit(std::move(page)))
      return;
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

SourceTransfer::SourceTransfer(const store::ExperienceStore& store, runtime::RobotRegistry& robots,
                               const DistributionKey& key, const runtime::Robot& target,
                               const Options& options)
    : store_(store),
      robots_(robots),
      key_(key),
      target_(target),
      prepared_target_(options.targets != nullptr ? options.targets->find(target)
                                                  : TargetMemory().find(target)),
      leaves_out_(options.leaves_out),
      threads_(options.threads),
      memory_(options.memory),
      transfer_(store, key, target, *prepared_target_, options.known, options.threads),
      pool_(target.chain.dof()) {}

std::uint64_t SourceTransfer::count_selected(const store::ExperienceSummary& experience,
                                             const std::stop_token& stop) const {
  if (key_.since_ms == 0)
    return experience.paths;
  std::uint64_t count = 0;
  visit_pages(store_, source_of(experience), key_, [&](const std::vector<store::StoredPath>& page) {
    count += page.size();
    return !stop.stop_requested();
  });
  return std::min(count, experience.paths);  // others may arrive meanwhile
}

void SourceTransfer::reserve(const std::vector<store::ExperienceSummary>& experience,
                             const std::vector<std::uint64_t>& wanted,
                             const std::stop_token& stop) {
  if (memory_ == nullptr)
    return;
  const FitSize size{key_, experience, wanted, target_.chain.dof(), threads_};
  FitNeed need = need_at_most(size);
  if (need.bytes > memory_->max_bytes())
    need = need_by_length(size, store_, stop);
  if (need.bytes > memory_->max_bytes())
    throw Failure(ErrorCode::TooLarge, describe(need, memory_->max_bytes()));
  reservation_ = memory_->reserve(need.bytes, stop);
  reserved_bytes_ = need.bytes;
}

SourceSummary SourceTransfer::add(const store::ExperienceSummary& experience,
                                  std::uint64_t selected, std::uint64_t wanted,
                                  const std::stop_token& stop) {
  SourceSummary summary;
  summary.source = source_of(experience);
  summary.paths_selected = selected;
  pool_.begin_source(experience.robot == key_.robot);
  const Result<runtime::RobotRegistry::RobotPointer> robot = robots_.find(experience.robot);
  if (!robot) {
    summary.problem = robot.error().message;
    return summary;
  }
  summary.source.label = robot.value()->label;
  add_paths(*robot.value(), wanted, stop, summary);
  return summary;
}

void SourceTransfer::add_paths(const runtime::Robot& robot, std::uint64_t wanted,
                               const std::stop_token& stop, SourceSummary& summary) {
  const transfer::ArmPair pair(robot.chain, prepared_target_->arm);
  summary.source.relation = relation_of(pair);
  const std::uint64_t count = summary.paths_selected;
  std::uint64_t index = 0;
  if (count > 0)
    visit_pages(store_, summary.source, key_, [&](std::vector<store::StoredPath> page) {
      std::erase_if(page, [&](const store::StoredPath& stored) {
        const bool is_wanted = index < count && is_chosen(index, count, wanted) &&
                               !(leaves_out_ && leaves_out_(stored.report_uuid));
        ++index;
        return !is_wanted;
      });
      const std::vector<PathOutcome> outcomes = transfer_.transfer(page, pair, stop);
      for (std::size_t i = 0; i < page.size(); ++i)
        add_path(page[i], outcomes[i], summary);
      return index < count && !stop.stop_requested();
    });
}

void SourceTransfer::add_path(const store::StoredPath& stored, const PathOutcome& outcome,
                              SourceSummary& summary) {
  if (!outcome.path) {  // one bad path must not cost the others
    ++summary.paths_left_out;
    if (summary.problem.empty())
      summary.problem = "path " + stored.report_uuid.text() + ": " + outcome.problem;
    return;
  }
  ++summary.source.paths_used;
  pool_.add(outcome.path->path, stored.report_uuid);
  if (memory_ != nullptr &&
      static_cast<std::size_t>(pool_.size()) * bytes_of_configuration(target_.chain.dof()) >
          reserved_bytes_)
    throw Failure(ErrorCode::TooLarge, std::to_string(pool_.size()) +
                                           " configurations are more than memory was reserved for");
  summary.source += outcome.path->path->summary;
  count_scene(*outcome.path, summary);
  (stored.T_task_base ? summary.has_placed : summary.has_unplaced) = true;
  transferred_ += outcome.was_known ? 0 : 1;
  used_.emplace(stored.id, *outcome.path);
}

void SourceTransfer::count_scene(const KnownPath& path, SourceSummary& summary) {
  const TransferCounts& transferred = path.path->summary;
  if (!path.has_scene || transferred.filter_checks == 0)
    return;  // nothing was asked: waypoints that were taken over were free on their robot
  ++summary.source.paths_with_scene;
  summary.paths_with_approximate_scene += path.has_approximate_scene ? 1 : 0;
  if (transferred.configurations == 0 && transferred.scene_collisions > 0)
    ++summary.paths_blocked;
  if (summary.scene_problem.empty())
    summary.scene_problem = path.scene_problem;
}

std::vector<SourceSummary> transfer_sources(SourceTransfer& transfer, const DistributionKey& key,
                                            const std::vector<store::ExperienceSummary>& experience,
                                            std::size_t max_paths, const std::stop_token& stop) {
  std::vector<std::uint64_t> selected;
  selected.reserve(experience.size());
  for (const store::ExperienceSummary& source : experience)
    selected.push_back(transfer.count_selected(source, stop));
  const std::vector<std::uint64_t> wanted =
      share_paths(selected, max_paths, key.profile.density.weighting);
  transfer.reserve(experience, wanted, stop);
  std::vector<SourceSummary> summaries;
  for (std::size_t i = 0; i < experience.size(); ++i)
    summaries.push_back(transfer.add(experience[i], selected[i], wanted[i], stop));
  return summaries;
}

}  // namespace kinship::fitting
