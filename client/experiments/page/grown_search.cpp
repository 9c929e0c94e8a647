#include "client/experiments/page/grown_search.hpp"

#include "client/experiments/page/hand_poses.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {

GrownSearch grown(const models::LoadedRobot& robot, const Problem& problem,
                  const RecordedSearch& search) {
  if (search.nodes.cols() > 0 && search.nodes.rows() != robot.chain.dof())
    throw Failure(ErrorCode::InvalidInput, "the search of '" + search.name + "' has " +
                                               std::to_string(search.nodes.rows()) + " joints, " +
                                               robot.description.label + " " +
                                               std::to_string(robot.chain.dof()));
  return {poses_of(robot.chain, problem.T_task_base.value_or(Eigen::Isometry3d::Identity()),
                   search.nodes)
              .positions,
          search.parents, search.path, search.checks};
}

}  // namespace kinship::experiments
