#include "server/store/postgres/fit_reads.hpp"

#include <algorithm>
#include <limits>

#include "server/store/tables/experience.hpp"

namespace kinship::store::postgres {
namespace {

constexpr std::size_t kMostPairs = 65'536;  // beyond them the primary is asked

}  // namespace

FitReads::FitReads(const Primary& primary, ConnectionPool& readers, bool uses_replicas)
    : primary_(primary), readers_(readers) {
  if (uses_replicas && primary.hosts().size() > 1)
    for (const ConnectionString& host : primary.hosts())
      replicas_.push_back(std::make_unique<Replica>(host, primary.connection_options()));
}

void FitReads::run_began(const Uuid& run, std::int64_t timeline) {
  const std::lock_guard lock(mutex_);
  run_ = run;
  timeline_ = timeline;
}

template <typename Value, typename Read, typename IsWhole>
Value FitReads::read_pair(const Pair& pair, std::uint64_t generation, Read read, IsWhole is_whole) {
  const Digest& robot = pair.first;
  const std::string& task = pair.second;
  Value value;
  const auto read_replica = [&](Connection& connection) {
    const std::uint64_t has = generation_of(connection, robot, task);
    if (has < std::max(generation, newest_read(pair)))
      return Replica::Answer::Behind;
    value = read(connection);
    if (!is_whole(value))
      return Replica::Answer::Damaged;
    note_read(pair, has);
    return Replica::Answer::Read;
  };
  // The replicas hold each the tasks that they are asked for in memory.
  if (generation > 0 && ask_replicas(std::hash<std::string>()(task), read_replica))
    return value;
  return readers_.read_snapshot([&](Connection& connection) {
    if (!replicas_.empty())
      note_read(pair, generation_of(connection, robot, task));
    return read(connection);
  });
}

PathsRead FitReads::paths(const Digest& robot, std::string_view task, const PathRange& range) {
  return read_pair<PathsRead>(
      {robot, std::string(task)}, range.generation,
      [&](Connection& connection) { return select_paths(connection, robot, task, range); },
      [](const PathsRead& read) { return read.damaged.empty(); });
}

std::vector<std::int64_t> FitReads::path_ids(const Digest& robot, std::string_view task,
                                             std::uint64_t generation) {
  return read_pair<std::vector<std::int64_t>>(
      {robot, std::string(task)}, generation,
      [&](Connection& connection) { return select_path_ids(connection, robot, task); },
      [](const std::vector<std::int64_t>&) { return true; });
}

/// The scene of an id never changes.
SceneRead FitReads::scene(std::int64_t id) {
  SceneRead scene;
  const auto read_replica = [&](Connection& connection) {
    scene = select_scene(connection, id);
    if (scene.scene)
      return Replica::Answer::Read;
    return scene.damaged ? Replica::Answer::Damaged : Replica::Answer::Behind;
  };
  if (ask_replicas(static_cast<std::size_t>(id), read_replica))
    return scene;
  return readers_.read([&](Connection& connection) { return select_scene(connection, id); });
}

bool FitReads::ask_replicas(std::size_t first, const ReadReplica& read) {
  const std::optional<Uuid> run = replicas_.empty() ? std::nullopt : usable_run();
  if (!run)
    return false;
  const auto read_standby = [&](Connection& connection) {
    const StandbyState state = standby_state(connection, *run);
    if (!state.is_standby)
      return Replica::Answer::Primary;
    return state.has_run ? read(connection) : Replica::Answer::Behind;
  };
  for (std::size_t i = 0; i < replicas_.size(); ++i)
    if (replicas_[(first + i) % replicas_.size()]->read(read_standby) == Replica::Answer::Read)
      return true;
  return false;
}

/// Nothing while this server's run is of an earlier primary: rows on a standby of that one may be
/// lost.
std::optional<Uuid> FitReads::usable_run() const {
  const std::int64_t now = primary_.timeline();
  const std::lock_guard lock(mutex_);
  return timeline_ == now ? std::optional(run_) : std::nullopt;
}

std::uint64_t FitReads::newest_read(const Pair& pair) const {
  const std::lock_guard lock(mutex_);
  const auto known = read_.find(pair);
  if (known != read_.end())
    return known->second;
  return read_.size() < kMostPairs ? 0 : std::numeric_limits<std::uint64_t>::max();
}

void FitReads::note_read(const Pair& pair, std::uint64_t generation) {
  const std::lock_guard lock(mutex_);
  if (read_.size() >= kMostPairs && !read_.contains(pair))
    return;
  std::uint64_t& newest = read_[pair];
  newest = std::max(newest, generation);
}

std::vector<ReplicaUse> FitReads::use() const {
  std::vector<ReplicaUse> use;
  for (const std::unique_ptr<Replica>& replica : replicas_)
    use.push_back(replica->use());
  return use;
}

}  // namespace kinship::store::postgres
