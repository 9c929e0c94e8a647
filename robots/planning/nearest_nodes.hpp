#pragma once

#include <Eigen/Core>
#include <limits>
#include <memory>

namespace kinship::planning {

/// What is nearest among the first nodes.
struct NearestNode {
  Eigen::Index index = 0;
  float squared = std::numeric_limits<float>::infinity();  ///< distance, joint units
  Eigen::Index looked_at = 0;                              ///< nodes
};

/// Which of many configurations is nearest: exact, in the Euclidean metric (joint units) of single
/// precision, the first of equals. The newest are scanned, all others stand in boxes: up to
/// `kScanned` configurations the scan is faster. Not shared between threads.
class NearestNodes {
 public:
  static constexpr Eigen::Index kScanned = 4096;

  /// \param scanned  how many are scanned at most, at least 1; the answers do not depend on it.
  explicit NearestNodes(Eigen::Index dof, Eigen::Index scanned = kScanned);
  NearestNodes(NearestNodes&&) noexcept;
  NearestNodes& operator=(NearestNodes&&) noexcept;
  ~NearestNodes();

  /// Its index is the number of those before it.
  void add(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// Index of the one nearest to q; 0 if there are none.
  Eigen::Index find(const Eigen::Ref<const Eigen::VectorXd>& q) const;

  /// The same where the nearest of the first ones is known; looks at those added since.
  void update(const Eigen::Ref<const Eigen::VectorXd>& q, NearestNode& nearest) const;

 private:
  struct Boxed;

  void make_room();

  Eigen::Index max_scanned_;
  Eigen::ArrayXXf scanned_;  // capacity x dof, one column per joint; infinity where nothing stands
  Eigen::Index scanned_count_ = 0;
  std::unique_ptr<Boxed> boxed_;  // what a search writes there is nobody's business
};

}  // namespace kinship::planning
