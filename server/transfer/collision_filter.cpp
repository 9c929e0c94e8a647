#include "server/transfer/collision_filter.hpp"

#include <memory>
#include <utility>

namespace kinship::transfer {

ConfigurationFilter collision_filter(const collision::RobotSolids& robot,
                                     const collision::Surroundings& surroundings) {
  if (robot.parts().bodies.empty())
    return {};
  // Copies of the function share the world: it cannot be copied, and it is asked by one at a time.
  const auto world = std::make_shared<collision::CollisionWorld>(robot, surroundings);
  return [world](const Eigen::Ref<const Eigen::MatrixXd>& qs) { return world->free_ahead(qs); };
}

ConfigurationFilter covered_filter(ConfigurationFilter exact, ConfigurationFilter covers,
                                   ConfigurationFilter uncovered) {
  if (!covers || !exact)
    return exact;
  return [exact = std::move(exact), covers = std::move(covers),
          uncovered = std::move(uncovered)](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
    Eigen::Index next = 0;
    while (next < qs.cols()) {
      const Eigen::Index apart = covers(qs.rightCols(qs.cols() - next));
      const Eigen::Index kept =
          uncovered && apart > 0 ? uncovered(qs.middleCols(next, apart)) : apart;
      next += kept;
      if (kept < apart || next == qs.cols() || exact(qs.middleCols(next, 1)) == 0)
        return next;
      ++next;
    }
    return next;
  };
}

}  // namespace kinship::transfer
