#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "client/experiments/studies/instance_random.hpp"
#include "client/planning/is_free.hpp"
#include "proto/types/problem.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/kinematics/chain.hpp"

/// What instances of all tasks have in common, whatever their scene.
namespace kinship::experiments {

inline constexpr double kTimeLimit_s = 86400;  ///< of a query: checks end it, never seconds

/// Tries an instance draw by draw until the robot can do it.
/// \param key       its draw is where to begin.
/// \param complaint  "robot 'x' has no ... in", for the failure.
/// \throws Failure(NotFound) if `try_draw` gives nothing in `draws` draws.
Problem first_possible(InstanceKey key, std::uint32_t draws, const std::string& complaint,
                       const std::string& task,
                       const std::function<std::optional<Problem>(const InstanceKey&)>& try_draw);

/// Start configurations around a nominal one.
class StartDraws {
 public:
  /// \param chain  outlives it.
  StartDraws(const kinematics::Chain& chain, Eigen::VectorXd nominal);

  /// The nominal start with noise in each joint, brought to a pose of the transfer frame. Empty if
  /// none of 20 tries is within the limits and free.
  std::optional<Eigen::VectorXd> draw(const Eigen::Isometry3d& T_base_transfer, Noise& noise,
                                      const planning::IsFree& is_free) const;

 private:
  const kinematics::Chain& chain_;
  const inverse::Descent descent_;
  const Eigen::VectorXd nominal_;
};

/// The links that the last joint moves: a held object may touch them.
std::vector<std::string> last_links(const kinematics::Chain& chain);

}  // namespace kinship::experiments
