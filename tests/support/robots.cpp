#include "tests/support/robots.hpp"

#include <filesystem>

#include "robots/models/robot_arguments.hpp"
#include "tests/support/places.hpp"

namespace kinship::test {

RobotDescription model_description(const std::string& name) {
  const auto folder = std::filesystem::path(test::source_dir()) / "robots" / "models" / name;
  return models::read_model_folder(folder).value_or_throw();
}

kinematics::RobotModel robot_model(const std::string& name) {
  return kinematics::read_model(model_description(name)).value_or_throw();
}

kinematics::Chain model_chain(const std::string& name) {
  return kinematics::read_chain(model_description(name)).value_or_throw();
}

Eigen::VectorXd random_configuration(const kinematics::Chain& chain, std::mt19937_64& generator) {
  std::uniform_real_distribution<double> unit(0, 1);
  Eigen::VectorXd q(chain.dof());
  for (Eigen::Index i = 0; i < chain.dof(); ++i)
    q[i] = chain.lower()[i] + unit(generator) * (chain.upper()[i] - chain.lower()[i]);
  return q;
}

}  // namespace kinship::test
