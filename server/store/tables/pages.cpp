#include "server/store/tables/pages.hpp"

#include <algorithm>
#include <charconv>
#include <limits>

namespace kinship::store {
namespace {

std::int64_t parse_id(std::string_view cursor, std::int64_t first) {
  if (cursor.empty())
    return first;
  std::int64_t id = 0;
  const char* const end = cursor.data() + cursor.size();
  const auto [after, error] = std::from_chars(cursor.data(), end, id);
  if (error != std::errc() || after != end || id < 0)
    refuse_cursor(cursor);
  return id;
}

}  // namespace

std::string id_of_task(Session& session, const std::string& name) {
  return "(SELECT id FROM task WHERE name = " + name + " AND " + session.is_intact("task") + ")";
}

std::string id_of_robot(Session& session, const std::string& digest) {
  return "(SELECT id FROM robot WHERE digest = " + digest + " AND " + session.is_intact("robot") +
         ")";
}

std::vector<PairFilter::Column> PairFilter::columns(Session& session,
                                                    std::vector<Parameter>& parameters) const {
  std::vector<Column> columns;
  const auto newest = [&] { return "$" + std::to_string(parameters.size()); };
  if (!task.empty()) {
    parameters.emplace_back(task);
    columns.push_back({"task_id", id_of_task(session, newest())});
  }
  if (robot) {
    parameters.emplace_back(*robot);
    columns.push_back({"robot_id", id_of_robot(session, newest())});
  }
  return columns;
}

std::string PairFilter::condition(Session& session, const std::string& table,
                                  std::vector<Parameter>& parameters) const {
  std::string sql;
  for (const Column& column : columns(session, parameters))
    sql += " AND " + table + "." + column.name + " = " + column.id;
  return sql;
}

std::int64_t rows_of_page(std::size_t limit) {
  constexpr std::size_t kMaxRows = 10'000;
  return static_cast<std::int64_t>(std::clamp<std::size_t>(limit, 1, kMaxRows));
}

std::int64_t parse_falling_cursor(std::string_view cursor) {
  return parse_id(cursor, std::numeric_limits<std::int64_t>::max());
}

std::int64_t parse_rising_cursor(std::string_view cursor) { return parse_id(cursor, 0); }

void refuse_cursor(std::string_view cursor) {
  throw Failure(ErrorCode::InvalidInput,
                "cursor '" + std::string(cursor) + "' is not one of this listing");
}

}  // namespace kinship::store
