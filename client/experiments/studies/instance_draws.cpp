#include "client/experiments/studies/instance_draws.hpp"

#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::experiments {

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

std::vector<std::string> last_links(const kinematics::Chain& chain) {
  std::vector<std::string> names;
  for (const kinematics::ChainLink& link : chain.links())
    if (link.joint == chain.dof() - 1)
      names.push_back(link.name);
  return names;
}

}  // namespace kinship::experiments
