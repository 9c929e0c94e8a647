#include "server/store/rules/report_resolver.hpp"

#include <algorithm>
#include <cstdint>
#include <iterator>
#include <string>
#include <utility>

#include "proto/types/conversations.hpp"

namespace kinship::store {
namespace {

/// Refused, and why.
Receipt refused(const Uuid& report_uuid, const std::string& why) {
  return {report_uuid, ReceiptStatus::Refused, "attempt " + report_uuid.text() + ": " + why};
}

/// Why a report's path was not kept.
std::string beyond_cap_text(std::uint64_t max_paths) {
  return "recorded, but its path is not kept: its robot and task have " +
         std::to_string(max_paths) + " paths, the most that are kept (--max-paths-per-pair)";
}

/// The fate of an attempt's path.
struct AttemptPath {
  AttemptStatus status = AttemptStatus::Unsolved;
  std::optional<std::int64_t> id = {};
  bool is_retired = false;  ///< from the start

  bool is_in_use() const { return status == AttemptStatus::Stored && id && !is_retired; }
  bool is_beyond_cap() const { return status == AttemptStatus::Stored && !id; }
};

void add_cost(PairChange& change, const PreparedAttempt& prepared) {
  const PlanningRecord& record = prepared.attempt.record;
  if (record.sampling_mode == SamplingMode::Uniform)
    return;
  ModeTotals& sums = record.sampling_mode == SamplingMode::Guided ? change.guided : change.control;
  const auto checks = static_cast<double>(record.collision_checks);
  const bool is_solved = record.outcome == Outcome::Solved;
  ++sums.attempts;
  sums.solved += is_solved ? 1 : 0;
  sums.checks += checks;
  sums.checks_squared += checks * checks;
  sums.checks_of_solved += is_solved ? checks : 0;
  // As kIsMeasured of values/summary_columns says it in SQL.
  if (!prepared.path || record.processor_time_s <= 0 || record.machine_speed <= 0 ||
      record.hand_length_m <= 0 || record.least_clearance_m <= 0)
    return;
  ++sums.measured;
  sums.time_s += record.processor_time_s * record.machine_speed;
  sums.length += prepared.path->length;
  sums.hand_length_m += record.hand_length_m;
  sums.clearance_m += record.least_clearance_m;
}

/// Resolves attempt by attempt; the state follows the changes.
class ReportResolver {
 public:
  ReportResolver(BatchState state, std::uint64_t max_paths, std::int64_t now_ms)
      : state_(std::move(state)), max_paths_(max_paths), now_ms_(now_ms) {}

  Receipt resolve(const PreparedAttempt& prepared);
  BatchChanges take() { return std::move(changes_); }

 private:
  Receipt resolve_new(const PreparedAttempt& prepared, Pair& pair);
  Receipt resolve_again(const PreparedAttempt& prepared, Pair& pair, EarlierReport& earlier);
  void need_scene(const PreparedAttempt& prepared);
  AttemptPath keep_path(const PreparedAttempt& prepared, Pair& pair, std::int64_t received_ms);
  std::int64_t add_path(const PreparedAttempt& prepared, Pair& pair, std::int64_t received_ms,
                        bool is_retired);
  bool is_within_cap(const Pair& pair, const Digest& content) const;
  void drop_excess(Pair& pair);
  void drop(Pair& pair, const KeptPath& path);
  void quarantine(Pair& pair, std::int64_t id);
  void note_damaged(std::int64_t id, std::optional<std::int64_t> replaced_by);
  Receipt receipt_of(const PreparedAttempt& prepared, const AttemptPath& path) const;
  PairChange& change_of(const Pair& pair) { return changes_.pairs[pair.key]; }

  BatchState state_;
  const std::uint64_t max_paths_;
  const std::int64_t now_ms_;
  std::size_t next_id_ = 0;
  BatchChanges changes_;
};

Receipt ReportResolver::resolve(const PreparedAttempt& prepared) {
  if (std::optional<Receipt> refusal = refusal_of(prepared, state_))
    return *std::move(refusal);
  const Attempt& attempt = prepared.attempt;
  Pair& pair = state_.pairs.at(pair_name(prepared, state_));
  const auto earlier = state_.reports.find(attempt.report_uuid);
  return earlier != state_.reports.end() ? resolve_again(prepared, pair, earlier->second)
                                         : resolve_new(prepared, pair);
}

Receipt ReportResolver::resolve_new(const PreparedAttempt& prepared, Pair& pair) {
  const Attempt& attempt = prepared.attempt;
  need_scene(prepared);
  const std::int64_t received_ms = prepared.received_ms.value_or(now_ms_);
  const AttemptPath path = keep_path(prepared, pair, received_ms);
  changes_.attempts.push_back({&prepared, pair.key, path.status, path.id});
  if (!state_.unreadable.contains(attempt.report_uuid)) {
    PairChange& change = change_of(pair);
    ++change.attempts;
    add_cost(change, prepared);
  }
  if (path.status == AttemptStatus::Stored)
    drop_excess(pair);
  state_.reports[attempt.report_uuid] = {.body = prepared.body,
                                         .machine = attempt.machine,
                                         .received_ms = received_ms,
                                         .path_id = path.id};
  return receipt_of(prepared, path);
}

/// Answers a report that came before. Its path and scene are written anew if they are unreadable.
Receipt ReportResolver::resolve_again(const PreparedAttempt& prepared, Pair& pair,
                                      EarlierReport& earlier) {
  const Uuid& uuid = prepared.attempt.report_uuid;
  changes_.resent.insert(uuid);
  const bool has_scene = !prepared.scene || earlier.is_scene_readable;
  if (!has_scene)
    need_scene(prepared);
  earlier.is_scene_readable = true;
  if (!prepared.path || earlier.is_path_backed)
    return {uuid,
            has_scene       ? ReceiptStatus::Duplicate
            : prepared.path ? ReceiptStatus::Stored
                            : ReceiptStatus::Recorded,
            ""};
  const std::int64_t damaged = earlier.path_id.value();
  const AttemptPath path = keep_path(prepared, pair, earlier.received_ms);
  if (std::ranges::count(pair.contents[prepared.path->content].damaged, damaged) > 0)
    quarantine(pair, damaged);  // where keep_path() left the paths of its content as they were
  note_damaged(damaged, path.id);
  changes_.restored.push_back({uuid, path.status, path.id});
  earlier.path_id = path.id;
  earlier.is_path_backed = true;
  if (path.is_in_use())
    drop_excess(pair);
  if (path.is_beyond_cap())
    return {uuid, ReceiptStatus::Recorded, beyond_cap_text(max_paths_)};
  return {uuid, ReceiptStatus::Stored, ""};
}

void ReportResolver::need_scene(const PreparedAttempt& prepared) {
  if (!prepared.scene)
    return;
  bool& is_readable = state_.scenes[prepared.scene->content];
  if (!is_readable)
    changes_.scenes.emplace(prepared.scene->content, &*prepared.scene);
  is_readable = true;
}

AttemptPath ReportResolver::keep_path(const PreparedAttempt& prepared, Pair& pair,
                                      std::int64_t received_ms) {
  if (!prepared.path)
    return {};
  const Uuid& uuid = prepared.attempt.report_uuid;
  // A retired path does not come back because the row of its attempt is damaged.
  if (const auto retired = state_.retired_paths.find(uuid); retired != state_.retired_paths.end())
    return {AttemptStatus::DuplicateContent, retired->second};
  if (state_.retired.contains(uuid))
    return {AttemptStatus::Stored, add_path(prepared, pair, received_ms, true), true};
  const Digest& content = prepared.path->content;
  const SameContent same = pair.contents[content];
  if (same.readable)
    return {AttemptStatus::DuplicateContent, same.readable};
  for (const std::int64_t damaged : same.damaged)
    quarantine(pair, damaged);
  std::optional<std::int64_t> id;
  if (is_within_cap(pair, content)) {
    id = add_path(prepared, pair, received_ms, false);
    pair.contents[content] = {.readable = id, .damaged = {}, .quarantined = {}};
    ++pair.paths;
    PairChange& change = change_of(pair);
    ++change.paths;
    change.is_changed = true;
  } else {
    ++change_of(pair).dropped;
  }
  for (const std::vector<std::int64_t>* const damaged : {&same.damaged, &same.quarantined})
    for (const std::int64_t each : *damaged)
      note_damaged(each, id);
  return {AttemptStatus::Stored, id};
}

std::int64_t ReportResolver::add_path(const PreparedAttempt& prepared, Pair& pair,
                                      std::int64_t received_ms, bool is_retired) {
  const std::int64_t id = state_.path_ids.at(next_id_++);
  changes_.paths.push_back({&prepared, pair.key, id, received_ms, false, is_retired});
  if (!is_retired && max_paths_ > 0)  // its checksum as a dropped path: when it is written as one
    pair.largest.insert({prepared.path->content, id, 0});
  return id;
}

bool ReportResolver::is_within_cap(const Pair& pair, const Digest& content) const {
  if (max_paths_ == 0 || pair.paths < max_paths_)
    return true;
  // The threshold lies behind all that is to be dropped first. While that is much (the cap was
  // lowered) this one is taken too: it is dropped in its turn, and the same ones stay in the end.
  const std::uint64_t excess = pair.paths - max_paths_;
  if (excess > kMaxDroppedAtOnce || excess >= pair.largest.size())
    return true;
  return content <= std::next(pair.largest.begin(), static_cast<std::ptrdiff_t>(excess))->content;
}

void ReportResolver::drop_excess(Pair& pair) {
  if (max_paths_ == 0 || pair.paths <= max_paths_)
    return;
  const std::uint64_t excess = std::min(pair.paths - max_paths_, kMaxDroppedAtOnce);
  for (std::uint64_t i = 0; i < excess && !pair.largest.empty(); ++i)
    drop(pair, *pair.largest.begin());
}

void ReportResolver::drop(Pair& pair, const KeptPath& path) {
  const auto added = std::ranges::find(changes_.paths, path.id, &NewPath::id);
  if (added != changes_.paths.end())
    added->is_dropped = true;
  else
    changes_.dropped.push_back(path);
  pair.contents.erase(path.content);
  --pair.paths;
  PairChange& change = change_of(pair);
  --change.paths;
  ++change.dropped;
  change.is_changed = true;
  pair.largest.erase(KeptPath(path));
}

/// Takes a path that is in use out of it, once.
void ReportResolver::quarantine(Pair& pair, std::int64_t id) {
  if (std::ranges::find(changes_.damaged, id, &DamagedPath::id) != changes_.damaged.end())
    return;
  note_damaged(id, std::nullopt);
  const auto kept = std::ranges::find(pair.largest, id, &KeptPath::id);
  if (kept != pair.largest.end())
    pair.largest.erase(kept);
  --pair.paths;
  PairChange& change = change_of(pair);
  --change.paths;
  change.is_changed = true;
}

/// Of a path that is quarantined, now or before.
void ReportResolver::note_damaged(std::int64_t id, std::optional<std::int64_t> replaced_by) {
  const auto noted = std::ranges::find(changes_.damaged, id, &DamagedPath::id);
  if (noted == changes_.damaged.end())
    changes_.damaged.push_back({id, replaced_by});
  else if (replaced_by)
    noted->replaced_by = replaced_by;
}

Receipt ReportResolver::receipt_of(const PreparedAttempt& prepared, const AttemptPath& path) const {
  const Uuid& uuid = prepared.attempt.report_uuid;
  if (path.is_in_use())
    return {uuid, ReceiptStatus::Stored, ""};
  if (path.is_retired)
    return {uuid, ReceiptStatus::Recorded, "recorded, but its path was retired before it came"};
  if (path.is_beyond_cap())
    return {uuid, ReceiptStatus::Recorded, beyond_cap_text(max_paths_)};
  if (!prepared.path)
    return {uuid, ReceiptStatus::Recorded, ""};
  // A report whose row was damaged is kept anew, although its path is there.
  return {uuid, state_.unreadable.contains(uuid) ? ReceiptStatus::Stored : ReceiptStatus::Duplicate,
          ""};
}

}  // namespace

bool is_again(const PreparedAttempt& prepared, const EarlierReport& earlier) {
  return earlier.body == prepared.body || (earlier.machine != prepared.attempt.machine &&
                                           earlier.body == body_said_by(prepared, earlier.machine));
}

std::optional<Receipt> refusal_of(const PreparedAttempt& prepared, const BatchState& state) {
  const Attempt& attempt = prepared.attempt;
  const auto earlier = state.reports.find(attempt.report_uuid);
  if (earlier != state.reports.end() && !is_again(prepared, earlier->second))
    return refused(attempt.report_uuid, "this UUID was used for another report");
  const auto robot = state.robots.find(attempt.robot);
  if (robot == state.robots.end())
    return Receipt{attempt.report_uuid, ReceiptStatus::UnknownRobot,
                   "robot " + attempt.robot.short_hex() + " is not registered"};
  if (prepared.path && prepared.path->blob.dof != robot->second.dof)
    return refused(attempt.report_uuid, "path of " + std::to_string(prepared.path->blob.dof) +
                                            " joints, robot " + attempt.robot.short_hex() +
                                            " has " + std::to_string(robot->second.dof));
  return std::nullopt;
}

PairName pair_name(const PreparedAttempt& prepared, const BatchState& state) {
  const Attempt& attempt = prepared.attempt;
  const auto earlier = state.reports.find(attempt.report_uuid);
  const bool is_renamed = earlier != state.reports.end() && !earlier->second.task.empty();
  return {attempt.robot, is_renamed ? earlier->second.task : attempt.task};
}

std::vector<const PreparedAttempt*> acceptable(PreparedAttempts attempts, const BatchState& state) {
  std::vector<const PreparedAttempt*> rest;
  for (const PreparedAttempt* const each : attempts)
    if (!refusal_of(*each, state))
      rest.push_back(each);
  return rest;
}

BatchChanges resolve_reports(PreparedAttempts attempts, BatchState state, std::uint64_t max_paths,
                             std::int64_t now_ms) {
  ReportResolver resolver(std::move(state), max_paths, now_ms);
  std::vector<Receipt> receipts;
  for (const PreparedAttempt* const each : attempts)
    receipts.push_back(resolver.resolve(*each));
  BatchChanges changes = resolver.take();
  changes.receipts = std::move(receipts);
  return changes;
}

}  // namespace kinship::store
