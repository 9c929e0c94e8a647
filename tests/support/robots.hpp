#pragma once

#include <Eigen/Core>
#include <random>
#include <string>

#include "robots/kinematics/urdf.hpp"

namespace kinship::test {

/// A robot of robots/models, for example "panda".
/// \throws Failure if it cannot be read.
RobotDescription model_description(const std::string& name);

/// It, parsed.
kinematics::RobotModel robot_model(const std::string& name);

/// Its chain.
kinematics::Chain model_chain(const std::string& name);

/// Uniform within the limits of the chain.
Eigen::VectorXd random_configuration(const kinematics::Chain& chain, std::mt19937_64& generator);

}  // namespace kinship::test
