#pragma once

#include <Eigen/Core>
#include <memory>

namespace kinship::planning {

/// Which of many configurations is nearest: exact, in the Euclidean metric (joint units) of single
/// precision, the first of equals. The newest are scanned, all others stand in k-d trees: up to
/// `kScanned` configurations the scan is faster.
class NearestNodes {
 public:
  static constexpr Eigen::Index kScanned = 4096;

  /// \param scanned  how many are scanned at most, at least 1; the answers do not depend on it.
  explicit NearestNodes(Eigen::Index dof, Eigen::Index scanned = kScanned);
  NearestNodes(NearestNodes&&) noexcept;
  NearestNodes& operator=(NearestNodes&&) noexcept;
  ~NearestNodes();

  /// Its index is the number of those before it.
  void add(const Eigen::VectorXd& q);

  /// Index of the one nearest to q; 0 if there are none.
  Eigen::Index find(const Eigen::VectorXd& q) const;

 private:
  class KdTrees;  // names nanoflann

  void index_scanned();

  Eigen::Index max_scanned_;
  Eigen::ArrayXXf scanned_;  // capacity x dof: one column per joint, so that it is vectorised
  Eigen::Index scanned_count_ = 0;
  std::unique_ptr<KdTrees> indexed_;
};

}  // namespace kinship::planning
