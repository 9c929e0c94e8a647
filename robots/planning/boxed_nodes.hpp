#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <span>
#include <vector>

#include "robots/planning/nearest_nodes.hpp"

/// For this library's sources only.
namespace kinship::planning {

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

}  // namespace kinship::planning
