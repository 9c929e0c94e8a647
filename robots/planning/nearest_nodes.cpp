#include "robots/planning/nearest_nodes.hpp"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <nanoflann.hpp>
#include <vector>

namespace kinship::planning {
namespace {

constexpr Eigen::Index kFirstCapacity = 1024;

/// The nearest configuration so far, as nanoflann wants it.
class NearestSoFar {
 public:
  using DistanceType = float;
  using IndexType = std::uint32_t;

  NearestSoFar(float squared, Eigen::Index index) : squared_(squared), index_(index) {}

  Eigen::Index index() const { return index_; }
  bool full() const { return true; }
  /// A little more than the least, for an equal one with a lower index, and because what bounds the
  /// distance of a branch was rounded.
  float worstDist() const {
    constexpr float kSlack = 1e-5F;
    return squared_ * (1 + kSlack) + std::numeric_limits<float>::min();
  }
  bool addPoint(float squared, std::uint32_t index) {
    if (squared < squared_ || (squared == squared_ && index < index_)) {
      squared_ = squared;
      index_ = index;
    }
    return true;
  }

 private:
  float squared_;
  Eigen::Index index_;
};

}  // namespace

/// All but the newest, in k-d trees of doubling size, which nanoflann merges as they grow.
class NearestNodes::KdTrees {
 public:
  explicit KdTrees(Eigen::Index dof)
      : points_{{}, static_cast<std::size_t>(dof)},
        trees_(static_cast<int>(dof), points_,
               nanoflann::KDTreeSingleIndexAdaptorParams(kLeafSize)) {}

  std::size_t size() const { return points_.kdtree_get_point_count(); }

  /// \param configurations  n x dof.
  void add(const Eigen::ArrayXXf& configurations) {
    const std::size_t first = size();
    for (const auto& q : configurations.rowwise())
      points_.values.insert(points_.values.end(), q.begin(), q.end());
    trees_.addPoints(static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(size() - 1));
  }

  void find(const Eigen::VectorXf& q, NearestSoFar& nearest) const {
    trees_.findNeighbors(nearest, q.data(), nanoflann::SearchParams());
  }

 private:
  static constexpr std::size_t kLeafSize = 32;

  struct Points {
    std::vector<float> values;  // dof x n
    std::size_t dof;

    std::size_t kdtree_get_point_count() const { return values.size() / dof; }
    float kdtree_get_pt(std::size_t index, std::size_t joint) const {
      return values[index * dof + joint];
    }
    template <typename Box>
    bool kdtree_get_bbox(Box&) const {
      return false;
    }
  };
  // Adds up the joints in their order, as the scan does: equal configurations are equally far.
  using Metric = nanoflann::L2_Simple_Adaptor<float, Points, float, std::uint32_t>;

  Points points_;
  nanoflann::KDTreeSingleIndexDynamicAdaptor<Metric, Points, -1, std::uint32_t> trees_;
};

NearestNodes::NearestNodes(Eigen::Index dof, Eigen::Index scanned)
    : max_scanned_(scanned), scanned_(std::min(kFirstCapacity, scanned), dof) {}
NearestNodes::NearestNodes(NearestNodes&&) noexcept = default;
NearestNodes& NearestNodes::operator=(NearestNodes&&) noexcept = default;
NearestNodes::~NearestNodes() = default;

void NearestNodes::add(const Eigen::VectorXd& q) {
  if (scanned_count_ == max_scanned_)
    index_scanned();
  if (scanned_count_ == scanned_.rows())
    scanned_.conservativeResize(std::min(2 * scanned_.rows(), max_scanned_), Eigen::NoChange);
  scanned_.row(scanned_count_++) = q.cast<float>().transpose().array();
}

void NearestNodes::index_scanned() {
  if (!indexed_)
    indexed_ = std::make_unique<KdTrees>(scanned_.cols());
  indexed_->add(scanned_);
  scanned_count_ = 0;
}

Eigen::Index NearestNodes::find(const Eigen::VectorXd& q) const {
  constexpr Eigen::Index kBlock = 256;  // stays in the first-level cache, on the stack
  using Block = Eigen::Array<float, Eigen::Dynamic, 1, 0, kBlock, 1>;
  const Eigen::VectorXf wanted = q.cast<float>();
  Eigen::Index nearest = 0;
  float least = std::numeric_limits<float>::infinity();
  for (Eigen::Index first = 0; first < scanned_count_; first += kBlock) {
    const Eigen::Index count = std::min(kBlock, scanned_count_ - first);
    Block squared = (scanned_.col(0).segment(first, count) - wanted[0]).square();
    for (Eigen::Index joint = 1; joint < wanted.size(); ++joint)
      squared += (scanned_.col(joint).segment(first, count) - wanted[joint]).square();
    if (squared.minCoeff() >= least)
      continue;
    Eigen::Index within = 0;
    least = squared.minCoeff(&within);
    nearest = first + within;
  }
  if (!indexed_)
    return nearest;
  NearestSoFar so_far(least, nearest + static_cast<Eigen::Index>(indexed_->size()));
  indexed_->find(wanted, so_far);
  return so_far.index();
}

}  // namespace kinship::planning
