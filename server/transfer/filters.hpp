#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace kinship::transfer {

/// How many of some configurations of the target robot (dof x n, joint units, within limits), from
/// the first on, may be used before one may not. Whether one may depends on that one only.
using ConfigurationFilter =
    std::function<Eigen::Index(const Eigen::Ref<const Eigen::MatrixXd>& qs)>;

/// What the configurations of a path have to pass, in this order. An empty one passes everything.
struct Filters {
  ConfigurationFilter self;   ///< ends where the target touches itself
  ConfigurationFilter scene;  ///< where it touches the scene that was recorded with this path
};

/// Filters, how often they were asked, and how often they said no.
class CountedFilters {
 public:
  /// \param filters  outlive it.
  explicit CountedFilters(const Filters& filters) : filters_(filters) {}
  explicit CountedFilters(Filters&&) = delete;  // would not outlive it

  /// How many configurations (dof x n), from the first on, every filter keeps before one is left
  /// out. Counts as if they had been asked about one after the other, up to that one.
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
