#include "robots/planning/nearest_nodes.hpp"

#include <algorithm>
#include <array>
#include <cstddef>

#include "proto/types/limits.hpp"
#include "robots/planning/boxed_nodes.hpp"
#include "robots/planning/fastest_scan.hpp"

namespace kinship::planning {
namespace {

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
