// 04: Guide a planner of one's own, without OMPL. Any planner that draws configurations has one
// place to change: most of them from the experience, the others uniformly, so that nothing is out
// of reach.
//
//   04_guide_your_own_planner MODELS
#include <iostream>

#include "arms.hpp"

/// Stands for one's own planner: a tree from the start; the hand must stay above the table.
template <typename Sample>
int plan(const kinship::kinematics::Chain& chain, const Eigen::VectorXd& start,
         const Eigen::VectorXd& goal, const Sample& sample) {
  std::vector<Eigen::VectorXd> tree = {start};
  for (int iterations = 1; iterations <= 20'000; ++iterations) {
    const Eigen::VectorXd wanted = iterations % 20 == 0 ? goal : sample();
    const auto nearest = std::ranges::min_element(
        tree, {}, [&](const Eigen::VectorXd& q) { return (q - wanted).squaredNorm(); });
    const double distance = (wanted - *nearest).norm();
    const Eigen::VectorXd q = *nearest + (wanted - *nearest) * std::min(1.0, 0.3 / distance);
    if (kinship::kinematics::T_base_transfer(chain, q).translation().z() > 0.2)
      tree.push_back(q);
    if ((tree.back() - goal).norm() < 1e-3)
      return iterations;
  }
  return 0;
}

int main(int count, char** words) try {
  if (count != 2)
    throw std::runtime_error("usage: 04_guide_your_own_planner MODELS");
  kinship::link::Client client(kinship::link::options_from_environment());
  const kinship::RobotDescription arm = ur10e(words[1]);
  const auto chain = kinship::kinematics::read_chain(arm).value_or_throw();
  const Eigen::VectorXd start{{-0.9, -1.4, 1.9, -2.07, -1.57, 0}},
      goal{{0.9, -1.4, 1.9, -2.07, -1.57, 0}};
  kinship::FetchRequest request;
  request.task = "sweep";
  request.robot = chain.digest();
  request.T_task_base = Eigen::Isometry3d::Identity();
  request.deadline = std::chrono::seconds(60);
  const auto reply = client.fetch(request).value_or_throw();
  const kinship::mixture::DistributionSampler sampler(reply.distribution.value());
  const double share = reply.distribution->advice.recommended_share;

  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> unit(0, 1);
  const int iterations = plan(chain, start, goal, [&]() -> Eigen::VectorXd {
    const auto drawn = unit(generator) < share ? sampler.sample(generator) : std::nullopt;
    const Eigen::ArrayXd anywhere = (Eigen::ArrayXd::Random(6) + 1) / 2;
    return drawn.value_or(chain.lower() +
                          (chain.upper() - chain.lower()).cwiseProduct(anywhere.matrix()));
  });
  std::cout << "solved in " << iterations << " iterations (0: not)\n";
  return iterations > 0 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
