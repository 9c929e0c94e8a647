#include "server/store/postgres/rows/export_rows.hpp"

#include <algorithm>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "server/store/postgres/rows/arrivals.hpp"
#include "server/store/tables/pages.hpp"
#include "server/store/values/crc32c.hpp"
#include "server/store/values/path_content.hpp"
#include "server/store/values/scene_blob.hpp"
#include "server/store/values/search_blob.hpp"

namespace kinship::store::postgres {
namespace {

std::map<Uuid, SearchRecord> select_searches(Connection& connection,
                                             std::span<const Uuid> reports) {
  std::map<Uuid, SearchRecord> searches;
  if (reports.empty())
    return searches;
  for (const Row row : connection.query("SELECT report_uuid, crc32c, payload FROM search"
                                        " WHERE report_uuid = ANY ($1)",
                                        bytes_of(reports))) {
    const Bytes payload = row.column_blob(2);
    std::optional<SearchRecord> search =
        crc32c(payload) == row.column_integer(1) ? decode_search(payload) : std::nullopt;
    if (search)
      searches.insert_or_assign(id_of<Uuid>(row.column_blob(0)), *std::move(search));
  }
  return searches;
}

/// Paths and scenes by their ids, each read once, and search records by their reports.
class Contents {
 public:
  Contents(Connection& connection, DamagedRows& noticed)
      : connection_(&connection), noticed_(&noticed) {}

  /// Reads the paths, search records and scenes of these attempts, in place of the paths and
  /// records read before.
  void read(std::span<const ArrivedAttempt> attempts) {
    std::vector<std::int64_t> path_ids, scene_ids;
    std::vector<Uuid> reports;
    for (const ArrivedAttempt& arrived : attempts) {
      reports.push_back(arrived.attempt.report_uuid);
      if (arrived.path_id)
        path_ids.push_back(*arrived.path_id);
      if (arrived.scene_id && !scenes_.contains(*arrived.scene_id))
        scene_ids.push_back(*arrived.scene_id);
    }
    read_paths(path_ids);
    read_scenes(scene_ids);
    searches_ = select_searches(*connection_, reports);
  }
  /// An attempt with its path, scene and search record, if they can be read.
  Attempt whole(ArrivedAttempt arrived) const {
    if (arrived.path_id)
      if (const auto found = paths_.find(*arrived.path_id); found != paths_.end())
        arrived.attempt.path = found->second;
    if (arrived.scene_id)
      if (const auto found = scenes_.find(*arrived.scene_id); found != scenes_.end())
        arrived.attempt.scene = found->second;
    if (const auto found = searches_.find(arrived.attempt.report_uuid); found != searches_.end())
      arrived.attempt.search = found->second;
    return std::move(arrived.attempt);
  }

 private:
  void read_paths(const std::vector<std::int64_t>& ids) {
    paths_.clear();
    if (ids.empty())
      return;
    for (const Row row : connection_->query("SELECT " + std::string(kPathColumns) +
                                                "FROM path WHERE id = ANY ($1) AND"
                                                " damaged_ms IS NULL AND length(waypoints) > 1",
                                            ids))
      if (std::optional<StoredPath> stored = store::read_path(row))
        paths_.emplace(stored->id, std::move(stored->path));
      else
        noticed_->paths.push_back(row.column_integer(PathColumn::kId));
  }
  void read_scenes(const std::vector<std::int64_t>& ids) {
    if (ids.empty())
      return;
    for (const Row row : connection_->query("SELECT " + std::string(kSceneColumns) +
                                                "FROM scene WHERE id = ANY ($1) AND"
                                                " damaged_ms IS NULL",
                                            ids))
      if (std::optional<RecordedScene> scene = read_scene_columns(row))
        scenes_.emplace(row.column_integer(0), std::move(*scene));
      else
        noticed_->scenes.push_back(row.column_integer(0));
  }

  Connection* connection_;
  DamagedRows* noticed_;
  std::map<std::int64_t, Path> paths_;
  std::map<std::int64_t, RecordedScene> scenes_;
  std::map<Uuid, SearchRecord> searches_;
};

bool is_exported(const ArrivedAttempt& arrived) {
  const bool is_solved = arrived.attempt.record.outcome == Outcome::Solved;
  return !arrived.is_robot_removed && (arrived.path_id ? arrived.is_path_in_use : !is_solved);
}

/// The number of these to read together: their waypoints stay within `max_bytes`.
std::size_t size_of_portion(std::span<const ArrivedAttempt> attempts, std::size_t max_bytes) {
  std::size_t size = 0, bytes = 0;
  while (size < attempts.size() &&
         (size == 0 || bytes + attempts[size].waypoint_bytes <= max_bytes))
    bytes += attempts[size++].waypoint_bytes;
  return size;
}

/// An export as it grows.
class Export {
 public:
  Export(Connection& connection, std::size_t limit, std::size_t max_bytes, DamagedRows& noticed)
      : contents_(connection, noticed),
        page_(static_cast<std::int64_t>(std::max<std::size_t>(limit, 1))),
        max_bytes_(max_bytes) {}

  /// \return false once there is no room for one of them.
  bool add(std::span<ArrivedAttempt> attempts) {
    while (!attempts.empty()) {
      const auto portion = attempts.first(size_of_portion(attempts, max_bytes_));
      contents_.read(portion);
      for (ArrivedAttempt& arrived : portion)
        if (!add(std::move(arrived)))
          return false;
      attempts = attempts.subspan(portion.size());
    }
    return true;
  }
  ArrivalPage<Attempt>& page() { return page_; }

 private:
  bool add(ArrivedAttempt arrived) {
    const Arrival arrival = arrived.arrival;
    const bool is_solved = arrived.attempt.record.outcome == Outcome::Solved;
    Attempt attempt = contents_.whole(std::move(arrived));
    if (attempt.path.has_value() != is_solved)
      return true;
    const BatchBytes more = batch_bytes(attempt);
    bytes_ += more.waypoints + more.scenes + more.searches;
    if (page_.is_full() || (!page_.is_empty() && bytes_ > max_bytes_))
      return false;
    page_.add(std::move(attempt), arrival);
    return true;
  }

  Contents contents_;
  ArrivalPage<Attempt> page_;
  std::size_t max_bytes_;
  std::size_t bytes_ = 0;
};

}  // namespace

Page<AttemptSummary> page_of_attempts(Connection& connection, const PairFilter& filter,
                                      std::string_view cursor, std::size_t limit) {
  const std::int64_t rows = rows_of_page(limit);
  Arrival last = parse_arrival_cursor(cursor);
  ArrivalPage<AttemptSummary> page(rows);
  while (true) {
    std::vector<ArrivedAttempt> next = select_arrived(connection, filter, last, rows + 1);
    if (next.empty())
      return page.last();
    for (ArrivedAttempt& arrived : next) {
      last = arrived.arrival;
      if (arrived.is_robot_removed)
        continue;
      if (page.is_full())
        return page.full();
      Attempt& attempt = arrived.attempt;
      page.add(
          {attempt.report_uuid, attempt.robot, std::move(arrived.label), std::move(attempt.task),
           std::move(attempt.machine), std::move(attempt.record), arrived.received_ms},
          last);
    }
  }
}

std::optional<Attempt> find_attempt(Connection& connection, const Uuid& report_uuid,
                                    DamagedRows& noticed) {
  const std::vector<ArrivedAttempt> arrived =
      select_arrived(connection, std::span(&report_uuid, 1));
  if (arrived.empty())
    return std::nullopt;
  Contents contents(connection, noticed);
  contents.read(arrived);
  return contents.whole(arrived.front());
}

Page<Attempt> export_page(Connection& connection, const PairFilter& filter, std::string_view cursor,
                          std::size_t limit, std::size_t max_bytes, DamagedRows& noticed) {
  constexpr std::int64_t kCandidates = 256;
  Arrival last = parse_arrival_cursor(cursor);
  Export exported(connection, limit, max_bytes, noticed);
  while (true) {
    std::vector<ArrivedAttempt> next = select_arrived(connection, filter, last, kCandidates);
    if (next.empty())
      return exported.page().last();
    last = next.back().arrival;
    std::erase_if(next, [](const ArrivedAttempt& arrived) { return !is_exported(arrived); });
    if (!exported.add(next))
      return exported.page().full();
  }
}

ReplicatedRead select_replicated(Connection& connection, std::span<const Uuid> reports,
                                 std::size_t max_bytes) {
  std::map<Uuid, ArrivedAttempt> known;
  for (ArrivedAttempt& arrived : select_arrived(connection, reports))
    if (!arrived.is_robot_removed)
      known.emplace(arrived.attempt.report_uuid, std::move(arrived));
  ReplicatedRead read;
  std::vector<ArrivedAttempt> taken;
  std::size_t bytes = 0;
  for (const Uuid& report : reports) {
    if (read.found.looked_at > 0 && bytes > max_bytes)
      break;
    ++read.found.looked_at;
    const auto found = known.find(report);
    if (found == known.end())
      continue;
    bytes += found->second.waypoint_bytes + found->second.scene_bytes;
    taken.push_back(found->second);
  }
  Contents contents(connection, read.damaged);
  contents.read(taken);
  for (const ArrivedAttempt& arrived : taken) {
    ReplicatedReport shared{contents.whole(arrived), arrived.body, arrived.received_ms,
                            arrived.is_retired};
    if (shared.attempt.path.has_value() == (shared.attempt.record.outcome == Outcome::Solved))
      read.found.reports.push_back(std::move(shared));
  }
  return read;
}

}  // namespace kinship::store::postgres
