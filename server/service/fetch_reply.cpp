#include "server/service/fetch_reply.hpp"

#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::service {

FetchReply without_distribution(FetchStatus status, const std::string& message) {
  FetchReply reply;
  reply.status = status;
  reply.message = cut_text(message, kMaxMessageBytes);
  return reply;
}

FetchReply no_experience(const std::string& task) {
  return without_distribution(FetchStatus::NoExperience, "no paths of task '" + task + "'");
}

SharedReply shared(FetchReply reply) {
  return std::make_shared<const FetchReply>(std::move(reply));
}

SharedReply shared_pending() {
  return shared(without_distribution(FetchStatus::Pending, "not fitted yet; ask again"));
}

SharedReply with_distribution(Distribution distribution) {
  const bool ready = distribution.state == DistributionState::Ready;
  FetchReply reply =
      without_distribution(ready ? FetchStatus::Ready : FetchStatus::Failed, distribution.reason);
  reply.distribution = std::move(distribution);
  return shared(std::move(reply));
}

}  // namespace kinship::service
