#include "server/density/distinct_points.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "proto/types/stopped.hpp"

namespace kinship::density {
namespace {

/// Of an average weight. No sum shows that a weight is so much and not less, and none that is
/// divided by it overflows.
constexpr double kMinWeight = 1e-100;

/// A column and its first joint: enough to order almost all of them without looking further away.
struct Candidate {
  double first = 0;
  std::uint32_t column = 0;
};

}  // namespace

DistinctPoints distinct_points(const Eigen::Ref<const Eigen::MatrixXd>& configurations,
                               const Eigen::Ref<const Eigen::VectorXd>& weights,
                               const std::vector<std::uint8_t>& wanted,
                               const std::stop_token& stop) {
  std::vector<Candidate> order;
  order.reserve(static_cast<std::size_t>(weights.size()));
  for (Eigen::Index i = 0; i < weights.size(); ++i)
    if (weights[i] > 0 && (wanted.empty() || wanted[static_cast<std::size_t>(i)] != 0))
      order.push_back({configurations(0, i), static_cast<std::uint32_t>(i)});
  std::uint32_t compared = 0;
  const auto less = [&](const Candidate& a, const Candidate& b) {
    constexpr std::uint32_t kSome = 1U << 16U;  // about a millisecond
    if (++compared % kSome == 0)
      throw_if_stopped(stop);
    if (a.first != b.first)
      return a.first < b.first;
    for (Eigen::Index joint = 1; joint < configurations.rows(); ++joint)
      if (configurations(joint, a.column) != configurations(joint, b.column))
        return configurations(joint, a.column) < configurations(joint, b.column);
    return weights[a.column] < weights[b.column];  // so that the sum of equal ones has one order
  };
  std::sort(order.begin(), order.end(), less);

  DistinctPoints distinct;
  if (order.empty())
    return distinct;
  double largest = 0;
  for (const Candidate& candidate : order)
    largest = std::max(largest, weights[candidate.column]);
  const int exponent = std::ilogb(largest);  // a power of two costs no digit
  const auto weight_of = [&](const Candidate& candidate) {
    return std::scalbn(weights[candidate.column], -exponent);
  };
  distinct.columns.reserve(order.size());
  distinct.weights.reserve(order.size());
  const Candidate* previous = nullptr;  // the last distinct one
  for (const Candidate& candidate : order) {
    if (previous != nullptr && previous->first == candidate.first &&
        configurations.col(previous->column) == configurations.col(candidate.column)) {
      distinct.weights.back() += weight_of(candidate);
      continue;
    }
    previous = &candidate;
    distinct.columns.push_back(candidate.column);
    distinct.weights.push_back(weight_of(candidate));
  }
  const double total = std::accumulate(distinct.weights.begin(), distinct.weights.end(), 0.0);
  for (double& weight : distinct.weights)
    weight = std::max(weight * (static_cast<double>(distinct.weights.size()) / total), kMinWeight);
  return distinct;
}

}  // namespace kinship::density
