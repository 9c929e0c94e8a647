#include "proto/mixture/cholesky.hpp"

#include <Eigen/Cholesky>
#include <string>

#include "proto/types/failure.hpp"

namespace kinship::mixture {

std::vector<Eigen::MatrixXd> cholesky_factors(const Mixture& mixture) {
  std::vector<Eigen::MatrixXd> factors;
  factors.reserve(mixture.covariances().size());
  for (const Eigen::MatrixXd& covariance : mixture.covariances()) {
    const Eigen::LLT<Eigen::MatrixXd> llt(covariance);
    if (llt.info() != Eigen::Success)
      throw Failure(ErrorCode::Internal, "mixture: covariance of component " +
                                             std::to_string(factors.size()) +
                                             " is not positive definite");
    factors.emplace_back(llt.matrixL());
  }
  return factors;
}

}  // namespace kinship::mixture
