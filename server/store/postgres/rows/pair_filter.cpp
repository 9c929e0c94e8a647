#include "server/store/postgres/rows/pair_filter.hpp"

namespace kinship::store::postgres {

std::vector<PairFilter::Column> PairFilter::columns(Parameters& parameters) const {
  std::vector<Column> columns;
  const auto add = [&](const std::string& name, const std::string& of_parameter) {
    columns.push_back({name, of_parameter + " = $" + std::to_string(parameters.size()) + ")"});
  };
  if (!task.empty()) {
    parameters.add(task);
    add("task_id", "(SELECT id FROM task WHERE name");
  }
  if (robot) {
    parameters.add(Bytes(robot->bytes));
    add("robot_id", "(SELECT id FROM robot WHERE digest");
  }
  return columns;
}

std::string PairFilter::condition(const std::string& table, Parameters& parameters) const {
  std::string sql;
  for (const Column& column : columns(parameters))
    sql += " AND " + table + "." + column.name + " = " + column.id;
  return sql;
}

}  // namespace kinship::store::postgres
