#include "server/store/values/record_columns.hpp"

namespace kinship::store {

std::string record_columns(std::string_view prefix) {
  std::string listed;
  for_each_field<PlanningRecord>([&](const auto& field) {
    listed += listed.empty() ? "" : ", ";
    listed += prefix;
    listed += column_of(field.name);
  });
  return listed + " ";
}

}  // namespace kinship::store
