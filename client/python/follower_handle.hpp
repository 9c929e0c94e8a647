#pragma once

#include <chrono>
#include <memory>
#include <string>
#include <utility>

#include "client/link/follower.hpp"
#include "client/python/sampled_distribution.hpp"

namespace kinship::python {

/// A follower whose distributions keep their samplers. Called with the interpreter's lock.
class FollowerHandle {
 public:
  explicit FollowerHandle(std::unique_ptr<link::Follower> follower)
      : follower_(std::move(follower)) {}
  ~FollowerHandle() { close(); }
  FollowerHandle(const FollowerHandle&) = delete;
  FollowerHandle& operator=(const FollowerHandle&) = delete;

  /// \throws Failure(InvalidInput) if it is closed.
  std::shared_ptr<link::Follower> line() const;
  void close();

  /// Null: there is none.
  std::shared_ptr<SampledDistribution> newest();

  /// Waits in slices between which Python handles signals.
  /// \param held  null: any will do.
  std::shared_ptr<SampledDistribution> wait_for_newer(
      const std::shared_ptr<SampledDistribution>& held, std::chrono::milliseconds timeout);

  std::string status() const;  ///< as text

 private:
  std::shared_ptr<SampledDistribution> sampled(std::shared_ptr<const Distribution> distribution);

  std::shared_ptr<link::Follower> follower_;  // null: closed
  std::shared_ptr<SampledDistribution> last_;
};

}  // namespace kinship::python
