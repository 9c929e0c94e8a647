#include "server/catalog/fit_troubles.hpp"

#include <algorithm>

namespace kinship::catalog {

const FitTrouble& FitTroubles::add(const Digest& id, TimePoint now, FetchStatus status,
                                   const std::string& message) {
  if (troubles_.size() >= kMaxTroubles && !troubles_.contains(id))
    troubles_.erase(std::ranges::min_element(
        troubles_, {}, [](const auto& entry) { return entry.second.next_try; }));
  FitTrouble& trouble = troubles_[id];
  trouble.status = status;
  trouble.message = message;
  constexpr int kMaxDoublings = 20;
  const int doublings = std::min(trouble.failures++, kMaxDoublings);
  trouble.next_try = now + std::min(kFirstRetry * (1 << doublings), kLastRetry);
  return trouble;
}

const FitTrouble* FitTroubles::find(const Digest& id, TimePoint now) const {
  const FitTrouble* const trouble = last(id);
  return trouble != nullptr && now < trouble->next_try ? trouble : nullptr;
}

const FitTrouble* FitTroubles::last(const Digest& id) const {
  const auto found = troubles_.find(id);
  return found == troubles_.end() ? nullptr : &found->second;
}

}  // namespace kinship::catalog
