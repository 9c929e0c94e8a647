#pragma once

#include <Eigen/Geometry>
#include <array>
#include <cstdint>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "robots/geometry/link_shapes.hpp"
#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/recall/library_maker.hpp"
#include "tests/support/robots.hpp"

namespace kinship::recall::test_support {

constexpr double kStep = 0.05;

inline Uuid report_of(std::uint64_t number) {
  Uuid uuid{};
  uuid.bytes[0] = 1;
  uuid.bytes[15] = static_cast<std::uint8_t>(number);
  return uuid;
}

/// A Panda at the task frame that reaches into a shelf, which stands elsewhere for each seed.
class ShelfCell {
 public:
  kinematics::Chain chain = test::model_chain("panda");
  collision::RobotSolids solids{chain,
                                geometry::read_shapes(test::robot_model("panda")).value_or_throw()};
  Eigen::VectorXd start{{0, -0.785, 0, -2.356, 0, 1.571, 0.785}};

  static Eigen::Isometry3d T_task_shelf(std::uint64_t seed) {
    std::mt19937_64 generator(seed);
    std::uniform_real_distribution<double> unit(-1, 1);
    const double x = unit(generator), y = unit(generator), yaw = unit(generator);
    return Eigen::Isometry3d(Eigen::Translation3d(0.58 + 0.04 * x, 0.1 * y, 0.35) *
                             Eigen::AngleAxisd(0.15 * yaw, Eigen::Vector3d::UnitZ()));
  }

  /// Two boards, two sides and a back.
  static collision::Surroundings shelf(const Eigen::Isometry3d& T_task_shelf) {
    struct Board {
      const char* name;
      std::array<double, 3> middle, size;
    };
    constexpr std::array<Board, 5> kBoards = {{{"bottom", {0.15, 0, 0}, {0.3, 0.6, 0.02}},
                                               {"top", {0.15, 0, 0.36}, {0.3, 0.6, 0.02}},
                                               {"left", {0.15, 0.3, 0.18}, {0.3, 0.02, 0.36}},
                                               {"right", {0.15, -0.3, 0.18}, {0.3, 0.02, 0.36}},
                                               {"back", {0.3, 0, 0.18}, {0.02, 0.6, 0.36}}}};
    collision::Surroundings surroundings;
    for (const auto& [name, middle, size] : kBoards)
      surroundings.scene.objects.push_back(
          {name, BoxShape{{size[0], size[1], size[2]}},
           T_task_shelf * Eigen::Translation3d(middle[0], middle[1], middle[2])});
    return surroundings;
  }

  /// Of the hand, which points into the shelf.
  static Eigen::Isometry3d T_task_goal(std::uint64_t seed) {
    std::mt19937_64 generator(seed + 1000);
    std::uniform_real_distribution<double> unit(-1, 1);
    const double x = unit(generator), y = unit(generator), z = unit(generator);
    return T_task_shelf(seed) * Eigen::Translation3d(0.1 + 0.03 * x, 0.12 * y, 0.17 + 0.03 * z) *
           Eigen::AngleAxisd(std::numbers::pi / 2, Eigen::Vector3d::UnitY());
  }

  /// \return without goals if the random cell leaves no free one.
  PosedQuery query(std::uint64_t seed) const {
    PosedQuery posed;
    posed.report = report_of(seed);
    posed.surroundings = shelf(T_task_shelf(seed));
    posed.start = start;
    posed.bounds = planning::planning_bounds(chain, start);
    collision::CollisionWorld world(solids, posed.surroundings);
    posed.goals = planning::goal_configurations(chain, T_task_goal(seed), posed.bounds,
                                                planning::free_in(world))
                      .configurations;
    return posed;
  }

  /// Those of so many seeds that have a goal.
  std::vector<PosedQuery> queries(std::uint64_t first, std::uint64_t count) const {
    std::vector<PosedQuery> found;
    for (std::uint64_t seed = first; seed < first + count; ++seed)
      if (PosedQuery posed = query(seed); posed.goals.cols() > 0)
        found.push_back(std::move(posed));
    return found;
  }

  std::optional<RecallLibrary> make(std::vector<PosedQuery> recorded,
                                    LibraryMakerOptions options = {}) const {
    options.step = kStep;
    LibraryMaker maker(chain, solids, std::move(recorded), std::move(options));
    while (maker.step()) {
    }
    return maker.take();
  }
};

/// The cell, queries of it, and the library made of them.
struct MadeShelf {
  ShelfCell cell;
  std::vector<PosedQuery> recorded = cell.queries(0, 6);
  RecallLibrary library = made();

 private:
  RecallLibrary made() const {
    RecallLibrary library = cell.make(recorded).value();
    library.try_checks = 20;  // as measured without sanitizers, with which no try is worth its time
    return library;
  }
};

/// Made once, as that takes a second or two.
inline const MadeShelf& made_shelf() {
  static const MadeShelf made;
  return made;
}

/// How a recorded query is asked. \param is_pose  for any configuration at its goal.
inline Query asked(const ShelfCell& cell, const RecallLibrary& library, const PosedQuery& posed,
                   bool is_pose) {
  Query query;
  query.T_task_base = posed.surroundings.T_task_base;
  query.bounds = posed.bounds;
  query.start = posed.start;
  if (is_pose)
    query.T_base_goal = kinematics::T_base_transfer(cell.chain, posed.goals.col(0));
  else
    query.goals = posed.goals;
  query.T_task_anchors = find_anchors(library.anchors, posed.surroundings.scene.objects);
  return query;
}

}  // namespace kinship::recall::test_support
