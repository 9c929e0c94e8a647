#include "server/catalog/adviser.hpp"

#include <utility>

#include "server/catalog/fetch_reply.hpp"

namespace kinship::catalog {

bool Adviser::is_current(const AdvisedReply& reply, const fitting::DistributionKey& key) const {
  return reply.reply->status != FetchStatus::Ready ||
         source_.version(key.task, key.robot) == reply.version;
}

AdvisedReply Adviser::advise(const SharedReply& reply, const fitting::DistributionKey& key) const {
  if (!reply || reply->status != FetchStatus::Ready)
    return {reply, 0};
  // The version first: if the advice changes in between, the next fetch finds another version.
  const std::uint64_t version = source_.version(key.task, key.robot);
  FetchReply advised = *reply;
  Profile profile = key.profile;
  profile.recommended_share = fitting::first_share(profile, advised.distribution->state);
  advised.distribution->advice = source_.advise(key.task, key.robot, profile);
  return {shared(std::move(advised)), version};
}

}  // namespace kinship::catalog
