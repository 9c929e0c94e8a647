#include "server/transfer/scene_filter.hpp"

#include <utility>

#include "robots/collision/recorded_surroundings.hpp"
#include "server/transfer/collision_filter.hpp"

namespace kinship::transfer {

SceneFilter scene_filter(const collision::RobotSolids& robot, const RecordedScene& scene,
                         const Eigen::Isometry3d& T_task_base,
                         const collision::RobotSolids* covers) {
  SceneFilter filter;
  if (robot.parts().bodies.empty() || (scene.objects.empty() && scene.held.empty()))
    return filter;
  collision::RecordedSurroundings recorded =
      collision::recorded_surroundings(robot, scene, T_task_base);
  recorded.surroundings.checks_links = false;
  filter.always_touching = std::move(recorded.always_touching);
  filter.keep = collision_filter(robot, recorded.surroundings);
  if (covers != nullptr)
    filter.keep = covered_filter(std::move(filter.keep),
                                 collision_filter(*covers, recorded.surroundings), {});
  return filter;
}

}  // namespace kinship::transfer
