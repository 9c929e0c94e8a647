// 02: Fetch and sample. An arm that has never done a task asks for the fleet's experience, moved
// into its own configuration space, and draws configurations from it.
//
//   02_fetch_and_sample MODELS
#include <iostream>

#include "arms.hpp"

int main(int count, char** words) try {
  if (count != 2) {
    std::cerr << "usage: 02_fetch_and_sample MODELS\n";
    return 2;
  }
  kinship::link::Client client(kinship::link::options_from_environment());
  kinship::FetchRequest request;
  request.task = "sweep";
  request.robot = client.register_robot(ur10e(words[1])).value_or_throw().robot;
  request.T_task_base = Eigen::Isometry3d::Identity();
  request.deadline =
      std::chrono::seconds(60);  // the first one has to be made; later ones are there
  const kinship::FetchReply reply = client.fetch(request).value_or_throw();
  if (reply.status != kinship::FetchStatus::Ready) {
    std::cerr << "no distribution: " << reply.message << '\n';
    return 1;
  }
  const kinship::Distribution& distribution = *reply.distribution;
  std::cout << distribution.mixture->size() << " components from "
            << distribution.sources.at(0).paths << " paths of '" << distribution.sources.at(0).label
            << "'\n";

  const kinship::mixture::DistributionSampler sampler(distribution);
  std::mt19937_64 generator(1);
  const Eigen::MatrixXd drawn = sampler.sample(generator, 1000);  // dof x 1000, within limits
  std::cout << "drawn " << drawn.cols() << ", mean " << drawn.rowwise().mean().transpose() << '\n';
  return drawn.cols() == 1000 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
