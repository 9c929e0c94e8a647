#include "proto/json/store_check_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/json/writer.hpp"

namespace kinship::json {

std::string to_json(const StoreCheck& check) {
  OrderedJson object;
  object["file"] = check.file;
  object["epoch"] = check.epoch.text();
  object["schema_version"] = check.schema_version;
  object["bytes"] = check.bytes;
  object["tables"] = OrderedJson::array();
  for (const StoreCheck::Table& table : check.tables)
    object["tables"].push_back(
        {{"name", table.name}, {"rows", table.rows}, {"problems", table.problems}});
  object["damaged_paths"] = check.damaged_paths;
  object["retired_paths"] = check.retired_paths;
  object["problems"] = check.problems;
  object["messages"] = check.messages;
  return write(object);
}

}  // namespace kinship::json
