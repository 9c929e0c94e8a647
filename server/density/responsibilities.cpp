#include "server/density/responsibilities.hpp"

namespace kinship::density {

Posterior posterior(const mixture::ComponentDensities& components,
                    const Eigen::Ref<const Eigen::MatrixXd>& configurations) {
  Posterior result;
  result.responsibilities = components.weighted_log_densities(configurations);
  Eigen::MatrixXd& terms = result.responsibilities;
  Eigen::ArrayXd largest = terms.col(0);
  for (Eigen::Index k = 1; k < terms.cols(); ++k)
    largest = largest.max(terms.col(k).array());
  Eigen::ArrayXd sum = Eigen::ArrayXd::Zero(terms.rows());
  for (Eigen::Index k = 0; k < terms.cols(); ++k) {
    terms.col(k) = (terms.col(k).array() - largest).exp();
    sum += terms.col(k).array();
  }
  terms.array().colwise() /= sum;
  result.log_densities = largest + sum.log();
  return result;
}

}  // namespace kinship::density
