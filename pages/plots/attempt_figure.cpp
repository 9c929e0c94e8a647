#include "pages/plots/attempt_figure.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pages/page/json_text.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/recorded_surroundings.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::plots {
namespace {

using collision::CollisionWorld;
using page::json_string;
using page::list;
using page::number;
using page::object;
using NearestPair = std::optional<CollisionWorld::NearestPair>;

/// Part of the length in joint space before each waypoint, 0 to 1; by number if there is no length.
std::vector<double> waypoints_at(const Eigen::MatrixXd& waypoints, double& length) {
  const auto count = static_cast<std::size_t>(waypoints.cols());
  std::vector<double> at(count, 0);
  for (std::size_t i = 1; i < count; ++i) {
    const auto column = static_cast<Eigen::Index>(i);
    at[i] = at[i - 1] + (waypoints.col(column) - waypoints.col(column - 1)).norm();
  }
  length = at.back();
  for (std::size_t i = 0; i < count; ++i)
    at[i] = length > 0 ? at[i] / length : static_cast<double>(i) / static_cast<double>(count - 1);
  return at;
}

Eigen::VectorXd configuration_at(const Eigen::MatrixXd& waypoints, const std::vector<double>& at,
                                 double place) {
  const auto above = std::upper_bound(at.begin() + 1, at.end() - 1, place);
  const auto i = static_cast<Eigen::Index>(above - at.begin());
  const double from = *(above - 1), to = *above;
  const double part = to > from ? (place - from) / (to - from) : 0;
  return waypoints.col(i - 1) + part * (waypoints.col(i) - waypoints.col(i - 1));
}

/// The place of the least distance, if any was measured.
std::optional<std::size_t> least(const std::vector<CollisionWorld::NearestPairs>& nearest,
                                 NearestPair CollisionWorld::NearestPairs::*pair) {
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < nearest.size(); ++i)
    if (const NearestPair& here = nearest[i].*pair;
        here && (!found || here->distance_m < (nearest[*found].*pair)->distance_m))
      found = i;
  return found;
}

constexpr double kSteady_m = 5e-4, kSteadyPart = 0.01;  // the bounds are as close as that
constexpr std::size_t kMostSteady = 8;

/// The pair with an obstacle that is the nearest along all of the path at one distance, if any is.
NearestPair steady_pair(const std::vector<CollisionWorld::NearestPairs>& nearest) {
  NearestPair first = nearest.front().obstacle;
  for (const auto& [obstacle, own] : nearest)
    if (!first || !obstacle || obstacle->first != first->first ||
        obstacle->second != first->second ||
        std::abs(obstacle->distance_m - first->distance_m) >
            kSteady_m + kSteadyPart * first->distance_m)
      return std::nullopt;
  return first;
}

/// Measures all places, again without the pairs that turn out to be steady.
void measure(const std::vector<Eigen::VectorXd>& qs, const collision::RobotSolids& robot,
             collision::Surroundings surroundings, PathPlaces& places) {
  NearestPair steady;
  do {
    CollisionWorld world(robot, surroundings);
    places.nearest.clear();
    for (const Eigen::VectorXd& q : qs)
      places.nearest.push_back(world.find_nearest(q));
    steady = places.steady.size() < kMostSteady ? steady_pair(places.nearest) : std::nullopt;
    if (steady) {
      surroundings.allowed_collisions.emplace_back(steady->first, steady->second);
      places.steady.push_back(*steady);
    }
  } while (steady);
  places.nearest_obstacle = least(places.nearest, &CollisionWorld::NearestPairs::obstacle);
  places.nearest_own = least(places.nearest, &CollisionWorld::NearestPairs::own);
}

PathPlaces places_of(const Eigen::MatrixXd& waypoints, const collision::RobotSolids& robot,
                     const collision::Surroundings& surroundings) {
  PathPlaces places;
  places.waypoints_at = waypoints_at(waypoints, places.length);
  places.hand.resize(3, kPlacesOfPath);
  std::vector<Eigen::VectorXd> qs;
  for (Eigen::Index i = 0; i < kPlacesOfPath; ++i) {
    const double place = static_cast<double>(i) / static_cast<double>(kPlacesOfPath - 1);
    qs.push_back(configuration_at(waypoints, places.waypoints_at, place));
    places.hand.col(i) = surroundings.T_task_base *
                         kinematics::T_base_transfer(robot.parts().chain, qs.back()).translation();
    if (i > 0)
      places.hand_length_m += (places.hand.col(i) - places.hand.col(i - 1)).norm();
  }
  measure(qs, robot, surroundings, places);
  return places;
}

/// \return the origin of the transfer frame at each node of a tree, in the task frame, m.
Eigen::Matrix3Xd hands_of(const SearchTree& tree, const kinematics::Chain& chain,
                          const Eigen::Isometry3d& T_task_base) {
  Eigen::Matrix3Xd hands(3, tree.configurations.cols());
  for (Eigen::Index i = 0; i < hands.cols(); ++i)
    hands.col(i) =
        T_task_base *
        kinematics::T_base_transfer(chain, tree.configurations.col(i).cast<double>()).translation();
  return hands;
}

}  // namespace

AttemptFigure attempt_figure(Attempt attempt, const RobotDescription& description) {
  AttemptFigure figure{std::move(attempt), drawn_robot(description), {}, {}, {}, {}};
  const kinematics::Chain& chain = figure.drawn.robot.chain;
  const Attempt& known = figure.attempt;
  if (chain.digest() != known.robot || (known.path && known.path->dof() != chain.dof()))
    throw Failure(ErrorCode::InvalidInput, "robot '" + description.label + "' is " +
                                               chain.digest().short_hex() + ", the attempt is of " +
                                               known.robot.short_hex());
  const Eigen::Isometry3d T_task_base = known.T_task_base.value_or(Eigen::Isometry3d::Identity());
  const collision::RobotSolids solids(chain, figure.drawn.robot.shapes);
  const collision::RecordedSurroundings recorded =
      collision::recorded_surroundings(solids, known.scene.value_or(RecordedScene{}), T_task_base);
  figure.always_touching = recorded.always_touching;
  if (known.path)
    figure.path = places_of(known.path->waypoints(), solids, recorded.surroundings);
  if (known.search)
    for (const SearchTree& tree : known.search->trees)
      figure.tree_hands.push_back(hands_of(tree, chain, T_task_base));
  return figure;
}

namespace {

std::string json_of(const std::pair<std::string, std::string>& names) {
  return "[" + json_string(names.first) + "," + json_string(names.second) + "]";
}

std::string index_or_null(const std::optional<std::size_t>& index) {
  return index ? std::to_string(*index) : "null";
}

/// One series of distances: {"distance_m", "pairs", "least"}, null where nothing is compared.
std::string series(const PathPlaces& places, NearestPair CollisionWorld::NearestPairs::*pair,
                   const std::optional<std::size_t>& least_place) {
  const auto distance = [&](const CollisionWorld::NearestPairs& nearest) {
    return nearest.*pair ? number((nearest.*pair)->distance_m) : "null";
  };
  const auto names = [&](const CollisionWorld::NearestPairs& nearest) {
    const NearestPair& here = nearest.*pair;
    return here ? json_of(std::pair(here->first, here->second)) : std::string("null");
  };
  return object({{"distance_m", list(places.nearest, distance)},
                 {"pairs", list(places.nearest, names)},
                 {"least", index_or_null(least_place)}});
}

std::string json_of(const PathPlaces& places, const Eigen::MatrixXd& waypoints) {
  return object(
      {{"waypoints",
        list(waypoints.colwise(), [](const auto& q) { return list(Eigen::VectorXd(q), number); })},
       {"waypoints_at", list(places.waypoints_at, number)},
       {"hand", page::millimetres(places.hand)},
       {"obstacle",
        series(places, &CollisionWorld::NearestPairs::obstacle, places.nearest_obstacle)},
       {"own", series(places, &CollisionWorld::NearestPairs::own, places.nearest_own)},
       {"steady", list(places.steady,
                       [](const CollisionWorld::NearestPair& pair) {
                         return object({{"pair", json_of(std::pair(pair.first, pair.second))},
                                        {"distance_m", number(pair.distance_m)}});
                       })},
       {"length", number(places.length)},
       {"hand_length_m", number(places.hand_length_m)}});
}

std::string json_of(const SearchRecord& search, const std::vector<Eigen::Matrix3Xd>& tree_hands) {
  std::vector<std::string> trees;
  for (std::size_t i = 0; i < search.trees.size(); ++i)
    trees.push_back(object({{"hand", page::millimetres(tree_hands[i])},
                            {"parents", list(search.trees[i].parents,
                                             [](int parent) { return std::to_string(parent); })}}));
  const auto contact = [](const GoalContact& each) {
    return object({{"goal", std::to_string(each.goal)},
                   {"first", json_string(each.first)},
                   {"second", json_string(each.second)}});
  };
  const auto blocker = [](const GoalBlocker& each) {
    return object({{"first", json_string(each.blocker.first)},
                   {"second", json_string(each.blocker.second)},
                   {"count", std::to_string(each.blocker.count)},
                   {"goals", std::to_string(each.goals)}});
  };
  return object({{"start", list(search.start, number)},
                 {"goals", list(search.goals.colwise(),
                                [](const auto& q) { return list(Eigen::VectorXd(q), number); })},
                 {"blockers", list(blockers_by_goals(search), blocker)},
                 {"goal_contacts", list(search.goal_contacts, contact)},
                 {"last_free", list(search.last_free, number)},
                 {"trees", list(trees, [](const std::string& tree) { return tree; })},
                 {"reason", json_string(search.reason)}});
}

/// Held objects as solids of the transfer frame.
std::vector<SceneObject> held_solids(const std::optional<RecordedScene>& scene) {
  std::vector<SceneObject> solids;
  if (scene)
    for (const HeldObject& held : scene->held)
      solids.push_back({held.name, held.shape, held.T_transfer_object, held.approximate});
  return solids;
}

std::string record_json(const AttemptFigure& figure) {
  Attempt record = figure.attempt;
  record.path.reset();
  record.scene.reset();
  record.search.reset();
  return json::to_json(record);
}

std::string search_json(const AttemptFigure& figure) {
  return figure.attempt.search ? json_of(*figure.attempt.search, figure.tree_hands) : "null";
}

std::string path_json(const AttemptFigure& figure) {
  return figure.path ? json_of(*figure.path, figure.attempt.path->waypoints()) : "null";
}

}  // namespace

std::string to_json(const AttemptFigure& figure) {
  const std::optional<RecordedScene>& scene = figure.attempt.scene;
  return object({{"attempt", record_json(figure)},
                 {"robot", to_json(figure.drawn)},
                 {"scene", scene ? page::json_of(scene->objects) : "null"},
                 {"held", page::json_of(held_solids(scene))},
                 {"is_constrained", scene && scene->constraint ? "true" : "false"},
                 {"always_touching",
                  list(figure.always_touching, [](const auto& names) { return json_of(names); })},
                 {"search", search_json(figure)},
                 {"path", path_json(figure)},
                 {"others", list(figure.others, [](const AttemptFigure& other) {
                    return object({{"attempt", record_json(other)},
                                   {"search", search_json(other)},
                                   {"path", path_json(other)}});
                  })}});
}

}  // namespace kinship::plots
