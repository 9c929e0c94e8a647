#include "proto/types/search_record.hpp"

#include <algorithm>
#include <array>
#include <cstdio>
#include <functional>
#include <set>
#include <string_view>
#include <tuple>

#include "proto/types/names.hpp"
#include "proto/types/rules.hpp"

namespace kinship {
namespace {

constexpr std::size_t kSearchRecordBytes = 128, kPoseBytes = 56, kBodyPairBytes = 24;

template <typename Pairs>
std::size_t bytes_of_bodies(const Pairs& pairs) {
  std::size_t bytes = kBodyPairBytes * pairs.size();
  for (const auto& pair : pairs)
    bytes += pair.first.size() + pair.second.size();
  return bytes;
}

template <typename Pairs>
void check_bodies(std::string_view what, const Pairs& pairs, std::size_t limit, Rules& rules) {
  rules.at_most(what, pairs.size(), limit);
  const std::string name = std::string(what) + ": a name";
  for (const auto& pair : pairs)
    for (const std::string* body : {&pair.first, &pair.second})
      rules.not_empty(name, *body).text(name, *body, kMaxLinkNameBytes);
}

void check_tree(const SearchTree& tree, Eigen::Index dof, Rules& rules) {
  const auto count = static_cast<std::size_t>(tree.configurations.cols());
  rules
      .that(tree.configurations.rows() == dof || count == 0,
            "search: a tree has another number of joints than the start")
      .that(tree.configurations.allFinite(), "search: a tree has numbers that are not finite")
      .that(tree.parents.size() == count, "search: a tree of " + std::to_string(count) +
                                              " configurations has " +
                                              std::to_string(tree.parents.size()) + " parents");
  for (std::size_t i = 0; i < tree.parents.size(); ++i)
    rules.that(tree.parents[i] >= -1 && tree.parents[i] < static_cast<std::int64_t>(i),
               "search: a tree's parent is neither -1 nor earlier");
}

}  // namespace

Eigen::Index dof_of(const SearchRecord& search) {
  Eigen::Index dof = std::max(search.start.size(), search.last_free.size());
  if (search.goals.cols() > 0)
    dof = std::max(dof, search.goals.rows());
  for (const SearchTree& tree : search.trees)
    if (tree.configurations.cols() > 0)
      dof = std::max(dof, tree.configurations.rows());
  return dof;
}

std::size_t search_bytes(const SearchRecord& search) {
  std::size_t bytes =
      kSearchRecordBytes + search.reason.size() + bytes_of_bodies(search.blockers) +
      bytes_of_bodies(search.goal_contacts) + bytes_of_bodies(search.allowed_collisions) +
      sizeof(double) * static_cast<std::size_t>(search.start.size() + search.goals.size() +
                                                search.last_free.size());
  for (const auto* pose : {&search.T_task_start, &search.T_task_goal})
    bytes += pose->has_value() ? kPoseBytes : 0;
  for (const SearchTree& tree : search.trees)
    bytes += sizeof(float) * static_cast<std::size_t>(tree.configurations.size()) +
             sizeof(std::int32_t) * tree.parents.size();
  return bytes;
}

std::optional<Error> check_search(const SearchRecord& search) {
  Rules rules;
  const Eigen::Index dof = dof_of(search);
  rules.at_most("search: joints", static_cast<std::size_t>(dof), kMaxDof)
      .at_most("search: goals", static_cast<std::size_t>(search.goals.cols()), kMaxSearchGoals)
      .at_most("search: trees", search.trees.size(), kMaxSearchTrees)
      .at_most("search (bytes)", search_bytes(search), kMaxSearchBytes);
  const std::array<std::pair<const char*, Eigen::Index>, 3> parts = {
      {{"start", search.start.size()},
       {"goals", search.goals.cols() > 0 ? search.goals.rows() : 0},
       {"last_free", search.last_free.size()}}};
  for (const auto& [name, joints] : parts)
    rules.that(joints == 0 || joints == dof, std::string("search: ") + name + " has " +
                                                 std::to_string(joints) + " joints, not " +
                                                 std::to_string(dof));
  rules.that(search.start.allFinite() && search.goals.allFinite() && search.last_free.allFinite(),
             "search: a configuration has numbers that are not finite");
  if (search.T_task_start)
    rules.pose("search: start_pose", *search.T_task_start);
  if (search.T_task_goal)
    rules.pose("search: goal_pose", *search.T_task_goal);
  check_bodies("search: blockers", search.blockers, kMaxBlockers, rules);
  check_bodies("search: goal_contacts", search.goal_contacts, kMaxGoalContacts, rules);
  check_bodies("search: allowed_collisions", search.allowed_collisions, kMaxAllowedPairs, rules);
  for (const GoalContact& contact : search.goal_contacts)
    rules.that(contact.goal < search.goals.cols(), "search: goal_contacts: goal " +
                                                       std::to_string(contact.goal) + " of " +
                                                       std::to_string(search.goals.cols()));
  for (const SearchTree& tree : search.trees)
    check_tree(tree, dof, rules);
  rules.text("search: reason", search.reason, kMaxMessageBytes);
  return rules.broken();
}

std::vector<GoalBlocker> blockers_by_goals(const SearchRecord& search) {
  std::vector<GoalBlocker> blockers;
  for (const Blocker& blocker : search.blockers)
    blockers.push_back({blocker, 0});
  std::set<std::tuple<std::uint32_t, std::string, std::string>> counted;
  for (const GoalContact& contact : search.goal_contacts) {
    if (!counted.emplace(contact.goal, contact.first, contact.second).second)
      continue;
    auto known = std::ranges::find_if(blockers, [&](const GoalBlocker& each) {
      return each.blocker.first == contact.first && each.blocker.second == contact.second;
    });
    if (known == blockers.end())
      known = blockers.insert(known, {{contact.first, contact.second, 0}, 0});
    ++known->goals;
  }
  std::ranges::stable_sort(blockers, std::greater(), [](const GoalBlocker& each) {
    return std::pair(each.goals, each.blocker.count);
  });
  return blockers;
}

std::string why_text(const SearchRecord& search) {
  constexpr std::size_t kTold = 3;
  std::string text = search.reason;
  const auto add = [&text](const char* between, const std::string& part) {
    text += (text.empty() ? "" : between) + part;
  };
  const Eigen::VectorXd& free = search.last_free;
  const bool names_them = !text.empty() && free.size() == 0;  // no search was begun
  const std::vector<GoalBlocker> blockers = blockers_by_goals(search);
  const std::size_t told = names_them ? 0 : std::min(kTold, blockers.size());
  for (std::size_t i = 0; i < told; ++i) {
    const auto& [blocker, goals] = blockers[i];
    std::string often =
        goals > 0 ? std::to_string(goals) + " of " + std::to_string(search.goals.cols()) + " goals"
                  : std::string();
    if (blocker.count > 0)
      often += (often.empty() ? "" : ", ") + std::to_string(blocker.count);
    add(i > 0 ? ", " : "; ",
        "'" + blocker.first + "' touches '" + blocker.second + "' (" + often + ")");
  }
  if (free.size() > 0 && search.goals.cols() > 0 && search.goals.rows() == free.size()) {
    std::array<char, 64> distance{};
    std::snprintf(distance.data(), distance.size(), "%.2f from a goal",
                  (search.goals.colwise() - free).colwise().norm().minCoeff());
    add("; ", std::string("last free configuration ") + distance.data());
  }
  return cut_text(text, kMaxWhyBytes);
}

}  // namespace kinship
