#include <utility>

#include "client/experiments/studies/cobot_studies.hpp"
#include "client/experiments/studies/planar_studies.hpp"
#include "client/experiments/studies/study.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {

std::string_view name_of(InstanceSet set) {
  switch (set) {
    case InstanceSet::Calibration:
      return "calibration";
    case InstanceSet::Learning:
      return "learning";
    case InstanceSet::Tuning:
      return "tuning";
    case InstanceSet::Test:
      break;
  }
  return "test";
}

std::uint64_t seed_of(InstanceSet set, std::size_t robot) {
  switch (set) {
    case InstanceSet::Calibration:
      return 1000;
    case InstanceSet::Learning:
      return 2000 + robot;
    case InstanceSet::Tuning:
      return 3000;
    case InstanceSet::Test:
      break;
  }
  return 4000;
}

const std::vector<Study>& studies() {
  static const std::vector<Study> kStudies = [] {
    std::vector<Study> all = planar_studies();
    for (Study& study : cobot_studies())
      all.push_back(std::move(study));
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

}  // namespace kinship::experiments
