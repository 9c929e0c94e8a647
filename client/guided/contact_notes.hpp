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

  /// What touches in how many of those noted, the most frequent first: "'l4' touches 'wall' (5 of
  /// 8), 'l2' touches 'l4' (3 of 8)".
  std::string text();

 private:
  void note(const Eigen::Ref<const Eigen::VectorXd>& q);

  collision::CollisionWorld& world_;
  std::vector<Eigen::VectorXd> colliding_;
};

}  // namespace kinship::planner
