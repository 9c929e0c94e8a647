#include "robots/planning/boxed_nodes.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <utility>

#include "robots/planning/fastest_scan.hpp"

namespace kinship::planning {
namespace {

constexpr std::size_t kMostInABox = 64;
constexpr float kFarAway = std::numeric_limits<float>::infinity();

Eigen::Index signed_of(std::size_t value) { return static_cast<Eigen::Index>(value); }

}  // namespace

BoxedNodes::BoxedNodes(const Eigen::Ref<const Eigen::MatrixXf>& configurations, Eigen::Index first)
    : first_(first), order_(static_cast<std::size_t>(configurations.cols())) {
  std::iota(order_.begin(), order_.end(), 0);
  divide(configurations);
  fill(configurations);
}

/// Halves along the joint in which the configurations lie farthest apart.
void BoxedNodes::divide(const Eigen::Ref<const Eigen::MatrixXf>& configurations) {
  std::vector<Box> pending = {{0, order_.size()}};
  while (!pending.empty()) {
    const Box box = pending.back();
    pending.pop_back();
    const auto first = order_.begin() + signed_of(box.first);
    const auto last = first + signed_of(box.count);
    if (box.count <= kMostInABox) {
      std::sort(first, last);
      boxes_.push_back(box);
      continue;
    }
    Eigen::VectorXf low = configurations.col(*first), high = low;
    for (auto column = first; column != last; ++column) {
      low = low.cwiseMin(configurations.col(*column));
      high = high.cwiseMax(configurations.col(*column));
    }
    Eigen::Index joint = 0;
    (high - low).maxCoeff(&joint);
    const std::size_t half = box.count / 2;
    std::nth_element(first, first + signed_of(half), last, [&](std::int32_t a, std::int32_t b) {
      return configurations(joint, a) < configurations(joint, b);
    });
    pending.push_back({box.first + half, box.count - half});
    pending.push_back({box.first, half});
  }
}

void BoxedNodes::fill(const Eigen::Ref<const Eigen::MatrixXf>& configurations) {
  const Eigen::Index dof = configurations.rows(), count = signed_of(boxes_.size());
  const Eigen::Index room = (count + kScanBlock - 1) / kScanBlock * kScanBlock;
  lower_ = Eigen::ArrayXXf::Constant(room, dof, kFarAway);
  upper_ = Eigen::ArrayXXf::Constant(room, dof, kFarAway);
  values_ = Eigen::ArrayXXf::Constant(count * signed_of(kMostInABox), dof, kFarAway);
  for (Eigen::Index box = 0; box < count; ++box) {
    const Box& its = boxes_[static_cast<std::size_t>(box)];
    const Eigen::Index first = box * signed_of(kMostInABox);
    for (std::size_t i = 0; i < its.count; ++i)
      values_.row(first + signed_of(i)) =
          configurations.col(order_[its.first + i]).transpose().array();
    const auto block = values_.middleRows(first, signed_of(its.count));
    lower_.row(box) = block.colwise().minCoeff();
    upper_.row(box) = block.colwise().maxCoeff();
  }
}

void BoxedNodes::improve(const float* wanted, NearestNode& nearest,
                         std::vector<float>& squared) const {
  const int dof = static_cast<int>(lower_.cols());
  const auto room = static_cast<std::size_t>(lower_.rows());
  squared.resize(std::max(squared.size(), room));
  fastest_scans().boxes({lower_.data(), lower_.rows(), dof}, {upper_.data(), upper_.rows(), dof},
                        lower_.rows(), wanted, squared.data());
  const std::span<const float> distances(squared.data(), boxes_.size());
  const auto closest =
      static_cast<std::size_t>(std::ranges::min_element(distances) - distances.begin());
  if (distances[closest] > nearest.squared)
    return;
  look_into(closest, wanted, nearest);
  for (std::size_t box = 0; box < boxes_.size(); ++box)
    if (distances[box] <= nearest.squared && box != closest)
      look_into(box, wanted, nearest);
}

void BoxedNodes::look_into(std::size_t box, const float* wanted, NearestNode& nearest) const {
  // As near is enough for one with a lower index.
  const float enough = std::nextafter(nearest.squared, kFarAway);
  ScanResult found{enough, -1};
  const auto dof = static_cast<int>(values_.cols());
  const Eigen::Index first = signed_of(box * kMostInABox);
  const auto count = static_cast<long>(boxes_[box].count);
  fastest_scans().nodes({values_.data() + first, values_.rows(), dof}, 0, count, wanted, found);
  if (found.index < 0)
    return;
  const Eigen::Index index =
      first_ + order_[boxes_[box].first + static_cast<std::size_t>(found.index)];
  if (found.squared < nearest.squared ||
      (found.squared == nearest.squared && index < nearest.index)) {
    nearest.squared = found.squared;
    nearest.index = index;
  }
}

}  // namespace kinship::planning
