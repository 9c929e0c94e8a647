#include "server/store/moving/copying.hpp"

#include <algorithm>
#include <utility>

namespace kinship::store::moving {
namespace {

constexpr std::size_t kRowsRead = 128;  // at once; of 4 MB at most
constexpr std::size_t kRowsOfTransaction = 1024;

MovedRow key_of(const MovedTable& table, const MovedRow& row) {
  return {row.begin(), row.begin() + static_cast<std::ptrdiff_t>(table.keys)};
}

/// The ids of which `wanted` and `present` differ: changed ones first, for the content that one
/// frees may be that of another.
struct DifferingIds {
  std::vector<std::int64_t> changed, missing, extra;
};

DifferingIds compare_ids(const std::vector<RowFingerprint>& wanted,
                         const std::vector<RowFingerprint>& present) {
  DifferingIds differing;
  auto have = present.begin();
  for (const RowFingerprint& row : wanted) {
    for (; have != present.end() && (*have)[0] < row[0]; ++have)
      differing.extra.push_back((*have)[0]);
    if (have == present.end() || (*have)[0] != row[0])
      differing.missing.push_back(row[0]);
    else if (*have++ != row)
      differing.changed.push_back(row[0]);
  }
  for (; have != present.end(); ++have)
    differing.extra.push_back((*have)[0]);
  return differing;
}

/// A label that blocks no other row until this row gets its own, or is gone.
MovedRow with_passing_label(const MovedTable& robots, MovedRow row) {
  row[robots.column("label")] = "moving " + std::to_string(integer_of(row, 0));
  return row;
}

std::vector<MovedRow> keys_of_ids(const std::vector<std::int64_t>& ids) {
  std::vector<MovedRow> keys;
  for (const std::int64_t id : ids)
    keys.push_back({id});
  return keys;
}

std::uint64_t rows_of_pair(const MovedTable& experience, const MovedRow& row) {
  return static_cast<std::uint64_t>(integer_of(row, experience.column("attempts")) +
                                    integer_of(row, experience.column("paths")));
}

std::map<MovedRow, MovedRow> by_key(const MovedTable& table, std::vector<MovedRow> rows) {
  std::map<MovedRow, MovedRow> found;
  for (MovedRow& row : rows)
    found.emplace(key_of(table, row), std::move(row));
  return found;
}

/// Rows that a target lacks or has otherwise; the rows they replace; rows whose keys are gone.
struct DifferingRows {
  std::vector<MovedRow> wanted, replaced, extra;
};

DifferingRows compare_rows(const MovedTable& table, const std::vector<MovedRow>& rows,
                           std::vector<MovedRow> present) {
  std::map<MovedRow, MovedRow> left = by_key(table, std::move(present));
  DifferingRows differing;
  for (const MovedRow& row : rows) {
    const auto node = left.extract(key_of(table, row));
    if (!node.empty() && node.mapped() == row)
      continue;
    differing.wanted.push_back(row);
    if (!node.empty())
      differing.replaced.push_back(node.mapped());
  }
  for (auto& [key, row] : left)
    differing.extra.push_back(std::move(row));
  return differing;
}

}  // namespace

Copying::Copying(Side& source, Side& target, RowsDone rows_done)
    : source_(source), target_(target), rows_done_(std::move(rows_done)) {}

void Copying::run() {
  for (const RowFingerprint& scene : target_.light(moved_table("scene")))
    scenes_.insert(scene[0]);
  copy_names();
  copy_pairs();
  for (const char* const name :
       {"scene", "retired_report", "audit", "distribution", "rehearsal", "search", "mesh"})
    copy_by_id(moved_table(name));
  for (const char* const name : {"distribution_use", "evicted_distribution", "setting"})
    copy_whole(moved_table(name), source_.all(moved_table(name)));
  erase_removed_robots();
}

/// Robots and tasks, as they are when the pairs are listed: so each pair has its names.
void Copying::copy_names() {
  constexpr const char* kOfRobots[] = {"robot_held_joint", "robot_never_colliding",
                                       "robot_geometry", "task"};
  std::vector<MovedRow> robots;
  std::map<std::string, std::vector<MovedRow>> others;
  source_.in_snapshot([&] {
    experience_ = source_.all(moved_table("experience"));
    robots = source_.all(moved_table("robot"));
    for (const char* const name : kOfRobots)
      others[name] = source_.all(moved_table(name));
  });
  copy_robots(robots);
  for (const char* const name : kOfRobots)
    copy_whole(moved_table(name), others[name]);
}

void Copying::copy_robots(const std::vector<MovedRow>& robots) {
  const MovedTable& table = moved_table("robot");
  const DifferingRows differing = compare_rows(table, robots, target_.all(table));
  std::vector<MovedRow> passing;
  for (const std::vector<MovedRow>* const rows : {&differing.replaced, &differing.extra})
    for (const MovedRow& row : *rows)
      passing.push_back(with_passing_label(table, row));
  removed_robots_.insert(removed_robots_.end(), differing.extra.begin(), differing.extra.end());
  target_.in_transaction([&] {
    target_.write(table, passing);
    write(table, differing.wanted);
  });
}

void Copying::erase_removed_robots() {
  target_.in_transaction([&] { target_.erase(moved_table("robot"), removed_robots_); });
}

void Copying::copy_whole(const MovedTable& table, const std::vector<MovedRow>& rows) {
  const DifferingRows differing = compare_rows(table, rows, target_.all(table));
  target_.in_transaction([&] {
    target_.erase(table, differing.extra);
    write(table, differing.wanted);
  });
}

void Copying::copy_pairs() {
  const MovedTable& table = moved_table("experience");
  std::map<MovedRow, MovedRow> present = by_key(table, target_.all(table));
  std::vector<Pair> pairs;
  for (const MovedRow& row : experience_) {
    const auto found = present.find(key_of(table, row));
    if (found != present.end() && found->second == row)
      continue;
    pairs.push_back({integer_of(row, 0), integer_of(row, 1)});
    total_ += rows_of_pair(table, row);
    if (found != present.end())
      total_ -= std::min(total_, rows_of_pair(table, found->second));
  }
  for (const Pair& pair : pairs)
    copy_pair(pair);
}

Copying::PairState Copying::state_of(const Pair& pair) {
  PairState state;
  source_.in_snapshot([&] {
    // Attempts first: each path that one names is among the paths read after it.
    state.attempts = source_.light(moved_table("attempt"), pair);
    state.paths = source_.light(moved_table("path"), pair);
    state.experience = source_.experience_of(pair);
  });
  return state;
}

void Copying::copy_pair(const Pair& pair) {
  const PairState state = state_of(pair);
  const MovedTable& experience = moved_table("experience");
  // With counts of 0 until all of it is there: a move that is ended in between begins it again.
  MovedRow begun;
  for (const MovedColumn& column : experience.columns)
    begun.push_back(column.type == CellType::Real ? Cell(0.0) : Cell(std::int64_t{0}));
  begun[0] = pair.task_id;
  begun[1] = pair.robot_id;
  target_.in_transaction([&] { target_.write(experience, std::vector<MovedRow>{begun}); });

  paths_.clear();
  for (const RowFingerprint& row : state.paths)
    paths_.insert(row[0]);
  for (const auto& [name, wanted] :
       {std::pair<const char*, const std::vector<RowFingerprint>&>("path", state.paths),
        std::pair<const char*, const std::vector<RowFingerprint>&>("attempt", state.attempts)}) {
    const MovedTable& table = moved_table(name);
    const DifferingIds differing = compare_ids(wanted, target_.light(table, pair));
    copy_ids(table, differing.changed);
    copy_ids(table, differing.missing);
  }
  target_.in_transaction([&] { write(experience, std::vector<MovedRow>{state.experience}); });
}

void Copying::copy_by_id(const MovedTable& table) {
  const DifferingIds differing = compare_ids(source_.light(table), target_.light(table));
  // Of these alone rows go; elsewhere there is nothing that is gone.
  if (table.name == "distribution" || table.name == "rehearsal" || table.name == "search" ||
      table.name == "mesh")
    target_.in_transaction([&] { target_.erase(table, keys_of_ids(differing.extra)); });
  copy_ids(table, differing.changed);
  copy_ids(table, differing.missing);
}

void Copying::copy_ids(const MovedTable& table, const std::vector<std::int64_t>& ids) {
  for (std::size_t begin = 0; begin < ids.size(); begin += kRowsOfTransaction) {
    const std::size_t end = std::min(begin + kRowsOfTransaction, ids.size());
    target_.in_transaction([&] {
      for (std::size_t from = begin; from < end; from += kRowsRead) {
        std::vector<MovedRow> rows =
            source_.of_ids(table, std::span(ids).subspan(from, std::min(kRowsRead, end - from)));
        bring_scenes(table, rows);
        drop_unknown_paths(table, rows);
        write(table, rows);
      }
    });
    if (table.reading == Reading::ByPair)
      done_ += end - begin;
    rows_done_(done_, std::max(done_, total_));
  }
}

/// Copies the scenes that rows name, if the target lacks them.
void Copying::bring_scenes(const MovedTable& table, const std::vector<MovedRow>& rows) {
  if (table.reading != Reading::ByPair)
    return;
  const std::size_t column = table.column("scene_id");
  std::set<std::int64_t> lacking;
  for (const MovedRow& row : rows)
    if (const std::int64_t scene = integer_of(row, column); scene != 0 && !scenes_.contains(scene))
      lacking.insert(scene);
  if (lacking.empty())
    return;
  const MovedTable& scenes = moved_table("scene");
  write(scenes, source_.of_ids(scenes, std::vector<std::int64_t>(lacking.begin(), lacking.end())));
  scenes_.merge(lacking);
}

/// A path that came after the pair was listed is for the next copy, with its attempt as it is then.
void Copying::drop_unknown_paths(const MovedTable& table, std::vector<MovedRow>& rows) const {
  if (table.name != "attempt")
    return;
  const std::size_t column = table.column("path_id");
  for (MovedRow& row : rows)
    if (const std::int64_t path = integer_of(row, column); path != 0 && !paths_.contains(path))
      row[column] = Cell();
}

void Copying::write(const MovedTable& table, const std::vector<MovedRow>& rows) {
  if (rows.empty())
    return;
  target_.write(table, rows);
  written_[table.name] += rows.size();
}

}  // namespace kinship::store::moving
