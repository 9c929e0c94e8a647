#pragma once

#include <vector>

#include "robots/inverse/counter_generator.hpp"
#include "robots/inverse/joint_space.hpp"

namespace kinship::inverse {

/// Configurations of one chain, one after the other.
class Configurations {
 public:
  explicit Configurations(Eigen::Index dof) : dof_(static_cast<std::size_t>(dof)) {}

  std::size_t size() const noexcept { return values_.size() / dof_; }
  bool empty() const noexcept { return values_.empty(); }
  const double* operator[](std::size_t i) const noexcept { return values_.data() + i * dof_; }
  void add(const double* q) { values_.insert(values_.end(), q, q + dof_); }
  void swap(std::size_t a, std::size_t b) noexcept;

  /// dof x size()
  Eigen::MatrixXd matrix() const;

 private:
  std::size_t dof_;
  std::vector<double> values_;
};

/// Whether a configuration is at least `distance` from all of `from`.
bool is_apart(const JointSpace& space, const Configurations& from, const double* q,
              double distance) noexcept;

/// Takes, in uniformly shuffled order, each configuration at least `distance` from those taken
/// before, until there are `most`.
Configurations chosen(const JointSpace& space, Configurations all, std::size_t most,
                      double distance, CounterGenerator generator);

}  // namespace kinship::inverse
