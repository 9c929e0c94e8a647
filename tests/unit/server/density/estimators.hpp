#pragma once

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "server/density/fit.hpp"
#include "server/density/kernel_density.hpp"

/// The ways from configurations to a mixture, behind one call, for laws that all of them keep.
namespace kinship::density::test {

enum class Way { GivenComponents, ChosenComponents, ChosenPrior, WarmStart, Kernels };

inline constexpr Way kWays[] = {Way::GivenComponents, Way::ChosenComponents, Way::ChosenPrior,
                                Way::WarmStart, Way::Kernels};

inline std::string name_of(Way way) {
  switch (way) {
    case Way::GivenComponents:
      return "GivenComponents";
    case Way::ChosenComponents:
      return "ChosenComponents";
    case Way::ChosenPrior:
      return "ChosenPrior";
    case Way::WarmStart:
      return "WarmStart";
    case Way::Kernels:
      break;
  }
  return "Kernels";
}

/// Configurations with all that any of the ways asks of them.
struct Sample {
  std::string name;
  Eigen::MatrixXd points;  // d x N
  Eigen::VectorXd weights;
  std::vector<std::uint32_t> path_of;
  std::vector<std::uint8_t> is_new;
  std::optional<Mixture> before = {};  // for a warm start

  /// With the columns in another order, or some of them repeated.
  Sample with_columns(const std::vector<Eigen::Index>& columns) const {
    Sample other{name, points(Eigen::all, columns), weights(columns), {}, {}, before};
    for (const Eigen::Index column : columns) {
      other.path_of.push_back(path_of[static_cast<std::size_t>(column)]);
      other.is_new.push_back(is_new[static_cast<std::size_t>(column)]);
    }
    return other;
  }
};

inline constexpr double kFloor = 1e-4;
inline constexpr int kComponents = 6;

/// Twelve paths, one after the other, of which the last three are new since the fit before.
inline Sample sample_of(std::string name, const Eigen::MatrixXd& points,
                        const Eigen::VectorXd& weights) {
  constexpr Eigen::Index kPaths = 12;
  Sample sample{std::move(name), points, weights, {}, {}, {}};
  for (Eigen::Index i = 0; i < points.cols(); ++i) {
    const auto path = static_cast<std::uint32_t>(i * kPaths / points.cols());
    sample.path_of.push_back(path);
    sample.is_new.push_back(path >= 9 ? 1 : 0);
  }
  return sample;
}

inline Sample sample_of(std::string name, const Eigen::MatrixXd& points) {
  return sample_of(std::move(name), points, Eigen::VectorXd::Ones(points.cols()));
}

inline FitOptions fit_options(Way way, const Sample& sample, const Computation& computation) {
  FitOptions options;
  options.components = way == Way::GivenComponents || way == Way::ChosenPrior ? kComponents : 0;
  options.prior = way == Way::ChosenPrior ? kChosenPrior : 0;
  options.covariance_floor = kFloor;
  options.tolerance = 1e-3;  // rounding grows until EM is near its end
  options.computation = computation;
  if (way == Way::ChosenComponents || way == Way::ChosenPrior)
    options.path_of_configuration = sample.path_of;
  if (way == Way::WarmStart && sample.before)
    options.warm_start = {*sample.before, sample.is_new};
  return options;
}

/// \param sample  for a warm start with the mixture before.
inline Result<Mixture> try_estimate(Way way, const Sample& sample, const Computation& computation) {
  if (way == Way::Kernels) {
    KernelDensityOptions options;
    options.floors_of_joints = Eigen::VectorXd::Constant(sample.points.rows(), kFloor);
    options.computation = computation;
    options.path_of_configuration = sample.path_of;
    const auto made = estimate_kernel_density(sample.points, sample.weights, options);
    return made ? Result<Mixture>(made->mixture) : Result<Mixture>(made.error());
  }
  const auto fitted =
      fit_mixture(sample.points, sample.weights, fit_options(way, sample, computation));
  return fitted ? Result<Mixture>(fitted->mixture) : Result<Mixture>(fitted.error());
}

/// The same sample with what a fit of its old configurations finds, if it finds anything.
inline Sample with_fit_before(Sample sample) {
  std::vector<Eigen::Index> old_columns;
  for (std::size_t i = 0; i < sample.is_new.size(); ++i)
    if (sample.is_new[i] == 0)
      old_columns.push_back(static_cast<Eigen::Index>(i));
  const auto before =
      try_estimate(Way::GivenComponents, sample.with_columns(old_columns), Computation{});
  if (before)
    sample.before = *before;
  return sample;
}

}  // namespace kinship::density::test
