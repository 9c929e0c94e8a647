#include "server/transfer/target_robot.hpp"

#include <algorithm>
#include <utility>

#include "server/transfer/arm_shape.hpp"
#include "server/transfer/collision_filter.hpp"

namespace kinship::transfer {

namespace {

collision::LinkPairs checked_links(const collision::RobotSolids& robot) {
  collision::LinkPairs links;
  for (const auto& [a, b] : robot.parts().checked) {
    const int first = robot.parts().bodies[a].link, second = robot.parts().bodies[b].link;
    links.insert({std::min(first, second), std::max(first, second)});
  }
  return links;
}

/// The shapes of these pairs of links, of which no other is checked.
geometry::RobotShapes only(const collision::LinkPairs& pairs, const kinematics::Chain& chain,
                           geometry::RobotShapes shapes) {
  std::erase_if(shapes.shapes, [&](const geometry::LinkShape& shape) {
    return std::ranges::none_of(pairs, [&](const auto& pair) {
      return pair.first == shape.link || pair.second == shape.link;
    });
  });
  shapes.never_colliding.clear();
  const int links = static_cast<int>(chain.links().size());
  for (int first = 0; first < links; ++first)
    for (int second = first + 1; second < links; ++second)
      if (!pairs.contains({first, second}))
        shapes.never_colliding.emplace_back(first, second);
  return shapes;
}

}  // namespace

TargetArm::TargetArm(kinematics::Chain chain)
    : chain_(std::move(chain)), descent_(chain_), solver_(chain_), marks_(shape_marks(chain_)) {}

TargetRobot::TargetRobot(const kinematics::Chain& chain, const geometry::RobotShapes& shapes,
                         const geometry::RobotShapes* covering)
    : arm(std::make_shared<const TargetArm>(chain)), solids(chain, shapes) {
  if (covering == nullptr)
    return;
  covers.emplace(MeshCovers{collision::RobotSolids(chain, *covering), std::nullopt});
  collision::LinkPairs uncovered = checked_links(solids);
  for (const auto& pair : checked_links(covers->solids))
    uncovered.erase(pair);
  if (!uncovered.empty())
    covers->uncovered.emplace(chain, only(uncovered, chain, shapes));
}

ConfigurationFilter self_filter(const TargetRobot& robot) {
  ConfigurationFilter exact = collision_filter(robot.solids);
  if (!robot.covers)
    return exact;
  return covered_filter(
      std::move(exact), collision_filter(robot.covers->solids),
      robot.covers->uncovered ? collision_filter(*robot.covers->uncovered) : ConfigurationFilter());
}

}  // namespace kinship::transfer
