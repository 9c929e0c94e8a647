#include "server/service/distribution_cache.hpp"

#include <utility>

namespace kinship::service {
namespace {

/// About what a reply occupies: the numbers of its mixture, and a page for the rest.
std::size_t size_of(const FetchReply& reply) {
  constexpr std::size_t kRest = 4096;
  if (!reply.distribution || !reply.distribution->mixture)
    return kRest;
  const Mixture& mixture = *reply.distribution->mixture;
  const auto k = static_cast<std::size_t>(mixture.size());
  const auto d = static_cast<std::size_t>(mixture.dimension());
  return kRest + sizeof(double) * (k * (1 + d) + mixture.covariances().size() * d * d);
}

}  // namespace

void DistributionCache::put(const Digest& id, Entry entry) {
  if (const auto known = index_.find(id); known != index_.end())
    drop(known->second);
  const std::size_t bytes = size_of(*entry.reply.reply);
  nodes_.push_front({id, std::move(entry), bytes});
  index_.emplace(id, nodes_.begin());
  bytes_ += bytes;
  while (nodes_.size() > 1 && (nodes_.size() > limits_.entries || bytes_ > limits_.bytes))
    drop(std::prev(nodes_.end()));
}

DistributionCache::Entry* DistributionCache::find(const Digest& id) {
  const auto known = index_.find(id);
  if (known == index_.end())
    return nullptr;
  nodes_.splice(nodes_.begin(), nodes_, known->second);
  return &known->second->entry;
}

void DistributionCache::erase(const Digest& id) {
  if (const auto known = index_.find(id); known != index_.end())
    drop(known->second);
}

void DistributionCache::replace(const Digest& id, const SharedReply& before,
                                const AdvisedReply& after) {
  const auto known = index_.find(id);
  if (known != index_.end() && known->second->entry.reply.reply == before)
    known->second->entry.reply = after;
}

void DistributionCache::drop(std::list<Node>::iterator node) {
  bytes_ -= node->bytes;
  index_.erase(node->id);
  nodes_.erase(node);
}

}  // namespace kinship::service
