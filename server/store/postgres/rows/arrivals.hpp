#pragma once

#include <cstdint>
#include <iterator>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/postgres/database/connection.hpp"
#include "server/store/store.hpp"
#include "server/store/tables/pages.hpp"

/// Attempts in the order in which their transactions began. Several servers commit at once, so an
/// attempt may become visible before one that was read already, until every transaction that began
/// earlier has ended.
namespace kinship::store::postgres {

/// The place of an attempt in that order.
struct Arrival {
  std::int64_t transaction = 0;
  std::int64_t id = 0;
  bool is_settled = true;  ///< no attempt becomes visible before it any more
};

/// Empty: the beginning. \throws Failure(InvalidInput) for another cursor.
Arrival parse_arrival_cursor(std::string_view cursor);
std::string cursor_of(const Arrival& arrival);

/// An attempt, and the rows it refers to.
struct ArrivedAttempt {
  Arrival arrival;
  Attempt attempt;  ///< without its path and scene
  std::string label = {};
  std::int64_t received_ms = 0;
  std::optional<std::int64_t> path_id = {};  ///< or of its replacement
  bool is_path_in_use = false;               ///< neither retired, dropped nor damaged
  std::size_t waypoint_bytes = 0;            ///< of its path, 8 a waypoint and joint
  std::optional<std::int64_t> scene_id = {};
  bool is_robot_removed = false;
  // Only when selected by reports:
  Digest body = {};
  bool is_retired = false;
  std::size_t scene_bytes = 0;
};

/// The next attempts of the filter's robot and task, at most `count`.
std::vector<ArrivedAttempt> select_arrived(Connection& connection, const PairFilter& filter,
                                           const Arrival& after, std::int64_t count);

/// The attempts of the known ones of some reports, in no order.
std::vector<ArrivedAttempt> select_arrived(Connection& connection, std::span<const Uuid> reports);
std::map<Uuid, Digest> select_known(Connection& connection, std::span<const Uuid> reports);
std::vector<Bytes> bytes_of(std::span<const Uuid> reports);

/// Reports for another store, see Store::list_arrivals(). A feed ends before the first transaction
/// that is still open: a report never becomes visible before a cursor that was returned.
/// \throws Failure(InvalidInput) for a cursor of another list.
Feed<ArrivedReport> feed_of_arrivals(Connection& connection, std::string_view task,
                                     std::string_view cursor, std::size_t limit);
Feed<Uuid> feed_of_retirements(Connection& connection, std::string_view cursor, std::size_t limit);

/// Fills a page with attempts in order of arrival, so that its cursor misses none: if a page
/// follows, it ends before the first attempt that is not settled. Only if more than a page is not
/// settled, because a transaction stays open, it ends among them; then attempts being committed may
/// be missed, as if they had arrived after the end.
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
  /// Another attempt follows, without room for it.
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
