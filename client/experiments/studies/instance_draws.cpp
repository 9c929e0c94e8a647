#include "client/experiments/studies/instance_draws.hpp"

#include <algorithm>
#include <cstdio>
#include <utility>

#include "proto/types/failure.hpp"
#include "robots/inverse/inverse.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::experiments {

std::mt19937_64 generator_for(const InstanceKey& key, Use use) {
  constexpr unsigned kHalf = 32;
  std::seed_seq sequence{static_cast<std::uint32_t>(key.seed),
                         static_cast<std::uint32_t>(key.seed >> kHalf), key.index, key.draw,
                         static_cast<std::uint32_t>(use)};
  return std::mt19937_64(sequence);
}

std::uint64_t planner_seed(const InstanceKey& key) {
  return generator_for(key, Use::Planner)() >> 1U;
}

std::string instance_name(std::string_view task, const InstanceKey& key) {
  char number[16];
  std::snprintf(number, sizeof number, "%04u", key.index);
  std::string name = std::string(task) + "-" + std::to_string(key.seed) + "-" + number;
  if (key.draw > 0)
    name += "." + std::to_string(key.draw);
  return name;
}

double Noise::operator()(double deviation) {
  constexpr double kCut = 2.5;
  return deviation * std::clamp(normal_(generator_), -kCut, kCut);
}

Problem first_possible(InstanceKey key, std::uint32_t draws, const std::string& complaint,
                       const std::string& task,
                       const std::function<std::optional<Problem>(const InstanceKey&)>& try_draw) {
  const InstanceKey first = key;
  for (; key.draw < first.draw + draws; ++key.draw)
    if (std::optional<Problem> problem = try_draw(key))
      return *std::move(problem);
  throw Failure(ErrorCode::NotFound, complaint + " " + std::to_string(draws) + " draws of " +
                                         instance_name(task, first));
}

StartDraws::StartDraws(const kinematics::Chain& chain, Eigen::VectorXd nominal)
    : chain_(chain), descent_(chain), nominal_(std::move(nominal)) {}

std::optional<Eigen::VectorXd> StartDraws::draw(const Eigen::Isometry3d& T_base_transfer,
                                                Noise& noise,
                                                const planning::IsFree& is_free) const {
  constexpr int kTries = 20, kIterations = 100;
  constexpr double kJointNoise_rad = 0.1;
  constexpr double kReached = 1e-6;  // m and rad
  for (int i = 0; i < kTries; ++i) {
    inverse::JointVector q = nominal_;
    for (double& angle : q)
      angle += noise(kJointNoise_rad);
    const double error =
        descent_.run(T_base_transfer, inverse::Descent::Limits::Steer, kIterations, q);
    if (error <= kReached * kReached && chain_.within_limits(q) && is_free(q))
      return q;
  }
  return std::nullopt;
}

bool has_free_goals(const kinematics::Chain& chain, const GoalPose& goal,
                    const Eigen::VectorXd& start, const planning::IsFree& is_free) {
  const Eigen::Matrix2Xd bounds = planning::planning_bounds(chain, start);
  planning::GoalOptions options;
  options.max_configurations = goal.max_goals;
  for (std::uint32_t seed = 0; seed < kTestSeeds; ++seed) {
    options.seed = goal.seed + seed;
    const planning::GoalConfigurations found =
        planning::goal_configurations(chain, goal.T_base_transfer, bounds, is_free, options);
    if (found.configurations.cols() == 0)
      return false;
  }
  return true;
}

std::optional<Eigen::VectorXd> find_middle_configuration(const kinematics::Chain& chain,
                                                         const Eigen::Isometry3d& T_base_transfer,
                                                         const planning::IsFree& is_free) {
  const auto off_middle = [&](const Eigen::VectorXd& q) {
    const auto lower = chain.lower().array(), upper = chain.upper().array();
    return ((q.array() - (lower + upper) / 2) / (upper - lower)).matrix().norm();
  };
  inverse::InverseOptions options;
  options.max_solutions = 0;  // all
  const Eigen::Isometry3d T_base_tip = T_base_transfer * chain.T_tip_transfer().inverse();
  const inverse::InverseSolutions found = inverse::inverse(chain, T_base_tip, options);
  std::optional<Eigen::VectorXd> best;
  for (const auto& q : found.configurations.colwise())
    if ((!best || off_middle(q) < off_middle(*best)) && is_free(q))
      best = q;
  return best;
}

std::vector<std::string> last_links(const kinematics::Chain& chain) {
  std::vector<std::string> names;
  for (const kinematics::ChainLink& link : chain.links())
    if (link.joint == chain.dof() - 1)
      names.push_back(link.name);
  return names;
}

}  // namespace kinship::experiments
