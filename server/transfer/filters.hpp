#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace kinship::transfer {

/// Number of leading configurations of the target robot (dof x n, joint units, within limits) that
/// pass, before the first that does not. Whether one passes depends on that one only.
using ConfigurationFilter =
    std::function<Eigen::Index(const Eigen::Ref<const Eigen::MatrixXd>& qs)>;

/// Filters of the configurations of a path, applied in this order. An empty one passes every
/// configuration.
struct Filters {
  ConfigurationFilter self;   ///< rejects self-collisions of the target
  ConfigurationFilter scene;  ///< rejects collisions with the scene recorded with this path
};

/// Filters with counts of their checks and rejections.
class CountedFilters {
 public:
  /// \param filters  outlive it.
  explicit CountedFilters(const Filters& filters) : filters_(filters) {}
  explicit CountedFilters(Filters&&) = delete;  // would not outlive it

  /// Number of leading configurations (dof x n) that every filter keeps, before the first that is
  /// left out. Counts checks as if they were made one after the other, up to that one.
  Eigen::Index keep_ahead(const Eigen::Ref<const Eigen::MatrixXd>& qs);

  std::uint64_t checks() const noexcept { return checks_; }  ///< 0 without filters
  std::uint64_t self_collisions() const noexcept { return self_collisions_; }
  std::uint64_t scene_collisions() const noexcept { return scene_collisions_; }

 private:
  const Filters& filters_;
  std::uint64_t checks_ = 0, self_collisions_ = 0, scene_collisions_ = 0;
};

/// The columns of `configurations` that the filters keep, in their order.
Eigen::MatrixXd passed(Eigen::MatrixXd configurations, CountedFilters& filters);

}  // namespace kinship::transfer
