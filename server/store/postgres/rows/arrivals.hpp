#pragma once

#include <cstdint>
#include <iterator>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/pages.hpp"

/// Attempts in the order in which their transactions began. Several servers commit at once, so an
/// attempt may become visible behind one that was seen before; it cannot any more where every
/// transaction that began earlier has ended.
namespace kinship::store::postgres {

/// Where an attempt stands in that order.
struct Arrival {
  std::int64_t transaction = 0;
  std::int64_t id = 0;
  bool is_settled = true;  ///< nothing becomes visible before it any more
};

/// \throws Failure(InvalidInput) for what is no cursor of it; empty: the beginning.
Arrival parse_arrival_cursor(std::string_view cursor);
std::string cursor_of(const Arrival& arrival);

/// An attempt and what it names.
struct ArrivedAttempt {
  Arrival arrival;
  Attempt attempt;  ///< without its path and scene
  std::string label = {};
  std::int64_t received_ms = 0;
  std::optional<std::int64_t> path_id = {};  ///< or of what replaced it
  bool is_path_in_use = false;               ///< neither retired, dropped nor damaged
  std::size_t waypoint_bytes = 0;            ///< of its path, 8 a waypoint and joint
  std::optional<std::int64_t> scene_id = {};
  bool is_robot_removed = false;
  // Where it was asked for by its report:
  Digest body = {};
  bool is_retired = false;
  std::size_t scene_bytes = 0;
};

/// The next ones of some robots and tasks, at most `count`.
std::vector<ArrivedAttempt> select_arrived(Connection& connection, const PairFilter& filter,
                                           const Arrival& after, std::int64_t count);

/// Those of some reports that are known, in no order.
std::vector<ArrivedAttempt> select_arrived(Connection& connection, std::span<const Uuid> reports);
std::set<Uuid> select_known(Connection& connection, std::span<const Uuid> reports);
std::vector<Bytes> bytes_of(std::span<const Uuid> reports);

/// Reports as another store is told of them, see Store. A feed ends before the first transaction
/// that is still open: nothing becomes visible behind a cursor that was given.
/// \throws Failure(InvalidInput) for a cursor of something else.
Feed<ArrivedReport> feed_of_arrivals(Connection& connection, std::string_view task,
                                     std::string_view cursor, std::size_t limit);
Feed<Uuid> feed_of_retirements(Connection& connection, std::string_view cursor, std::size_t limit);

/// Fills a page with attempts as they arrived, so that the cursor behind it misses none: where a
/// page follows it ends before what is not settled. Only where more than a page is not settled,
/// which takes a transaction that is kept open, it ends in its midst; then what others are
/// committing may be missed, as if it had come after the end.
template <typename Entry>
class ArrivalPage {
 public:
  explicit ArrivalPage(std::int64_t rows) : rows_(rows) {}

  bool is_full() const { return std::ssize(page_.rows) == rows_; }
  bool is_empty() const { return page_.rows.empty(); }

  void add(Entry entry, const Arrival& arrival) {
    page_.rows.push_back(std::move(entry));
    last_ = arrival;
    if (arrival.is_settled) {
      last_settled_ = arrival;
      ++settled_rows_;
    }
  }
  /// No more attempts follow.
  Page<Entry> last() { return std::move(page_); }
  /// Another one follows for which there is no room.
  Page<Entry> full() {
    if (settled_rows_ > 0)
      page_.rows.erase(page_.rows.begin() + static_cast<std::ptrdiff_t>(settled_rows_),
                       page_.rows.end());
    page_.next_cursor = cursor_of(settled_rows_ > 0 ? last_settled_ : last_);
    return std::move(page_);
  }

 private:
  std::int64_t rows_;
  std::size_t settled_rows_ = 0;
  Arrival last_, last_settled_;
  Page<Entry> page_;
};

}  // namespace kinship::store::postgres
