#include "robots/inverse/choice.hpp"

#include <algorithm>

namespace kinship::inverse {

void Configurations::swap(std::size_t a, std::size_t b) noexcept {
  if (a != b)
    std::swap_ranges(values_.data() + a * dof_, values_.data() + (a + 1) * dof_,
                     values_.data() + b * dof_);
}

Eigen::MatrixXd Configurations::matrix() const {
  return Eigen::Map<const Eigen::MatrixXd>(values_.data(), static_cast<Eigen::Index>(dof_),
                                           static_cast<Eigen::Index>(size()));
}

bool is_apart(const JointSpace& space, const Configurations& from, const double* q,
              double distance) noexcept {
  for (std::size_t i = 0; i < from.size(); ++i)
    if (space.squared_distance(q, from[i]) < distance * distance)
      return false;
  return true;
}

Configurations chosen(const JointSpace& space, Configurations all, std::size_t most,
                      double distance, CounterGenerator generator) {
  Configurations taken(space.dof());
  for (std::size_t i = 0; i < all.size() && taken.size() < most; ++i) {
    const std::size_t left = all.size() - i;
    const auto draw = static_cast<std::size_t>(generator.uniform() * static_cast<double>(left));
    all.swap(i, i + std::min(draw, left - 1));
    if (is_apart(space, taken, all[i], distance))
      taken.add(all[i]);
  }
  return taken;
}

}  // namespace kinship::inverse
