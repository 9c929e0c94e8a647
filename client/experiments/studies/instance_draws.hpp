#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/problem.hpp"
#include "robots/inverse/descent.hpp"
#include "robots/kinematics/chain.hpp"
#include "robots/planning/is_free.hpp"

/// What instances of all tasks have in common, whatever their scene: random numbers, which are
/// equal for several robots or not, starts and goals.
namespace kinship::experiments {

/// One draw of an instance; the next draw is made where a robot cannot start or end the one before.
struct InstanceKey {
  std::uint64_t seed = 0;
  std::uint32_t index = 0;
  std::uint32_t draw = 0;
};

/// Independent random numbers for each use of an instance.
enum class Use : std::uint32_t { Scene, Start, Planner };

std::mt19937_64 generator_for(const InstanceKey& key, Use use);

/// Of Problem::seed; fits a signed integer.
std::uint64_t planner_seed(const InstanceKey& key);

/// "<task>-<seed>-<index>", and ".<draw>" from the second draw on.
std::string instance_name(std::string_view task, const InstanceKey& key);

/// Normal noise, cut at 2.5 standard deviations so that objects do not grow into each other.
class Noise {
 public:
  explicit Noise(std::mt19937_64& generator) : generator_(generator) {}

  double operator()(double deviation);

 private:
  std::mt19937_64& generator_;
  std::normal_distribution<double> normal_;
};

inline constexpr std::uint32_t kTestSeeds = 4;  ///< queries of a test instance
inline constexpr double kTimeLimit_s = 86400;   ///< of a query: checks end it, never seconds

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

/// Which of the goal configurations of a pose a query may get.
struct GoalPose {
  Eigen::Isometry3d T_base_transfer = Eigen::Isometry3d::Identity();
  int max_goals = 0;       ///< PlanSettings::max_goals of the study
  std::uint64_t seed = 0;  ///< of the instance
};

/// Whether planning finds a goal under each of the seeds that queries of an instance have.
bool has_free_goals(const kinematics::Chain& chain, const GoalPose& goal,
                    const Eigen::VectorXd& start, const planning::IsFree& is_free);

/// The free configuration at a pose of the transfer frame that is nearest to the middle of the
/// joints' limits; empty if there is none.
std::optional<Eigen::VectorXd> find_middle_configuration(const kinematics::Chain& chain,
                                                         const Eigen::Isometry3d& T_base_transfer,
                                                         const planning::IsFree& is_free);

/// The links that the last joint moves: a held object may touch them.
std::vector<std::string> last_links(const kinematics::Chain& chain);

}  // namespace kinship::experiments
