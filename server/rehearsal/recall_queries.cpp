#include "server/rehearsal/recall_queries.hpp"

#include <optional>
#include <utility>

#include "robots/planning/path_vertices.hpp"

namespace kinship::rehearsal {

namespace {

/// Whether a reported path can be planned again: within the turn of its start, and no longer than
/// plans are.
bool is_usable(const Eigen::MatrixXd& path, const Eigen::Matrix2Xd& bounds) {
  constexpr double kMaxLength = 500;  // joint units
  for (const auto& q : path.colwise())
    if ((q.transpose().array() < bounds.row(0).array()).any() ||
        (q.transpose().array() > bounds.row(1).array()).any())
      return false;
  return planning::path_length(path) <= kMaxLength;
}

}  // namespace

std::vector<recall::PosedQuery> recall_queries(const runtime::Robot& robot,
                                               const Eigen::Isometry3d& T_task_base,
                                               const std::vector<RecordedQuery>& recorded,
                                               const Starts& starts) {
  std::vector<recall::PosedQuery> queries;
  const auto add = [&](const RecordedQuery& query, Branch branch) {
    std::optional<PosedQuery> posed = pose_query(robot, T_task_base, query, starts, branch);
    if (!posed)
      return;
    recall::PosedQuery wanted{query.path,
                              std::nullopt,
                              std::move(posed->surroundings),
                              posed->query.bounds,
                              std::move(posed->query.start),
                              std::move(posed->query.goals),
                              query.scene->constraint};
    if (query.own) {
      if (!is_usable(*query.own, wanted.bounds))
        return;
      wanted.solution = query.own;
    }
    queries.push_back(std::move(wanted));
  };
  const bool are_twice = starts.are_recorded && 2 * recorded.size() <= kMaxRecallQueries;
  for (const RecordedQuery& query : recorded) {
    if (!query.scene)
      continue;
    add(query, Branch::Drawn);
    if (are_twice && !query.own)
      add(query, Branch::Usual);
  }
  return queries;
}

}  // namespace kinship::rehearsal
