#include "server/catalog/distribution_cache.hpp"

#include <utility>

namespace kinship::catalog {
namespace {

/// About the memory of a reply: the numbers of its mixture, its sources, and a page for the rest.
std::size_t size_of(const FetchReply& reply) {
  constexpr std::size_t kPage = 4096;
  if (!reply.distribution)
    return kPage;
  std::size_t rest = kPage;
  for (const Source& source : reply.distribution->sources)
    rest += sizeof(Source) + source.label.size();
  if (!reply.distribution->mixture)
    return rest;
  const Mixture& mixture = *reply.distribution->mixture;
  const auto k = static_cast<std::size_t>(mixture.size());
  const auto d = static_cast<std::size_t>(mixture.dimension());
  return rest + sizeof(double) * (k * (1 + d) + mixture.covariances().size() * d * d);
}

}  // namespace

void DistributionCache::put(const Digest& id, Entry entry) {
  const std::size_t bytes = size_of(*entry.reply.reply);
  replies_.put(id, std::move(entry), bytes);
  while (size() > 1 && (size() > limits_.entries || this->bytes() > limits_.bytes)) {
    replies_.drop_oldest();
    ++dropped_;
  }
}

void DistributionCache::replace(const Digest& id, const SharedReply& before,
                                const AdvisedReply& after) {
  Entry* const entry = replies_.find(id);
  if (entry != nullptr && entry->reply.reply == before)
    entry->reply = after;
}

std::vector<Digest> DistributionCache::of_robot(const Digest& robot) const {
  return replies_.ids_of(
      [&robot](const Entry& entry) { return entry.reply.reply->distribution->robot == robot; });
}

}  // namespace kinship::catalog
