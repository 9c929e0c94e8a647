#include "client/guided/search_notes.hpp"

#include <algorithm>
#include <functional>
#include <limits>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::guided {
namespace {

using NamePair = std::pair<std::string, std::string>;

/// Counted by pair, the most frequent first.
std::vector<Blocker> blockers_of(const Eigen::Ref<const Eigen::MatrixXd>& refused,
                                 const FindNear& find_near) {
  std::map<NamePair, std::uint64_t> counts;
  for (const auto& q : refused.colwise()) {
    std::set<NamePair> pairs;
    for (const collision::NearPair& near : find_near(q))
      pairs.emplace(near.first, near.second);
    for (const NamePair& pair : pairs)
      ++counts[pair];
  }
  std::vector<Blocker> blockers;
  for (const auto& [pair, count] : counts)
    blockers.push_back({pair.first, pair.second, count});
  std::ranges::stable_sort(blockers, std::greater(), &Blocker::count);
  blockers.resize(std::min(blockers.size(), kMaxBlockers));
  return blockers;
}

std::vector<GoalContact> goal_contacts_of(const Eigen::MatrixXd& goals, const FindNear& find_near) {
  std::vector<GoalContact> contacts;
  for (Eigen::Index i = 0; i < goals.cols(); ++i)
    for (const collision::NearPair& near : find_near(goals.col(i)))
      if (contacts.size() < kMaxGoalContacts)
        contacts.push_back({static_cast<std::uint32_t>(i), near.first, near.second});
  return contacts;
}

/// Of the nodes from the start the nearest to a root of the goal tree; empty without trees.
Eigen::VectorXd last_free_of(const planning::TreePair& trees) {
  Eigen::VectorXd nearest;
  double least = std::numeric_limits<double>::infinity();
  for (Eigen::Index goal = 0; goal < trees.goal.size() && trees.goal.parent(goal) < 0; ++goal)
    for (Eigen::Index node = 0; node < trees.start.size(); ++node) {
      const double distance = (trees.start.node(node) - trees.goal.node(goal)).squaredNorm();
      if (distance < least) {
        least = distance;
        nearest = trees.start.node(node);
      }
    }
  return nearest;
}

/// The first nodes of a tree, as far as `bytes` go: parents come before their children.
SearchTree first_of(const planning::Tree& tree, Eigen::Index dof, std::size_t bytes) {
  const std::size_t of_node = sizeof(float) * static_cast<std::size_t>(dof + 1);
  const Eigen::Index count = std::min(tree.size(), static_cast<Eigen::Index>(bytes / of_node));
  SearchTree first;
  first.configurations.resize(dof, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    first.configurations.col(i) = tree.node(i).cast<float>();
    first.parents.push_back(static_cast<std::int32_t>(tree.parent(i)));
  }
  return first;
}

/// Pairs that may touch and that a recorded scene leaves out, as they name a link.
std::vector<NamePair> pairs_of_links(const Problem& problem) {
  std::set<std::string_view> names;
  for (const SceneObject& object : problem.scene.objects)
    names.insert(object.name);
  for (const SceneMesh& object : problem.scene.meshes)
    names.insert(object.name);
  for (const SceneCloud& object : problem.scene.clouds)
    names.insert(object.name);
  std::vector<NamePair> pairs;
  for (const AttachedObject& attached : problem.attached) {
    names.insert(attached.name);
    pairs.emplace_back(attached.link, attached.name);
    for (const std::string& link : attached.touch_links)
      pairs.emplace_back(link, attached.name);
  }
  for (const NamePair& pair : problem.allowed_collisions)
    if (!names.contains(pair.first) || !names.contains(pair.second))
      pairs.push_back(pair);
  pairs.resize(std::min(pairs.size(), kMaxAllowedPairs));
  return pairs;
}

}  // namespace

SearchNotes::SearchNotes(RecordSearch wanted, Eigen::Index dof)
    : wanted_(wanted), refused_(dof, wanted == RecordSearch::Never ? 0 : kKept), trees_(dof) {}

planning::IsFree SearchNotes::watched(const planning::IsFree& is_free) {
  using Columns = Eigen::Ref<const Eigen::MatrixXd>;
  const planning::IsFree* const asked = &is_free;
  return {[this, asked](const Eigen::VectorXd& q) {
            const bool free = (*asked)(q);
            if (!free)
              note(q);
            return free;
          },
          [this, asked](const Columns& qs) {
            const Eigen::Index free = asked->ahead(qs);
            if (free < qs.cols())
              note(qs.col(free));
            return free;
          },
          [this, asked](const Columns& qs) {
            const Eigen::Index blocked = asked->blocked_ahead(qs);
            if (blocked > 0)
              note(qs.col(0));
            return blocked;
          },
          is_free.proves_edges()
              ? planning::IsFree::Edges([asked](const Columns& from, const Columns& to) {
                  return asked->edges(from, to);
                })
              : planning::IsFree::Edges(),
          [this, asked](const Columns& qs) {
            const bool free = asked->all(qs);
            if (!free)  // one of them, in turn: it may be free, and is then left out afterwards
              note(qs.col(static_cast<Eigen::Index>(refusals_) % qs.cols()));
            return free;
          }};
}

void SearchNotes::note(const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (refusals_++ % stride_ != 0)
    return;
  if (kept_ == refused_.cols()) {  // every other one goes, and later ones are noted half as often
    kept_ /= 2;
    for (Eigen::Index i = 0; i < kept_; ++i)
      refused_.col(i) = refused_.col(2 * i);
    stride_ *= 2;
  }
  refused_.col(kept_++) = q;
}

bool SearchNotes::has_record(bool is_solved, double processor_time_s,
                             double slow_time_s) const noexcept {
  switch (wanted_) {
    case RecordSearch::Never:
      return false;
    case RecordSearch::Failed:
      return !is_solved;
    case RecordSearch::Slow:
      return !is_solved || processor_time_s > slow_time_s;
    case RecordSearch::All:
      return true;
  }
  return false;
}

std::optional<SearchRecord> SearchNotes::record(const Problem& problem,
                                                const Eigen::VectorXd& start,
                                                const Eigen::MatrixXd& goals,
                                                const std::string& reason,
                                                const FindNear& find_near) const {
  SearchRecord search;
  search.start = start;
  search.goals = goals.leftCols(std::min(goals.cols(), static_cast<Eigen::Index>(kMaxSearchGoals)));
  search.T_task_start = problem.T_task_start;
  search.T_task_goal = problem.T_task_goal;
  search.blockers = blockers_of(refused_.leftCols(kept_), find_near);
  search.goal_contacts = goal_contacts_of(search.goals, find_near);
  search.last_free = last_free_of(trees_);
  search.allowed_collisions = pairs_of_links(problem);
  search.seed = problem.seed;
  search.reason = cut_text(reason, kMaxMessageBytes);
  const std::size_t bytes = search_bytes(search);
  if (wanted_ != RecordSearch::Failed && bytes < kMaxSearchBytes)
    for (const planning::Tree* tree : {&trees_.start, &trees_.goal})
      if (tree->size() > 0)
        search.trees.push_back(first_of(*tree, refused_.rows(), (kMaxSearchBytes - bytes) / 2));
  if (check_search(search))
    return std::nullopt;
  return search;
}

}  // namespace kinship::guided
