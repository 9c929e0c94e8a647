#include <algorithm>
#include <map>
#include <utility>

#include "client/experiments/studies/study.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {

InstanceSet parse_instance_set(std::string_view name) {
  static const std::map<std::string_view, InstanceSet> kSets = {
      {"calibration", InstanceSet::Calibration},
      {"learning", InstanceSet::Learning},
      {"tuning", InstanceSet::Tuning},
      {"test", InstanceSet::Test},
      {"order", InstanceSet::Order}};
  const auto found = kSets.find(name);
  if (found == kSets.end())
    throw Failure(ErrorCode::InvalidInput, "no set of instances '" + std::string(name) + "'");
  return found->second;
}

std::uint64_t seed_of(InstanceSet set, std::size_t robot) {
  switch (set) {
    case InstanceSet::Calibration:
      return 1000;
    case InstanceSet::Learning:
      return 2000 + robot;
    case InstanceSet::Tuning:
      return 3000;
    case InstanceSet::Order:
      return 5000;
    case InstanceSet::Test:
      break;
  }
  return 4000;
}

const std::vector<Study>& studies() {
  static const std::vector<Study> kStudies = [] {
    std::vector<Study> all = planar_studies();
    for (std::vector<Study> more :
         {cobot_studies(), furniture_studies(), kitting_studies(), dear_studies()})
      std::ranges::move(more, std::back_inserter(all));
    return all;
  }();
  return kStudies;
}

const Study& find_study(std::string_view name) {
  std::string names;
  for (const Study& study : studies()) {
    if (study.name == name)
      return study;
    names += (names.empty() ? "" : ", ") + study.name;
  }
  throw Failure(ErrorCode::NotFound, "no study '" + std::string(name) + "'; there are " + names);
}

std::vector<std::string> families() {
  std::vector<std::string> names;
  for (const Study& study : studies())
    if (!study.family.empty() && std::ranges::find(names, study.family) == names.end())
      names.push_back(study.family);
  return names;
}

std::vector<const Study*> find_studies(std::string_view name) {
  std::vector<const Study*> found;
  for (const Study& study : studies())
    if (study.family == name && !name.empty())
      found.push_back(&study);
  if (found.empty())
    found.push_back(&find_study(name));
  return found;
}

}  // namespace kinship::experiments
