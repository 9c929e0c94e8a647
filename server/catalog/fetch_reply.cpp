#include "server/catalog/fetch_reply.hpp"

#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::catalog {

FetchReply without_distribution(FetchStatus status, const std::string& message) {
  FetchReply reply;
  reply.status = status;
  reply.message = cut_text(message, kMaxMessageBytes);
  return reply;
}

FetchReply no_experience(const fitting::DistributionKey& key, const std::string& advice) {
  std::string message = "no paths of task '" + key.task + "'";
  if (!key.sources.empty())
    message += " of the " + std::to_string(key.sources.size()) + " selected robots";
  if (key.since_ms > 0)
    message += " received since " + std::to_string(key.since_ms) + " ms";
  return without_distribution(FetchStatus::NoExperience, message + advice);
}

SharedReply shared(FetchReply reply) {
  return std::make_shared<const FetchReply>(std::move(reply));
}

SharedReply shared_pending() {
  return shared(without_distribution(FetchStatus::Pending, "not fitted yet; ask again"));
}

SharedReply with_distribution(Distribution distribution) {
  FetchReply reply = without_distribution(
      has_mixture(distribution.state) ? FetchStatus::Ready : FetchStatus::Failed,
      distribution.reason);
  reply.distribution = std::move(distribution);
  return shared(std::move(reply));
}

FetchDone with_profile_text_of(const FetchRequest& request, FetchDone done) {
  return [profile = request.profile, done = std::move(done)](const FetchReply& reply) {
    if (!reply.distribution || reply.distribution->profile == profile)
      return done(reply);
    FetchReply own = reply;
    own.distribution->profile = profile;
    done(own);
  };
}

}  // namespace kinship::catalog
