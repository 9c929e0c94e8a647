#include "robots/kinematics/jacobian.hpp"

#include <gtest/gtest.h>

#include "robots/kinematics/forward_kinematics.hpp"
#include "tests/unit/robots/kinematics/random_chains.hpp"

namespace kinship::kinematics::jacobian_test {
namespace {

constexpr std::uint64_t kSeed = 9;

/// Central differences of forward kinematics.
Jacobian difference_quotient(const Chain& chain, const Eigen::VectorXd& q) {
  constexpr double kStep = 1e-6;
  Jacobian J(6, chain.dof());
  for (Eigen::Index i = 0; i < chain.dof(); ++i) {
    const Eigen::VectorXd step = kStep * Eigen::VectorXd::Unit(chain.dof(), i);
    const Eigen::Isometry3d before = T_base_tip(chain, q - step);
    const Eigen::Isometry3d after = T_base_tip(chain, q + step);
    const Eigen::AngleAxisd turn(after.linear() * before.linear().transpose());
    J.col(i).head<3>() = (after.translation() - before.translation()) / (2 * kStep);
    J.col(i).tail<3>() = turn.angle() * turn.axis() / (2 * kStep);
  }
  return J;
}

TEST(Jacobian, AgreesWithDifferenceQuotients) {
  std::mt19937_64 generator(kSeed);
  for (int i = 0; i < 200; ++i) {
    const Chain chain(random_parts(1 + i % 9, generator));
    const Eigen::VectorXd q = random_configuration(chain, generator);
    const Jacobian error = J_base_tip(chain, q) - difference_quotient(chain, q);
    EXPECT_LT(error.cwiseAbs().maxCoeff(), 1e-7) << "chain " << i;
  }
}

TEST(Jacobian, RefusesAConfigurationOfAnotherSize) {
  std::mt19937_64 generator(kSeed);
  const Chain chain(random_parts(3, generator));
  EXPECT_THROW(J_base_tip(chain, Eigen::VectorXd::Zero(2)), std::invalid_argument);
}

}  // namespace
}  // namespace kinship::kinematics::jacobian_test
