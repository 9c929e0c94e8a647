#include "proto/json/search_record_json.hpp"

#include <limits>

#include "proto/json/attempt_json.hpp"
#include "proto/json/fields.hpp"
#include "proto/json/name_pairs_json.hpp"
#include "proto/types/limits.hpp"

namespace kinship::json {
namespace {

constexpr std::size_t kMaxNodes = kMaxSearchBytes / sizeof(float);

OrderedJson tree_object(const SearchTree& tree) {
  OrderedJson object;
  object["configurations"] = list_of_columns(tree.configurations.cast<double>());
  object["parents"] = tree.parents;
  return object;
}

SearchTree read_tree(const Reader& reader) {
  SearchTree tree;
  tree.configurations = reader.at("configurations").columns(kMaxDof, kMaxNodes).cast<float>();
  for (const Reader& parent : reader.at("parents").elements(kMaxNodes)) {
    const std::int64_t index = parent.integer();
    if (index < -1 || index > std::numeric_limits<std::int32_t>::max())
      parent.refuse("must be -1 or an earlier configuration, is " + std::to_string(index));
    tree.parents.push_back(static_cast<std::int32_t>(index));
  }
  return tree;
}

}  // namespace

OrderedJson search_record_object(const SearchRecord& search) {
  OrderedJson object;
  object["start"] = list(search.start);
  object["goals"] = list_of_columns(search.goals);
  object["start_pose"] = pose_or_null(search.T_task_start);
  object["goal_pose"] = pose_or_null(search.T_task_goal);
  object["blockers"] = json_of(search.blockers);
  object["goal_contacts"] = json_of(search.goal_contacts);
  object["last_free"] = list(search.last_free);
  object["trees"] = OrderedJson::array();
  for (const SearchTree& tree : search.trees)
    object["trees"].push_back(tree_object(tree));
  object["allowed_collisions"] = pair_list(search.allowed_collisions);
  object["seed"] = search.seed;
  object["reason"] = search.reason;
  return object;
}

SearchRecord read_search_record(const Reader& reader) {
  SearchRecord search;
  if (const auto start = reader.find("start"))
    search.start = start->vector(kMaxDof);
  if (const auto goals = reader.find("goals"))
    search.goals = goals->columns(kMaxDof, kMaxSearchGoals);
  if (const auto pose = reader.find("start_pose"))
    search.T_task_start = pose->pose();
  if (const auto pose = reader.find("goal_pose"))
    search.T_task_goal = pose->pose();
  if (const auto blockers = reader.find("blockers"))
    search.blockers = read_as<std::vector<Blocker>>(*blockers, {.limit = kMaxBlockers});
  if (const auto contacts = reader.find("goal_contacts"))
    search.goal_contacts =
        read_as<std::vector<GoalContact>>(*contacts, {.limit = kMaxGoalContacts});
  if (const auto last_free = reader.find("last_free"))
    search.last_free = last_free->vector(kMaxDof);
  if (const auto trees = reader.find("trees"))
    for (const Reader& tree : trees->elements(kMaxSearchTrees))
      search.trees.push_back(read_tree(tree));
  if (const auto allowed = reader.find("allowed_collisions"))
    search.allowed_collisions = read_pairs(*allowed);
  if (const auto seed = reader.find("seed"))
    search.seed = seed->count();
  if (const auto reason = reader.find("reason"))
    search.reason = reason->text(kMaxMessageBytes);
  return search;
}

std::string to_json(const SearchRecord& search) { return write(search_record_object(search)); }

Result<SearchRecord> search_record_from_json(std::string_view text) {
  return read_document(text, "search", [](const Reader& reader) {
    SearchRecord search = read_search_record(reader);
    if (const auto error = check_search(search))
      throw Failure(*error);
    return search;
  });
}

}  // namespace kinship::json
