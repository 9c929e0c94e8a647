#include "server/fitting/pose_path_memory.hpp"

#include <algorithm>
#include <utility>

#include "proto/types/failure.hpp"
#include "server/fitting/pose_path.hpp"
#include "server/fitting/selected_experience.hpp"

namespace kinship::fitting {
namespace {

constexpr std::size_t kPosePathPage = 128;  // paths read at once

bool is_selected(const std::vector<Digest>& sources, const Digest& robot) {
  return sources.empty() || std::binary_search(sources.begin(), sources.end(), robot);
}

}  // namespace

std::vector<SharedPosePath> PosePathMemory::read(const std::string& task,
                                                 const std::vector<Digest>& sources,
                                                 std::int64_t since_ms,
                                                 const std::stop_token& stop) {
  forget_other_epochs();
  TaskPaths& known = tasks_[task];
  known.last_used = ++uses_;
  update(known, task, stop);
  make_room(task);
  std::vector<const KnownPath*> selected;
  for (const auto& [robot, source] : known.sources)
    if (is_selected(sources, robot))
      for (const KnownPath& path : source.paths)
        if (path.received_ms >= since_ms)
          selected.push_back(&path);
  std::sort(selected.begin(), selected.end(),
            [](const KnownPath* a, const KnownPath* b) { return a->id < b->id; });
  std::vector<SharedPosePath> paths;
  paths.reserve(selected.size());
  for (const KnownPath* const path : selected)
    paths.push_back(path->path);
  return paths;
}

/// A store put back to an earlier state lacks paths that are known here, and nothing tells which.
void PosePathMemory::forget_other_epochs() {
  const Uuid epoch = store_.epoch();
  if (epoch != epoch_)
    tasks_.clear();
  epoch_ = epoch;
}

void PosePathMemory::update(TaskPaths& known, const std::string& task,
                            const std::stop_token& stop) {
  // Before the paths: changes while they are read are noticed the next time.
  const std::vector<store::ExperienceSummary> experience = store_.experience(task);
  std::vector<std::uint64_t> counts;
  counts.reserve(experience.size());
  for (const store::ExperienceSummary& source : experience)
    counts.push_back(source.paths);
  const std::vector<std::uint64_t> shares = share_paths(counts, limits_.paths, Weighting::Sources);
  for (std::size_t i = 0; i < experience.size() && !stop.stop_requested(); ++i)
    update(known.sources[experience[i].robot], experience[i], task, shares[i], stop);
}

void PosePathMemory::update(SourcePaths& known, const store::ExperienceSummary& now,
                            const std::string& task, std::size_t most,
                            const std::stop_token& stop) {
  if (now.retired_generation != known.retired_generation || (known.is_cut && most > known.most))
    known = {};
  if (now.generation != known.generation && !read_new(known, now, task, most, stop))
    return;
  if (now.dropped != known.dropped) {
    forget_dropped(known, now, task);
    // Only the newest were computed, but a cap keeps paths of any age.
    if (known.is_cut && 2 * known.paths.size() < std::min<std::uint64_t>(most, now.paths)) {
      known = {};
      known.dropped = now.dropped;
      if (!read_new(known, now, task, most, stop))
        return;
    }
  }
  if (known.paths.size() > most) {
    known.is_cut = true;
    known.paths.erase(known.paths.begin(), known.paths.end() - static_cast<std::ptrdiff_t>(most));
  }
  known.most = most;
}

/// \return whether all of them were read.
bool PosePathMemory::read_new(SourcePaths& known, const store::ExperienceSummary& now,
                              const std::string& task, std::size_t most,
                              const std::stop_token& stop) {
  const auto robot = robots_.find(now.robot);
  if (!robot && robot.error().code == ErrorCode::Storage)
    throw Failure(robot.error());  // may pass
  if (!robot)
    return false;
  // Of a source that is new here only the newest are computed.
  std::uint64_t older = known.last_id == 0 && now.paths > most ? now.paths - most : 0;
  known.is_cut = known.is_cut || older > 0;
  while (!stop.stop_requested()) {
    const std::vector<store::StoredPath> page = store_.read_paths(
        now.robot, task,
        {.after_id = known.last_id, .limit = kPosePathPage, .generation = now.generation});
    if (page.empty()) {
      known.generation = now.generation;
      known.retired_generation = now.retired_generation;
      return true;
    }
    for (const store::StoredPath& stored : page) {
      known.last_id = stored.id;
      if (older > 0)
        --older;
      else
        add(known, stored, **robot);
    }
  }
  return false;
}

void PosePathMemory::add(SourcePaths& known, const store::StoredPath& stored,
                         const runtime::Robot& robot) {
  ++computed_;
  if (std::optional<PosePath> path = pose_path(stored, robot))
    known.paths.push_back(
        {stored.id, stored.received_ms, std::make_shared<const PosePath>(*std::move(path))});
}

/// Paths beyond the store's cap may be of any age.
void PosePathMemory::forget_dropped(SourcePaths& known, const store::ExperienceSummary& now,
                                    const std::string& task) const {
  const std::vector<std::int64_t> ids = store_.path_ids(now.robot, task, now.generation);
  std::erase_if(known.paths, [&ids](const KnownPath& path) {
    return !std::binary_search(ids.begin(), ids.end(), path.id);
  });
  known.dropped = now.dropped;
}

std::size_t PosePathMemory::size_of(const TaskPaths& known) {
  constexpr std::size_t kNode = 64;  // of a map, and of a shared pointer's block, about
  std::size_t bytes = kNode + sizeof(TaskPaths);
  for (const auto& [robot, source] : known.sources) {
    bytes += kNode + sizeof(SourcePaths) + source.paths.capacity() * sizeof(KnownPath);
    for (const KnownPath& path : source.paths)
      bytes += kNode + sizeof(PosePath) + path.path->poses.capacity() * sizeof(Eigen::Isometry3d);
  }
  return bytes;
}

/// Forgets tasks that were not asked for longest, but not this one.
void PosePathMemory::make_room(std::string_view task) {
  std::size_t bytes = 0;
  for (const auto& [name, known] : tasks_)
    bytes += size_of(known);
  while (bytes > limits_.bytes && tasks_.size() > 1) {
    const auto oldest =
        std::min_element(tasks_.begin(), tasks_.end(), [&](const auto& a, const auto& b) {
          return std::pair(a.first == task, a.second.last_used) <
                 std::pair(b.first == task, b.second.last_used);
        });
    bytes -= size_of(oldest->second);
    tasks_.erase(oldest);
  }
  bytes_ = bytes;
}

}  // namespace kinship::fitting
