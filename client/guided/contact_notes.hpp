#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "robots/collision/edge_prover.hpp"
#include "robots/planning/is_free.hpp"

namespace kinship::guided {

/// What is too near at a configuration, or touches.
using FindNear = std::function<std::vector<collision::NearPair>(const Eigen::VectorXd& q)>;

/// "'l4' touches 'wall'", or "'l4' is 0.45 mm from 'wall', nearer than the clearance of 1 mm".
std::string near_text(const collision::NearPair& near);

/// Remembers which configurations were not free, to say afterwards what they touch.
class ContactNotes {
 public:
  /// \param find_near  of the world whose questions `watched` passes on
  explicit ContactNotes(FindNear find_near) : find_near_(std::move(find_near)) {}

  /// \param is_free  asked in turn. What is returned borrows both.
  planning::IsFree watched(const planning::IsFree& is_free);

  /// Notes one that is not free.
  void note(const Eigen::Ref<const Eigen::VectorXd>& q);

  /// What is touched in how many of those noted, and by what, the most frequent first: "'l4' or
  /// 'l3' touches 'wall' in 5 of 8 configurations, 'l4' touches 'l2' in 3 of 8"; without counts of
  /// a single one. What does not touch is "less than 1 mm from" the other. Of two links the one
  /// farther from the base is what is touched.
  std::string text();

 private:
  FindNear find_near_;
  std::vector<Eigen::VectorXd> colliding_;
};

}  // namespace kinship::guided
