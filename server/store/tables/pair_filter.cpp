#include "server/store/tables/pair_filter.hpp"

namespace kinship::store {

std::vector<PairFilter::Column> PairFilter::columns(std::vector<Parameter>& parameters) const {
  std::vector<Column> columns;
  const auto add = [&](const std::string& name, const std::string& of_parameter) {
    columns.push_back({name, of_parameter + " = $" + std::to_string(parameters.size()) + ")"});
  };
  if (!task.empty()) {
    parameters.emplace_back(task);
    add("task_id", "(SELECT id FROM task WHERE name");
  }
  if (robot) {
    parameters.emplace_back(*robot);
    add("robot_id", "(SELECT id FROM robot WHERE digest");
  }
  return columns;
}

std::string PairFilter::condition(const std::string& table,
                                  std::vector<Parameter>& parameters) const {
  std::string sql;
  for (const Column& column : columns(parameters))
    sql += " AND " + table + "." + column.name + " = " + column.id;
  return sql;
}

}  // namespace kinship::store
