#include "robots/planning/is_free.hpp"

namespace kinship::planning {

IsFree free_in(collision::CollisionWorld& world, std::function<void()> before) {
  const auto prepare = [before = std::move(before)] {
    if (before)
      before();
  };
  return {[&world, prepare](const Eigen::VectorXd& q) {
            prepare();
            return !world.collides(q);
          },
          [&world, prepare](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            prepare();
            return world.free_ahead(qs);
          },
          [&world, prepare](const Eigen::Ref<const Eigen::MatrixXd>& qs) {
            prepare();
            return world.colliding_ahead(qs);
          }};
}

}  // namespace kinship::planning
