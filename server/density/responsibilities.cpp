#include "server/density/responsibilities.hpp"

namespace kinship::density {
namespace {

/// Exponents below it count as it: exp(-300) is nothing beside 1, but no subnormal number, with
/// which the products that follow are 30 times slower on some processors.
constexpr double kLeastExponent = -300;

}  // namespace

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
    terms.col(k) = (terms.col(k).array() - largest).max(kLeastExponent).exp();
    sum += terms.col(k).array();
  }
  terms.array().colwise() /= sum;
  result.log_densities = largest + sum.log();
  return result;
}

}  // namespace kinship::density
