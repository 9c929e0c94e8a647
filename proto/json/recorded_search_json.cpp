#include <nlohmann/json.hpp>

#include "proto/json/parts.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {
namespace {

RecordedSearch read_recorded_search(const Reader& reader) {
  RecordedSearch search;
  search.name = reader.at("name").text(kMaxTaskBytes);
  search.nodes = reader.at("nodes").columns(kMaxDof, kMaxRecordedNodes);
  const auto count = static_cast<std::int64_t>(search.nodes.cols());
  for (const Reader& parent : reader.at("parents").elements(kMaxRecordedNodes)) {
    search.parents.push_back(parent.integer());
    const auto index = static_cast<std::int64_t>(search.parents.size()) - 1;
    if (search.parents.back() < -1 || search.parents.back() >= index)
      parent.refuse("must be -1 or an earlier node, is " + std::to_string(search.parents.back()));
  }
  for (const Reader& checks : reader.at("checks").elements(kMaxRecordedNodes))
    search.checks.push_back(checks.count());
  if (static_cast<std::int64_t>(search.parents.size()) != count ||
      static_cast<std::int64_t>(search.checks.size()) != count)
    reader.refuse("has " + std::to_string(count) + " nodes, " +
                  std::to_string(search.parents.size()) + " parents and " +
                  std::to_string(search.checks.size()) + " checks, must be as many of each");
  for (const Reader& node : reader.at("path").elements(kMaxRecordedNodes)) {
    search.path.push_back(node.integer());
    if (search.path.back() < 0 || search.path.back() >= count)
      node.refuse("must be one of " + std::to_string(count) + " nodes");
  }
  return search;
}

}  // namespace

std::string to_json(const RecordedSearch& search) {
  OrderedJson object;
  object["name"] = search.name;
  object["nodes"] = list_of_columns(search.nodes);
  object["parents"] = search.parents;
  object["checks"] = search.checks;
  object["path"] = search.path;
  return write(kSearchFormat, object);
}

Result<RecordedSearch> recorded_search_from_json(std::string_view text) {
  return read_document(text, "search", kSearchFormat, read_recorded_search);
}

}  // namespace kinship::json
