#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <functional>

namespace kinship::transfer {

/// Whether a configuration of the target robot (dof, joint units, within limits) may be used. The
/// answer may depend on the configuration only.
using ConfigurationFilter = std::function<bool(const Eigen::Ref<const Eigen::VectorXd>& q)>;

/// What the configurations of a path have to pass, in this order. An empty one passes everything.
struct Filters {
  ConfigurationFilter self;   ///< false: the target touches itself
  ConfigurationFilter scene;  ///< false: it touches the scene that was recorded with this path
};

/// Filters, how often they were asked, and how often they said no.
class CountedFilters {
 public:
  /// \param filters  outlive it.
  explicit CountedFilters(const Filters& filters) : filters_(filters) {}
  explicit CountedFilters(Filters&&) = delete;  // would not outlive it

  /// Whether every filter keeps `q`.
  bool keep(const Eigen::Ref<const Eigen::VectorXd>& q);

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
