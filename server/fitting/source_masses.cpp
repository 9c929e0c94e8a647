#include "server/fitting/source_masses.hpp"

#include <algorithm>
#include <numeric>

namespace kinship::fitting {
namespace {

double part_of(const PooledSource& source) {
  return static_cast<double>(std::min(source.paths, kFullPartPaths)) /
         static_cast<double>(kFullPartPaths);
}

double least_own_mass(std::uint64_t paths) {
  const std::uint64_t above = std::clamp(paths, kFullPartPaths, kOwnHalfPaths) - kFullPartPaths;
  return 0.5 * static_cast<double>(above) / static_cast<double>(kOwnHalfPaths - kFullPartPaths);
}

}  // namespace

std::vector<double> source_masses(const std::vector<PooledSource>& sources) {
  std::vector<double> masses;
  masses.reserve(sources.size());
  for (const PooledSource& source : sources)
    masses.push_back(part_of(source));
  const double total = std::accumulate(masses.begin(), masses.end(), 0.0);
  if (total == 0)
    return masses;
  for (double& mass : masses)
    mass /= total;

  const auto own = std::find_if(sources.begin(), sources.end(),
                                [](const PooledSource& source) { return source.own; });
  if (own == sources.end())
    return masses;
  const auto index = static_cast<std::size_t>(own - sources.begin());
  const double before = masses[index];
  const double wanted = least_own_mass(own->paths);
  if (before >= wanted)
    return masses;
  for (double& mass : masses)
    mass *= (1 - wanted) / (1 - before);
  masses[index] = wanted;
  return masses;
}

}  // namespace kinship::fitting
