// 05: Follow and replan when it improves. A follower always holds the newest distribution and never
// blocks the planner.
//
//   05_follow_and_replan MODELS ROUNDS        ends after so many plans
#include <iostream>

#include "arms.hpp"

int main(int count, char** words) try {
  if (count != 3) {
    std::cerr << "usage: 05_follow_and_replan MODELS ROUNDS\n";
    return 2;
  }
  kinship::link::ClientOptions options = kinship::link::options_from_environment();
  options.has_outbox = false;  // without reports, sending is left to others
  kinship::link::Client client(options);
  kinship::FetchRequest request;
  request.task = "sweep";
  request.robot = client.register_robot(ur10e(words[1])).value_or_throw().robot;
  request.T_task_base = Eigen::Isometry3d::Identity();
  const auto follower = client.follow(request);

  std::shared_ptr<const kinship::Distribution> held;  // null at first: plan uniformly until then
  for (int round = 0; round < std::stoi(words[2]); ++round) {
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(120);
    const auto newer = follower->wait_for_newer(held, deadline);  // newest() does not wait
    if (newer == held) {
      std::cerr << "nothing newer: " << follower->state().reason << '\n';
      return 1;
    }
    held = newer;  // it stays valid as long as it is held, whatever comes
    const kinship::mixture::DistributionSampler sampler(*held);
    std::cout << "revision " << held->revision << " of " << held->sources.at(0).paths
              << " paths: plan anew with samples of " << sampler.dimension() << " joints"
              << std::endl;
  }
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
