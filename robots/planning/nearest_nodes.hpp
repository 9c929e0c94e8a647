#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

namespace kinship::planning {

/// The nearest of the first nodes.
struct NearestNode {
  Eigen::Index index = 0;
  float squared = std::numeric_limits<float>::infinity();  ///< distance, joint units
  Eigen::Index looked_at = 0;                              ///< nodes
};

/// Finds the nearest of many configurations: exact, in the Euclidean metric (joint units) of single
/// precision, the first of equals. It scans the newest and keeps the others in boxes: up to
/// `kScanned` configurations the scan is faster. Not shared between threads.
class NearestNodes {
 public:
  static constexpr Eigen::Index kScanned = 4096;

  /// \param scanned  maximum number scanned, at least 1; the results do not depend on it.
  explicit NearestNodes(Eigen::Index dof, Eigen::Index scanned = kScanned);
  NearestNodes(NearestNodes&&) noexcept;
  NearestNodes& operator=(NearestNodes&&) noexcept;
  ~NearestNodes();

  /// Adds a configuration; its index is the number of earlier ones.
  void add(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Index of the configuration nearest to q; 0 if there are none.
  Eigen::Index find(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// The same if the nearest of the first ones is known; searches those added since.
  void update(const Eigen::Ref<const Eigen::VectorXd>& q, NearestNode& nearest) const;

 private:
  struct Boxed;

  void make_room();

  Eigen::Index max_scanned_;
  Eigen::ArrayXXf scanned_;  // capacity x dof, one column per joint; infinity where nothing stands
  Eigen::Index scanned_count_ = 0;
  std::unique_ptr<Boxed> boxed_;  // holds scratch memory of searches, too
};

}  // namespace kinship::planning
