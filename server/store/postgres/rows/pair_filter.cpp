#include "server/store/postgres/rows/pair_filter.hpp"

namespace kinship::store::postgres {

std::string PairFilter::condition(const std::string& table, Parameters& parameters) const {
  std::string sql;
  if (robot) {
    parameters.add(Bytes(robot->bytes));
    sql += " AND " + table + ".robot_id = (SELECT id FROM robot WHERE digest = $" +
           std::to_string(parameters.size()) + ")";
  }
  if (!task.empty()) {
    parameters.add(task);
    sql += " AND " + table + ".task_id = (SELECT id FROM task WHERE name = $" +
           std::to_string(parameters.size()) + ")";
  }
  return sql;
}

}  // namespace kinship::store::postgres
