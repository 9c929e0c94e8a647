#include "server/store/postgres/rows/batch_plan.hpp"

#include <algorithm>
#include <string>
#include <utility>

#include "server/store/values/path_content.hpp"
#include "server/store/values/receipt_texts.hpp"

namespace kinship::store::postgres {
namespace {

/// What became of an attempt's path.
struct AttemptPath {
  AttemptStatus status = AttemptStatus::Unsolved;
  std::optional<std::int64_t> id = {};
  bool is_retired = false;

  bool is_in_use() const { return status == AttemptStatus::Stored && id && !is_retired; }
  bool is_beyond_cap() const { return status == AttemptStatus::Stored && !id; }
};

void add_cost(PairChange& change, const PlanningRecord& record) {
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
}

/// Makes a plan attempt by attempt; what is known grows with what is planned.
class Planner {
 public:
  Planner(BatchKnowledge known, std::uint64_t max_paths, std::int64_t now_ms)
      : known_(std::move(known)), max_paths_(max_paths), now_ms_(now_ms) {}

  Receipt decide(const PreparedAttempt& prepared);
  BatchPlan take() { return std::move(plan_); }

 private:
  Receipt decide_new(const PreparedAttempt& prepared, Pair& pair);
  Receipt decide_again(const PreparedAttempt& prepared, Pair& pair, EarlierReport& earlier);
  void need_scene(const PreparedAttempt& prepared);
  AttemptPath keep_path(const PreparedAttempt& prepared, Pair& pair, std::int64_t received_ms);
  std::int64_t plan_path(const PreparedAttempt& prepared, Pair& pair, std::int64_t received_ms,
                         bool is_retired);
  bool is_within_cap(const Pair& pair, const Digest& content) const;
  void drop_excess(Pair& pair);
  void drop(Pair& pair, const KeptPath& path);
  void set_aside(Pair& pair, std::int64_t id);
  void note_replacement(std::int64_t damaged, std::int64_t by);
  Receipt receipt_of(const PreparedAttempt& prepared, const AttemptPath& path) const;
  PairChange& change_of(const Pair& pair) { return plan_.changes[pair.key]; }

  BatchKnowledge known_;
  const std::uint64_t max_paths_;
  const std::int64_t now_ms_;
  std::size_t next_id_ = 0;
  BatchPlan plan_;
};

Receipt Planner::decide(const PreparedAttempt& prepared) {
  const Attempt& attempt = prepared.attempt;
  const auto earlier = known_.reports.find(attempt.report_uuid);
  if (earlier != known_.reports.end() && !is_again(prepared, earlier->second))
    return refused(attempt.report_uuid, "this UUID was used for another report");
  const auto robot = known_.robots.find(attempt.robot);
  if (robot == known_.robots.end())
    return {attempt.report_uuid, ReceiptStatus::UnknownRobot,
            "robot " + attempt.robot.short_hex() + " is not registered"};
  if (prepared.path && prepared.path->blob.dof != robot->second.dof)
    return refused(attempt.report_uuid, "path of " + std::to_string(prepared.path->blob.dof) +
                                            " joints, robot " + attempt.robot.short_hex() +
                                            " has " + std::to_string(robot->second.dof));
  Pair& pair = known_.pairs.at({attempt.robot, attempt.task});
  if (earlier != known_.reports.end())
    return decide_again(prepared, pair, earlier->second);
  return decide_new(prepared, pair);
}

Receipt Planner::decide_new(const PreparedAttempt& prepared, Pair& pair) {
  const Attempt& attempt = prepared.attempt;
  need_scene(prepared);
  const std::int64_t received_ms = prepared.received_ms.value_or(now_ms_);
  const AttemptPath path = keep_path(prepared, pair, received_ms);
  plan_.attempts.push_back({&prepared, pair.key, path.status, path.id});
  PairChange& change = change_of(pair);
  ++change.attempts;
  add_cost(change, attempt.record);
  if (path.status == AttemptStatus::Stored && !path.is_retired)
    drop_excess(pair);
  known_.reports[attempt.report_uuid] = {.body = prepared.body,
                                         .machine = attempt.machine,
                                         .received_ms = received_ms,
                                         .path_id = path.id};
  return receipt_of(prepared, path);
}

/// Answers a report that came before. What it vouches for and cannot be read is written anew.
Receipt Planner::decide_again(const PreparedAttempt& prepared, Pair& pair, EarlierReport& earlier) {
  const Uuid& uuid = prepared.attempt.report_uuid;
  plan_.resent.insert(uuid);
  const bool has_scene = !prepared.scene || earlier.is_scene_readable;
  if (!has_scene)
    need_scene(prepared);
  earlier.is_scene_readable = true;
  if (!prepared.path || earlier.is_path_vouched_for)
    return {uuid,
            has_scene       ? ReceiptStatus::Duplicate
            : prepared.path ? ReceiptStatus::Stored
                            : ReceiptStatus::Recorded,
            ""};
  const std::int64_t damaged = earlier.path_id.value();
  const AttemptPath path = keep_path(prepared, pair, earlier.received_ms);
  if (path.id)
    note_replacement(damaged, *path.id);
  plan_.mended.push_back({uuid, path.status, path.id});
  earlier.path_id = path.id;
  earlier.is_path_vouched_for = true;
  if (path.is_in_use())
    drop_excess(pair);
  if (path.is_beyond_cap())
    return {uuid, ReceiptStatus::Recorded, beyond_cap_in_words(max_paths_)};
  return {uuid, ReceiptStatus::Stored, ""};
}

void Planner::need_scene(const PreparedAttempt& prepared) {
  if (!prepared.scene)
    return;
  bool& is_readable = known_.scenes[prepared.scene->content];
  if (!is_readable)
    plan_.scenes.emplace(prepared.scene->content, &*prepared.scene);
  is_readable = true;
}

AttemptPath Planner::keep_path(const PreparedAttempt& prepared, Pair& pair,
                               std::int64_t received_ms) {
  if (!prepared.path)
    return {};
  const Digest& content = prepared.path->content;
  if (known_.retired.contains(prepared.attempt.report_uuid))
    return {AttemptStatus::Stored, plan_path(prepared, pair, received_ms, true), true};
  if (const auto same = pair.contents.find(content); same != pair.contents.end()) {
    if (same->second.is_readable)
      return {AttemptStatus::DuplicateContent, same->second.id};
    set_aside(pair, same->second.id);
  }
  if (!is_within_cap(pair, content)) {
    ++change_of(pair).dropped;
    return {AttemptStatus::Stored, std::nullopt};
  }
  const std::int64_t id = plan_path(prepared, pair, received_ms, false);
  if (const auto same = pair.contents.find(content); same != pair.contents.end())
    note_replacement(same->second.id, id);
  pair.contents[content] = {id, true};
  ++pair.paths;
  PairChange& change = change_of(pair);
  ++change.paths;
  change.is_changed = true;
  return {AttemptStatus::Stored, id};
}

std::int64_t Planner::plan_path(const PreparedAttempt& prepared, Pair& pair,
                                std::int64_t received_ms, bool is_retired) {
  const std::int64_t id = known_.path_ids.at(next_id_++);
  plan_.paths.push_back({&prepared, pair.key, id, received_ms, false, is_retired});
  if (!is_retired && max_paths_ > 0)  // its checksum as a dropped path: when it is written as one
    pair.largest.insert({prepared.path->content, id, 0});
  return id;
}

bool Planner::is_within_cap(const Pair& pair, const Digest& content) const {
  if (max_paths_ == 0 || pair.paths < max_paths_)
    return true;
  // The threshold lies behind all that is to be dropped first. While that is much (the cap was
  // lowered) this one is taken too: it is dropped in its turn, and the same ones stay in the end.
  const std::uint64_t excess = pair.paths - max_paths_;
  if (excess > kMostDroppedAtOnce || excess >= pair.largest.size())
    return true;
  return content <= std::next(pair.largest.begin(), static_cast<std::ptrdiff_t>(excess))->content;
}

void Planner::drop_excess(Pair& pair) {
  if (max_paths_ == 0 || pair.paths <= max_paths_)
    return;
  const std::uint64_t excess = std::min(pair.paths - max_paths_, kMostDroppedAtOnce);
  for (std::uint64_t i = 0; i < excess && !pair.largest.empty(); ++i)
    drop(pair, *pair.largest.begin());
}

void Planner::drop(Pair& pair, const KeptPath& path) {
  const auto planned = std::ranges::find(plan_.paths, path.id, &PlannedPath::id);
  if (planned != plan_.paths.end())
    planned->is_dropped = true;
  else
    plan_.dropped.push_back(path);
  pair.contents.erase(path.content);
  --pair.paths;
  PairChange& change = change_of(pair);
  --change.paths;
  ++change.dropped;
  change.is_changed = true;
  pair.largest.erase(KeptPath(path));
}

/// Takes a path that is in use out of it, once.
void Planner::set_aside(Pair& pair, std::int64_t id) {
  if (std::ranges::find(plan_.damaged, id, &DamagedPath::id) != plan_.damaged.end())
    return;
  plan_.damaged.push_back({id, std::nullopt});
  const auto kept = std::ranges::find(pair.largest, id, &KeptPath::id);
  if (kept != pair.largest.end())
    pair.largest.erase(kept);
  --pair.paths;
  PairChange& change = change_of(pair);
  --change.paths;
  change.is_changed = true;
}

/// Of a path that was set aside, now or before.
void Planner::note_replacement(std::int64_t damaged, std::int64_t by) {
  const auto noted = std::ranges::find(plan_.damaged, damaged, &DamagedPath::id);
  if (noted == plan_.damaged.end())
    plan_.damaged.push_back({damaged, by});
  else
    noted->replaced_by = by;
}

Receipt Planner::receipt_of(const PreparedAttempt& prepared, const AttemptPath& path) const {
  const Uuid& uuid = prepared.attempt.report_uuid;
  if (path.is_in_use())
    return {uuid, ReceiptStatus::Stored, ""};
  if (path.is_retired)
    return {uuid, ReceiptStatus::Recorded, "recorded, but its path was retired before it came"};
  if (path.is_beyond_cap())
    return {uuid, ReceiptStatus::Recorded, beyond_cap_in_words(max_paths_)};
  return {uuid, prepared.path ? ReceiptStatus::Duplicate : ReceiptStatus::Recorded, ""};
}

}  // namespace

BatchPlan make_plan(PreparedAttempts attempts, BatchKnowledge known, std::uint64_t max_paths,
                    std::int64_t now_ms) {
  Planner planner(std::move(known), max_paths, now_ms);
  std::vector<Receipt> receipts;
  for (const PreparedAttempt* const each : attempts)
    receipts.push_back(planner.decide(*each));
  BatchPlan plan = planner.take();
  plan.receipts = std::move(receipts);
  return plan;
}

}  // namespace kinship::store::postgres
