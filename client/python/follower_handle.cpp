#include "client/python/follower_handle.hpp"

#include <pybind11/pybind11.h>

#include "client/python/client_handle.hpp"

namespace kinship::python {

std::shared_ptr<link::Follower> FollowerHandle::line() const {
  if (!follower_)
    throw Failure(ErrorCode::InvalidInput, "the follower is closed");
  return follower_;
}

void FollowerHandle::close() {
  std::shared_ptr<link::Follower> follower = std::move(follower_);
  follower_.reset();
  const pybind11::gil_scoped_release unlocked;
  follower.reset();
}

std::shared_ptr<SampledDistribution> FollowerHandle::newest() { return sampled(line()->newest()); }

std::shared_ptr<SampledDistribution> FollowerHandle::wait_for_newer(
    const std::shared_ptr<SampledDistribution>& held, std::chrono::milliseconds timeout) {
  const std::shared_ptr<link::Follower> follower = line();
  return sampled(python::wait_for_newer(*follower, held ? held->value() : nullptr, timeout));
}

std::string FollowerHandle::status() const {
  switch (line()->state().status) {
    case link::FollowStatus::Ready:
      return "ready";
    case link::FollowStatus::NoServer:
      return "no_server";
    case link::FollowStatus::Pending:
      return "pending";
    case link::FollowStatus::NoExperience:
      return "no_experience";
    case link::FollowStatus::UnknownRobot:
      return "unknown_robot";
    case link::FollowStatus::Refused:
      return "refused";
    case link::FollowStatus::Failed:
      break;
  }
  return "failed";
}

std::shared_ptr<SampledDistribution> FollowerHandle::sampled(
    std::shared_ptr<const Distribution> distribution) {
  if (!distribution)
    return nullptr;
  if (!last_ || last_->value() != distribution)
    last_ = std::make_shared<SampledDistribution>(std::move(distribution));
  return last_;
}

}  // namespace kinship::python
