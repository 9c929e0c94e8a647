#include "robots/planning/nearest_nodes.hpp"

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <numeric>
#include <span>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "robots/planning/nearest_scan.hpp"

namespace kinship::planning {
namespace {

/// Configurations in boxes of at most 64 that lie close together: a search scans only boxes that
/// reach nearer than the nearest one found. Immutable.
class BoxedNodes {
 public:
  /// \param configurations  dof x n, n >= 1.
  /// \param first           index of the first one; the others follow.
  BoxedNodes(const Eigen::Ref<const Eigen::MatrixXf>& configurations, Eigen::Index first);

  Eigen::Index size() const noexcept { return static_cast<Eigen::Index>(order_.size()); }

  /// Searches for a nearer one, or an equally near one with a lower index.
  /// \param wanted  dof. \param squared  kept between calls, so that searching allocates nothing.
  void improve(const float* wanted, NearestNode& nearest, std::vector<float>& squared) const;

 private:
  struct Box {
    std::size_t first;  // of order_
    std::size_t count;
  };

  void divide(const Eigen::Ref<const Eigen::MatrixXf>& configurations);
  void fill(const Eigen::Ref<const Eigen::MatrixXf>& configurations);
  void look_into(std::size_t box, const float* wanted, NearestNode& nearest) const;

  Eigen::Index first_;
  std::vector<std::int32_t> order_;  // columns, box after box, ascending in each
  std::vector<Box> boxes_;
  Eigen::ArrayXXf lower_, upper_;  // boxes x dof
  Eigen::ArrayXXf values_;         // 64 for each box, x dof; infinity where nothing stands
};

constexpr std::size_t kMostInABox = 64;
constexpr float kFarAway = std::numeric_limits<float>::infinity();

Eigen::Index signed_of(std::size_t value) { return static_cast<Eigen::Index>(value); }

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

constexpr Eigen::Index kFirstCapacity = 128;
constexpr float kNowhere = std::numeric_limits<float>::infinity();

/// Enough for so many, in whole blocks.
Eigen::Index in_blocks(Eigen::Index count) {
  return (count + kScanBlock - 1) / kScanBlock * kScanBlock;
}

}  // namespace

/// All but the newest: batches of them, merged with the last one that is not larger.
struct NearestNodes::Boxed {
  Eigen::MatrixXf configurations;  // dof x capacity
  Eigen::Index count = 0;
  std::vector<BoxedNodes> batches;
  std::vector<float> squared;  // room for a search

  void add(const Eigen::Ref<const Eigen::ArrayXXf>& newest) {
    const Eigen::Index needed = count + newest.rows();
    if (needed > configurations.cols())
      configurations.conservativeResize(newest.cols(), 2 * needed);
    configurations.middleCols(count, newest.rows()) = newest.matrix().transpose();
    Eigen::Index first = count;
    count = needed;
    while (!batches.empty() && batches.back().size() <= count - first) {
      first -= batches.back().size();
      batches.pop_back();
    }
    batches.emplace_back(configurations.middleCols(first, count - first), first);
  }
};

NearestNodes::NearestNodes(Eigen::Index dof, Eigen::Index scanned)
    : max_scanned_(scanned),
      scanned_(
          Eigen::ArrayXXf::Constant(in_blocks(std::min(kFirstCapacity, scanned)), dof, kNowhere)) {}
NearestNodes::NearestNodes(NearestNodes&&) noexcept = default;
NearestNodes& NearestNodes::operator=(NearestNodes&&) noexcept = default;
NearestNodes::~NearestNodes() = default;

void NearestNodes::add(const Eigen::Ref<const Eigen::VectorXd>& q) {
  if (scanned_count_ == max_scanned_ || scanned_count_ == scanned_.rows())
    make_room();
  scanned_.row(scanned_count_++) = q.cast<float>().transpose().array();
}

void NearestNodes::make_room() {
  if (scanned_count_ < max_scanned_) {
    const Eigen::Index before = scanned_.rows();
    scanned_.conservativeResize(in_blocks(std::min(2 * before, max_scanned_)), Eigen::NoChange);
    scanned_.bottomRows(scanned_.rows() - before).setConstant(kNowhere);
    return;
  }
  if (!boxed_)
    boxed_ = std::make_unique<Boxed>();
  boxed_->add(scanned_.topRows(scanned_count_));
  scanned_.setConstant(kNowhere);
  scanned_count_ = 0;
}

Eigen::Index NearestNodes::find(const Eigen::Ref<const Eigen::VectorXd>& q) const {
  NearestNode nearest;
  update(q, nearest);
  return nearest.index;
}

void NearestNodes::update(const Eigen::Ref<const Eigen::VectorXd>& q, NearestNode& nearest) const {
  const Eigen::Index boxed = boxed_ ? boxed_->count : 0, count = boxed + scanned_count_;
  if (nearest.looked_at == count)
    return;
  if (nearest.looked_at < boxed)
    nearest = {};
  std::array<float, kMaxDof> wanted{};
  for (Eigen::Index joint = 0; joint < q.size(); ++joint)
    wanted[static_cast<std::size_t>(joint)] = static_cast<float>(q[joint]);
  const bool is_new = nearest.looked_at == 0;
  ScanResult found{nearest.squared, is_new ? 0 : nearest.index - boxed};
  fastest_scans().nodes({scanned_.data(), scanned_.rows(), static_cast<int>(scanned_.cols())},
                        is_new ? 0 : nearest.looked_at - boxed, scanned_count_, wanted.data(),
                        found);
  nearest = {found.index + boxed, found.squared, count};
  if (is_new && boxed_)
    for (auto batch = boxed_->batches.rbegin(); batch != boxed_->batches.rend(); ++batch)
      batch->improve(wanted.data(), nearest, boxed_->squared);
}

}  // namespace kinship::planning
