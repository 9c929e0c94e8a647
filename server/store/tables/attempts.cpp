#include "server/store/tables/attempts.hpp"

#include <algorithm>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "server/store/tables/pages.hpp"
#include "server/store/tables/searches.hpp"
#include "server/store/values/experience_key.hpp"
#include "server/store/values/record_columns.hpp"
#include "server/store/values/robot_columns.hpp"

namespace kinship::store {
namespace {

/// An attempt, as far as a listing has to look at it.
struct LightAttempt {
  std::int64_t id = 0;
  Outcome outcome = Outcome::Failed;
  std::int64_t received_ms = 0;
  double planning_time_s = 0;
};

constexpr std::string_view kLightColumns =
    "SELECT id, outcome, received_ms, planning_time_s FROM attempt WHERE id < $1";

void append(Rows rows, std::vector<LightAttempt>& attempts) {
  for (const Row& row : rows)
    attempts.push_back({row.column_integer(0), outcome_of(row.column_integer(1)),
                        row.column_integer(2), row.column_real(3)});
}

std::vector<ExperienceKey> keys_of(Session& session, const PairFilter& filter) {
  std::vector<Parameter> parameters;
  const std::string sql = "SELECT task_id, robot_id FROM experience WHERE TRUE" +
                          filter.condition(session, "experience", parameters);
  std::vector<ExperienceKey> keys;
  for (const Row& row : session.query_with(sql, parameters))
    keys.push_back({row.column_integer(0), row.column_integer(1)});
  return keys;
}

/// The newest attempts before one: of all, or each robot and task brings its own, along an index.
std::vector<LightAttempt> newest_before(Session& session, const PairFilter& filter,
                                        std::int64_t before_id, std::int64_t count) {
  std::vector<LightAttempt> attempts;
  if (filter.is_empty()) {
    append(
        session.query(std::string(kLightColumns) + " ORDER BY id DESC LIMIT $2", before_id, count),
        attempts);
    return attempts;
  }
  const std::string of_pair = std::string(kLightColumns) +
                              " AND task_id = $2 AND robot_id = $3 ORDER BY " +
                              std::string(session.dialect().newest_attempts_first) + " LIMIT $4";
  for (const ExperienceKey& key : keys_of(session, filter))
    append(session.query(of_pair, before_id, key.task_id, key.robot_id, count), attempts);
  std::ranges::sort(attempts, std::greater(), &LightAttempt::id);
  if (std::ssize(attempts) > count)
    attempts.resize(static_cast<std::size_t>(count));
  return attempts;
}

bool is_wanted(const AttemptFilter& filter, const LightAttempt& attempt) {
  if (attempt.received_ms < filter.since_ms)
    return false;
  switch (filter.outcome) {
    case OutcomeFilter::All:
      return true;
    case OutcomeFilter::Solved:
      return attempt.outcome == Outcome::Solved;
    case OutcomeFilter::Unsolved:
      return attempt.outcome != Outcome::Solved;
    case OutcomeFilter::Timeout:
      return attempt.outcome == Outcome::Timeout;
    case OutcomeFilter::Failed:
      return attempt.outcome == Outcome::Failed;
  }
  return false;
}

/// 0 for an attempt without a path.
double length_of_path(Session& session, std::int64_t attempt_id) {
  const Rows rows = session.query(
      "SELECT length FROM path WHERE id = (SELECT path_id FROM attempt WHERE id = $1) AND " +
          session.is_intact("path"),
      attempt_id);
  return rows.empty() ? 0 : rows.front().column_real(0);
}

/// Nothing if it, its robot or its task cannot be read, or its robot is removed.
std::optional<AttemptSummary> select_summary(Session& session, std::int64_t id) {
  constexpr int kFirstOfRecord = 6;
  auto summary = session.unless_damaged([&]() -> std::optional<AttemptSummary> {
    const Rows rows = session.query(
        "SELECT attempt.report_uuid, robot.digest, robot.label, task.name, attempt.machine,"
        " attempt.received_ms, " +
            record_columns("attempt.") +
            "FROM attempt JOIN robot ON robot.id = attempt.robot_id"
            " JOIN task ON task.id = attempt.task_id WHERE attempt.id = $1 AND " +
            session.is_intact("attempt") + " AND " + session.is_intact("robot") + " AND " +
            session.is_intact("task"),
        id);
    if (rows.empty() || is_removed_label(rows.front().column_text(2)))
      return std::nullopt;
    const Row& row = rows.front();
    return AttemptSummary{.report_uuid = id_of<Uuid>(row.column_blob(0)),
                          .robot = id_of<Digest>(row.column_blob(1)),
                          .label = std::string(row.column_text(2)),
                          .task = std::string(row.column_text(3)),
                          .machine = std::string(row.column_text(4)),
                          .record = read_record(row, kFirstOfRecord),
                          .received_ms = row.column_integer(5)};
  });
  if (!summary)
    return std::nullopt;
  const std::optional<std::string> why = select_why(session, summary->report_uuid);
  summary->has_search = why.has_value();
  summary->why = why.value_or("");
  summary->length = session.unless_damaged([&] { return length_of_path(session, id); });
  return summary;
}

void add_summary(Session& session, const LightAttempt& attempt, Page<AttemptSummary>& page) {
  if (std::optional<AttemptSummary> summary = select_summary(session, attempt.id))
    page.rows.push_back(*std::move(summary));
}

Page<AttemptSummary> page_of_slowest(Session& session, const WantedAttempts& wanted,
                                     std::int64_t rows) {
  std::vector<LightAttempt> attempts =
      newest_before(session, {wanted.robot, wanted.task}, parse_falling_cursor({}),
                    static_cast<std::int64_t>(kMaxSlowestOf));
  std::erase_if(attempts,
                [&](const LightAttempt& each) { return !is_wanted(wanted.filter, each); });
  std::ranges::stable_sort(attempts, std::greater(), &LightAttempt::planning_time_s);
  Page<AttemptSummary> page;
  for (const LightAttempt& attempt : attempts) {
    if (std::ssize(page.rows) == rows)
      break;
    add_summary(session, attempt, page);
  }
  return page;
}

}  // namespace

Page<AttemptSummary> page_of_found_attempts(Session& session, const WantedAttempts& wanted,
                                            std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  if (wanted.filter.order == AttemptOrder::Slowest)
    return page_of_slowest(session, wanted, rows);
  constexpr auto kLookedAt = static_cast<std::int64_t>(kMaxSlowestOf);
  Page<AttemptSummary> page;
  std::int64_t before_id = parse_falling_cursor(cursor);
  bool is_any_in_time = false;  // else older ones are hardly, as they come in the order of time
  for (std::int64_t looked = 0, part = rows + 1; looked < kLookedAt; part *= 2) {
    const std::int64_t count = std::min(part, kLookedAt - looked);
    const std::vector<LightAttempt> attempts =
        newest_before(session, {wanted.robot, wanted.task}, before_id, count);
    for (const LightAttempt& attempt : attempts) {
      is_any_in_time = is_any_in_time || attempt.received_ms >= wanted.filter.since_ms;
      if (is_wanted(wanted.filter, attempt)) {
        if (std::ssize(page.rows) == rows) {
          page.next_cursor = std::to_string(before_id);
          return page;
        }
        add_summary(session, attempt, page);
      }
      before_id = attempt.id;
    }
    if (std::ssize(attempts) < count)
      return page;
    looked += count;
  }
  if (is_any_in_time)
    page.next_cursor = std::to_string(before_id);
  return page;
}

}  // namespace kinship::store
