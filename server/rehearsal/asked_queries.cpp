#include "server/rehearsal/asked_queries.hpp"

#include <algorithm>
#include <limits>

namespace kinship::rehearsal {
namespace {

constexpr double kSamePlace_m = 0.02;

/// Places from which others recorded, drawn around that of a robot today.
class DrawnPlaces {
 public:
  DrawnPlaces(const Eigen::Isometry3d& T_task_base, const std::vector<RecordedQuery>& queries)
      : T_task_base_(T_task_base) {
    constexpr std::size_t kOneIn = 4;  // queries have places of their own, if robots move
    std::size_t count = 0;
    double least = std::numeric_limits<double>::infinity();
    std::vector<Eigen::Isometry3d> places;
    for (const RecordedQuery& query : queries) {
      if (query.own)
        continue;
      ++count;
      if (std::ranges::none_of(places, [&](const Eigen::Isometry3d& place) {
            return planning::pose_distance_m(place, query.T_task_base) < kSamePlace_m;
          }))
        places.push_back(query.T_task_base);
      Eigen::Isometry3d level = query.T_task_base;  // robots may be mounted at any height
      level.translation().z() = T_task_base.translation().z();
      const double distance = planning::pose_distance_m(level, T_task_base);
      if (distance < least) {
        least = distance;
        nearest_ = query.T_task_base;
      }
    }
    are_many_ = places.size() > 1 && kOneIn * places.size() >= count;
  }

  bool are_many() const { return are_many_; }

  /// Moved from today's place as this one is from the recorded one nearest to it.
  Eigen::Isometry3d like(const Eigen::Isometry3d& recorded) const {
    Eigen::Isometry3d drawn = T_task_base_;
    drawn.translation() += recorded.translation() - nearest_.translation();
    drawn.linear() = recorded.linear() * nearest_.linear().transpose() * drawn.linear();
    return drawn;
  }

 private:
  const Eigen::Isometry3d T_task_base_;
  Eigen::Isometry3d nearest_ = Eigen::Isometry3d::Identity();
  bool are_many_ = false;
};

}  // namespace

void ask_in_recorded_scenes(const Eigen::Isometry3d& T_task_goal, const runtime::Robot& robot,
                            const Eigen::Isometry3d& T_task_base, const Starts& starts,
                            std::vector<RecordedQuery>& queries) {
  constexpr std::size_t kAsked = 8, kAskedWhereTheyMove = 24;
  constexpr double kSameGoal_m = 0.05;
  const DrawnPlaces places(T_task_base, queries);
  std::vector<std::size_t> impossible, possible;
  bool is_recorded = false;
  for (std::size_t i = 0; i < queries.size(); ++i) {
    const RecordedQuery& query = queries[i];
    const bool is_possible =
        pose_query(robot, T_task_base, query, starts, Branch::Drawn).has_value();
    is_recorded |=
        is_possible && planning::pose_distance_m(query.T_task_goal, T_task_goal) < kSameGoal_m;
    if (!query.own && query.scene)
      (is_possible ? possible : impossible).push_back(i);
  }
  const std::size_t most = places.are_many() ? kAskedWhereTheyMove : kAsked;
  const auto ask = [&](RecordedQuery& query) {
    query.T_task_goal = T_task_goal;
    if (places.are_many())
      query.T_task_drawn_base = places.like(query.T_task_base);
  };
  const std::size_t replaced = std::min(most, impossible.size());
  for (std::size_t i = 0; i < replaced; ++i)
    ask(queries[impossible[i * impossible.size() / replaced]]);
  const std::size_t copied = is_recorded ? 0 : std::min(most - replaced, possible.size());
  for (std::size_t i = 0; i < copied; ++i) {
    queries.push_back(RecordedQuery(queries[possible[i * possible.size() / copied]]));
    ask(queries.back());
  }
}

}  // namespace kinship::rehearsal
