#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <string>
#include <vector>

#include "robots/collision/collision_world.hpp"
#include "robots/planning/is_free.hpp"

namespace kinship::planner {

/// Remembers which configurations were not free, to say afterwards what they touch.
class ContactNotes {
 public:
  /// \param world  of the questions that `watched` passes on; borrowed.
  explicit ContactNotes(collision::CollisionWorld& world) : world_(world) {}

  /// \param is_free  asked in turn. What is returned borrows both.
  planning::IsFree watched(const planning::IsFree& is_free);

  /// Notes one that is not free.
  void note(const Eigen::Ref<const Eigen::VectorXd>& q);

  const std::vector<Eigen::VectorXd>& noted() const noexcept { return colliding_; }

  /// What is touched in how many of those noted, and by what, the most frequent first: "'l4' or
  /// 'l3' touches 'wall' in 5 of 8 configurations, 'l4' touches 'l2' in 3 of 8"; without counts of
  /// a single one. Of two links the one farther from the base is what is touched.
  std::string text();

 private:
  collision::CollisionWorld& world_;
  std::vector<Eigen::VectorXd> colliding_;
};

}  // namespace kinship::planner
