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

/// The pairs that touch or are too near at a configuration.
using FindNear = std::function<std::vector<collision::NearPair>(const Eigen::VectorXd& q)>;

/// "'l4' touches 'wall'", or "'l4' is 0.45 mm from 'wall', nearer than the clearance of 1 mm".
std::string near_text(const collision::NearPair& near);

/// Remembers colliding configurations, to name their contacts afterwards.
class ContactNotes {
 public:
  /// \param find_near  of the same world as the checks that `watched` passes on
  explicit ContactNotes(FindNear find_near) : find_near_(std::move(find_near)) {}

  /// \param is_free  called by the returned check, which borrows it and this object.
  planning::IsFree watched(const planning::IsFree& is_free);

  /// Notes a configuration that is not free.
  void note(const Eigen::Ref<const Eigen::VectorXd>& q);

  Eigen::MatrixXd noted() const;  ///< dof x n

  /// The contacts of the noted configurations with their counts, the most frequent first: "'l4' or
  /// 'l3' touches 'wall' in 5 of 8 configurations, 'l2' touches 'l4' in 3 of 8"; without counts for
  /// a single configuration. A pair that is too near is "less than 1 mm from" each other. Of two
  /// links, the one farther from the base is the touched one.
  std::string text();

 private:
  FindNear find_near_;
  std::vector<Eigen::VectorXd> colliding_;
};

}  // namespace kinship::guided
