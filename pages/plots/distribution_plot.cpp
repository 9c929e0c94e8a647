#include "pages/plots/distribution_plot.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <numeric>
#include <random>
#include <stdexcept>
#include <utility>

#include "proto/mixture/distribution_sampler.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/turn.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::plots {

namespace {

/// The bin of a value; one rounded beyond an end belongs to the last bin. The middle one for a
/// joint that cannot move.
std::size_t bin_of(double value, const Marginal& marginal) {
  if (marginal.lower == marginal.upper)
    return kMarginalBins / 2;
  const double part = (value - marginal.lower) / (marginal.upper - marginal.lower);
  const double bin = part * static_cast<double>(kMarginalBins);
  return static_cast<std::size_t>(std::clamp(bin, 0.0, static_cast<double>(kMarginalBins - 1)));
}

void require_range(const Marginal& marginal) {
  if (!std::isfinite(marginal.upper - marginal.lower) || marginal.lower > marginal.upper)
    throw Failure(ErrorCode::InvalidInput, "limits of joint '" + marginal.joint + "' are " +
                                               std::to_string(marginal.lower) + " to " +
                                               std::to_string(marginal.upper) +
                                               ", must be finite and the lower one first");
}

}  // namespace

std::vector<Marginal> marginals_of(const Distribution& distribution, const kinematics::Chain& chain,
                                   const Eigen::Ref<const Eigen::MatrixXd>& samples) {
  const Eigen::Index dof = chain.dof();
  if (distribution.limits.cols() != dof || samples.rows() != dof)
    throw std::invalid_argument("marginals_of: " + std::to_string(dof) + " joints, limits of " +
                                std::to_string(distribution.limits.cols()) + ", samples of " +
                                std::to_string(samples.rows()));
  std::vector<Marginal> marginals;
  for (Eigen::Index joint = 0; joint < dof; ++joint) {
    const auto index = static_cast<std::size_t>(joint);
    Marginal marginal;
    marginal.joint = chain.joints()[index].name;
    marginal.is_length = chain.joints()[index].type == kinematics::JointType::Prismatic;
    marginal.lower = distribution.limits(0, joint);
    marginal.upper = distribution.limits(1, joint);
    if (index < distribution.cuts.size() && distribution.cuts[index]) {
      marginal.cut = wrapped(*distribution.cuts[index]);
      marginal.lower = -std::numbers::pi;
      marginal.upper = std::numbers::pi;
    }
    require_range(marginal);
    marginal.counts.resize(kMarginalBins);
    for (const double value : samples.row(joint))
      ++marginal.counts[bin_of(value, marginal)];
    marginals.push_back(std::move(marginal));
  }
  return marginals;
}

namespace {

constexpr std::uint64_t kSeed = 1;
constexpr std::size_t kPostures = 3;

/// The components' indices, heaviest first.
std::vector<Eigen::Index> by_weight(const Mixture& mixture) {
  std::vector<Eigen::Index> order(static_cast<std::size_t>(mixture.size()));
  std::iota(order.begin(), order.end(), 0);
  std::ranges::stable_sort(order, std::greater{},
                           [&](Eigen::Index k) { return mixture.weights()(k); });
  return order;
}

Eigen::MatrixXd draw_samples(const Distribution& distribution, Eigen::Index count) {
  const mixture::DistributionSampler sampler(distribution);
  std::mt19937_64 generator(kSeed);
  Eigen::MatrixXd samples(sampler.dimension(), count);
  for (auto column : samples.colwise()) {
    const auto q = sampler.sample(generator);
    if (!q)
      throw Failure(ErrorCode::NotFound, "nothing to plot: distribution " +
                                             distribution.id.short_hex() +
                                             " lies outside the joint limits");
    column = *q;
  }
  return samples;
}

}  // namespace

std::vector<Component> heaviest_components(const Mixture& mixture) {
  std::vector<Component> components;
  double cumulated = 0;
  for (const Eigen::Index k : by_weight(mixture)) {
    if (components.size() == kMaxComponentsShown)
      break;
    cumulated += mixture.weights()(k);
    components.push_back({mixture.weights()(k), std::min(cumulated, 1.0)});
  }
  return components;
}

Samples samples_of(const Distribution& distribution, const kinematics::Chain& chain,
                   Eigen::Index count) {
  const Eigen::MatrixXd qs = draw_samples(distribution, count);
  Samples samples{Eigen::Matrix3Xd(3, qs.cols()), marginals_of(distribution, chain, qs)};
  const auto T_task_base = distribution.T_task_base.value_or(Eigen::Isometry3d::Identity());
  for (Eigen::Index i = 0; i < qs.cols(); ++i)
    samples.hands.col(i) =
        T_task_base * kinematics::T_base_transfer(chain, qs.col(i)).translation();
  return samples;
}

DistributionPlot plot_of(Distribution distribution, const DrawnRobot& drawn) {
  if (!distribution.mixture)
    throw Failure(ErrorCode::NotFound, "nothing to plot: distribution " +
                                           distribution.id.short_hex() +
                                           " has no mixture: " + distribution.reason);
  DistributionPlot plot;
  const models::LoadedRobot& robot = drawn.robot;
  plot.shapes = drawn.shapes;
  plot.label = robot.description.label;
  if (robot.chain.digest() != distribution.robot)
    throw Failure(ErrorCode::InvalidInput,
                  "robot '" + plot.label + "' is " + robot.chain.digest().short_hex() +
                      ", the distribution is for " + distribution.robot.short_hex());
  const Eigen::Isometry3d T_task_base =
      distribution.T_task_base.value_or(Eigen::Isometry3d::Identity());
  plot.components = heaviest_components(*distribution.mixture);
  plot.samples = samples_of(distribution, robot.chain, kSamplesShown);
  const Mixture& mixture = *distribution.mixture;
  for (const Eigen::Index k : by_weight(mixture)) {
    if (plot.postures.size() == kPostures)
      break;
    const Eigen::VectorXd q = mixture.means().col(k);
    plot.postures.push_back({mixture.weights()(k), page::bones_of(robot, T_task_base, q)});
  }
  plot.distribution = std::move(distribution);
  return plot;
}

}  // namespace kinship::plots
