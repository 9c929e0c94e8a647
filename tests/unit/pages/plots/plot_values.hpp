#pragma once

#include <Eigen/Core>
#include <string>

#include "proto/types/distribution.hpp"
#include "robots/kinematics/chain.hpp"
#include "tests/support/robots.hpp"

/// Distributions of known robots.
namespace kinship::plots::test {

/// Two components of a model, the second one heavier.
inline Distribution distribution_for(const std::string& model) {
  const kinematics::Chain chain = kinship::test::model_chain(model);
  Distribution distribution;
  distribution.id = Digest{{0xAB}};
  distribution.revision = 3;
  distribution.task = "box_to_shelf";
  distribution.robot = chain.digest();
  distribution.profile = "default";
  distribution.configurations = 12'345;
  distribution.limits.resize(2, chain.dof());
  distribution.limits << chain.lower().transpose(), chain.upper().transpose();
  const Eigen::VectorXd middle = 0.5 * (chain.lower() + chain.upper());
  Eigen::MatrixXd means(chain.dof(), 2);
  means << middle, middle.array() + 0.3;
  const Eigen::MatrixXd covariance = 0.01 * Eigen::MatrixXd::Identity(chain.dof(), chain.dof());
  distribution.mixture = Mixture(Eigen::Vector2d(0.25, 0.75), means, {covariance, covariance});
  distribution.component_scores = {{5, -2.0}, {2, -1.5}, {1, -3.0}};
  distribution.sources.emplace_back();
  distribution.sources.back().label = "</script><b>";
  return distribution;
}

}  // namespace kinship::plots::test
