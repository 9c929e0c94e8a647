#include "server/density/fit_input.hpp"

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace kinship::density {

Result<DistinctPoints> usable_points(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                                     const Eigen::Ref<const Eigen::VectorXd>& weights,
                                     std::string_view who, const std::stop_token& stop) {
  const auto refusal = [who](const std::string& why) {
    return Error{ErrorCode::InvalidInput, std::string(who) + ": " + why};
  };
  for (Eigen::Index i = 0; i < configurations.cols(); ++i) {
    if (!(configurations.col(i).cwiseAbs().array() <= kLargestValue).all())
      return refusal("configuration " + std::to_string(i) + " is not finite or exceeds " +
                     std::to_string(kLargestValue));
    if (!(weights[i] >= 0) || !std::isfinite(weights[i]))
      return refusal("weight " + std::to_string(i) + " is " + std::to_string(weights[i]) +
                     ", must be finite and at least 0");
  }
  if (!(weights.sum() > 0) || !std::isfinite(weights.sum()))
    return refusal("weights have sum " + std::to_string(weights.sum()) +
                   ", must be positive and finite");
  DistinctPoints points = distinct_points(configurations, weights, {}, stop);
  const auto count = static_cast<Eigen::Index>(points.columns.size());
  const Eigen::Index least = configurations.rows() + 1;
  if (count < least)
    return refusal(std::to_string(count) + " distinct configurations, need at least " +
                   std::to_string(least) + " for " + std::to_string(configurations.rows()) +
                   " joints");
  return points;
}

Error too_flat(const Failure& failure, const Eigen::VectorXd& floors, std::string_view who) {
  std::ostringstream text;
  text << who << ": " << failure.what() << "; covariance_floor " << floors.minCoeff()
       << " is too small for this data";
  return {ErrorCode::InvalidInput, text.str()};
}

void check_sizes(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                 const Eigen::Ref<const Eigen::VectorXd>& weights, const Eigen::Matrix2Xd& limits,
                 std::string_view who) {
  if (configurations.rows() < 1 || configurations.cols() != weights.size())
    throw std::invalid_argument(std::string(who) +
                                ": need a joint, and one weight per configuration");
  if (limits.size() == 0)
    return;
  if (limits.cols() != configurations.rows() || !limits.allFinite() ||
      (limits.row(0).array() > limits.row(1).array()).any())
    throw std::invalid_argument(std::string(who) +
                                ": need finite limits of each joint, the lower ones first");
}

bool are_paths_of(const std::vector<std::uint32_t>& path_of_configuration,
                  Eigen::Index configurations) {
  if (path_of_configuration.size() != static_cast<std::size_t>(configurations))
    return false;
  std::vector<bool> is_there(path_of_configuration.size(), false);
  std::size_t paths = 0;
  for (const std::uint32_t path : path_of_configuration) {
    if (path >= is_there.size())
      return false;
    is_there[path] = true;
    paths = std::max(paths, std::size_t{path} + 1);
  }
  return std::find(is_there.begin(), is_there.begin() + static_cast<std::ptrdiff_t>(paths),
                   false) == is_there.begin() + static_cast<std::ptrdiff_t>(paths);
}

std::uint32_t WeightedConfigurations::paths() const {
  return 1 + *std::max_element(path_of_configuration_.begin(), path_of_configuration_.end());
}

BlockPoints WeightedConfigurations::blocks_of(DistinctPoints distinct) const {
  const Eigen::VectorXd mean = mean_of(configurations_, distinct);
  return {configurations_, std::move(distinct), mean, stop_};
}

std::optional<WeightedConfigurations::Split> WeightedConfigurations::split(
    const std::vector<std::uint8_t>& held_out) const {
  Split split{part(held_out, false), part(held_out, true)};
  const auto least = static_cast<std::size_t>(configurations_.rows() + 1);
  if (split.training.columns.size() < least || split.held_out.columns.empty())
    return std::nullopt;
  return split;
}

DistinctPoints WeightedConfigurations::part(const std::vector<std::uint8_t>& held_out,
                                            bool of_held_out) const {
  std::vector<std::uint8_t> wanted;
  wanted.reserve(path_of_configuration_.size());
  for (const std::uint32_t path : path_of_configuration_)
    wanted.push_back((held_out[path] != 0) == of_held_out ? 1 : 0);
  return distinct_points(configurations_, weights_, wanted, stop_);
}

double log_uniform(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                   const Eigen::Matrix2Xd& limits) {
  constexpr double kMinWidth = 1e-6;  // of a joint that does not move
  Eigen::Matrix2Xd box = limits;
  if (box.size() == 0) {
    box.resize(2, configurations.rows());
    box.row(0) = configurations.rowwise().minCoeff().transpose();
    box.row(1) = configurations.rowwise().maxCoeff().transpose();
  }
  const Eigen::ArrayXd widths = (box.row(1) - box.row(0)).transpose().array();
  return -widths.max(kMinWidth).log().sum();
}

}  // namespace kinship::density
