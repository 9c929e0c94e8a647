#include "server/fitting/selected_experience.hpp"

#include <algorithm>
#include <numeric>

namespace kinship::fitting {
namespace {

/// The largest number that every source may have so that all together have at most `most`.
std::uint64_t even_limit(std::vector<std::uint64_t> counts, std::uint64_t most) {
  std::sort(counts.begin(), counts.end());
  std::uint64_t left = most;
  for (std::size_t i = 0; i < counts.size(); ++i) {
    const std::uint64_t even = left / (counts.size() - i);
    if (counts[i] > even)
      return even;
    left -= counts[i];
  }
  return most;
}

}  // namespace

bool selects(const DistributionKey& key, const Digest& robot) {
  return key.sources.empty() || std::binary_search(key.sources.begin(), key.sources.end(), robot);
}

std::vector<store::ExperienceSummary> selected_experience(
    const DistributionKey& key, const std::vector<store::ExperienceSummary>& experience) {
  std::vector<store::ExperienceSummary> selected;
  for (const store::ExperienceSummary& source : experience)
    if (selects(key, source.robot) && (source.paths > 0 || source.robot == key.robot))
      selected.push_back(source);
  return selected;
}

std::uint64_t count_paths(const std::vector<store::ExperienceSummary>& experience) {
  std::uint64_t count = 0;
  for (const store::ExperienceSummary& source : experience)
    count += source.paths;
  return count;
}

std::vector<std::uint64_t> share_paths(const std::vector<std::uint64_t>& paths_of_source,
                                       std::uint64_t most, Weighting weighting) {
  std::vector<std::uint64_t> shares = paths_of_source;
  const std::uint64_t total = std::accumulate(shares.begin(), shares.end(), std::uint64_t{0});
  if (total <= most)
    return shares;
  const std::uint64_t even = even_limit(paths_of_source, most);
  for (std::uint64_t& share : shares)
    if (share > 0)
      share = std::max<std::uint64_t>(
          weighting == Weighting::Sources ? std::min(share, even) : share * most / total, 1);
  return shares;
}

}  // namespace kinship::fitting
