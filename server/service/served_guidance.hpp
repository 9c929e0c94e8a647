#pragma once

#include <memory>
#include <string>
#include <string_view>

#include "proto/types/distribution.hpp"
#include "proto/types/summaries.hpp"

namespace kinship::service {

/// The guidance that a server gives from memory, as administrators see and change it.
class ServedGuidance {
 public:
  virtual ~ServedGuidance() = default;

  /// The advice of the moment for a distribution.
  virtual Advice advise(const Distribution& distribution) = 0;
  /// The newest rehearsal of a distribution; null: none yet.
  virtual std::shared_ptr<const Rehearsal> find_rehearsal(const Digest& id) const = 0;
  /// Why the last fit of a distribution failed, as text; empty: it succeeded.
  virtual std::string trouble_of(const Digest& id) const = 0;

  /// A distribution was evicted from the store: no cache may serve it.
  virtual void forget_distribution(const Digest& id) = 0;
  /// Paths of a task were retired: distributions made of them may not be served.
  virtual void forget_task(const std::string& task) = 0;
  /// A task was renamed or removed: nothing of it may be served, under this name.
  virtual void drop_task(const std::string& task) = 0;
  /// Paths of a task were restored.
  virtual void new_experience(std::string_view task) = 0;
  /// A robot was removed: its distributions may not be served, nor announced.
  virtual void forget_robot(const Digest& robot) = 0;
};

}  // namespace kinship::service
