#include "client/experiments/pipeline/side_study.hpp"

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr char kSeparator = '|';

/// One cell per pair of robots, all with one profile.
std::vector<WishedCell> cells_of_pairs(const Study& study, const std::string& variant,
                                       const std::string& profile, const std::string& task) {
  std::vector<WishedCell> cells;
  for (std::size_t target = 0; target < study.robots.size(); ++target)
    for (std::size_t source = 0; source < study.robots.size(); ++source)
      cells.push_back({cell_name(study.robots[source].model, variant),
                       {task, target, {source}, profile},
                       study.settings.overshoot,
                       study.guided_share});
  return cells;
}

void append(std::vector<WishedCell> more, std::vector<WishedCell>& cells) {
  cells.insert(cells.end(), more.begin(), more.end());
}

SideStudy pooled(const Study& study) {
  SideStudy side{
      "pooled", "experience of all other robots, and of all with the robot's own", {}, {}};
  for (std::size_t target = 0; target < study.robots.size(); ++target) {
    DistributionWish others{study.name, target, {}, "default"}, all = others;
    for (std::size_t source = 0; source < study.robots.size(); ++source) {
      all.sources.push_back(source);
      if (source != target)
        others.sources.push_back(source);
    }
    side.cells.push_back(
        {cell_name(kOthers, "pooled"), others, study.settings.overshoot, study.guided_share});
    side.cells.push_back(
        {cell_name(kAll, "pooled"), all, study.settings.overshoot, study.guided_share});
  }
  return side;
}

SideStudy components(const Study& study) {
  SideStudy side{"components", "20, 50 and 100 components", {}, {}};
  for (const char* const count : {"20", "50", "100"})
    append(cells_of_pairs(study, std::string("K = ") + count,
                          std::string("default,components=") + count, study.name),
           side.cells);
  return side;
}

/// To the letter: neither uniform samples nor overshoot.
SideStudy paper(const Study& study) {
  SideStudy side{"paper", "the profile that does what the paper says and nothing else", {}, {}};
  side.cells = cells_of_pairs(study, "paper", "paper", study.name);
  for (WishedCell& cell : side.cells) {
    cell.overshoot = 1;
    cell.share = 1;
  }
  return side;
}

SideStudy scenes(const Study& study) {
  SideStudy side{"scenes", "without the recorded scenes", {}, {}};
  side.cells =
      cells_of_pairs(study, "no recorded scenes", "default,avoid_recorded_scene=0", study.name);
  return side;
}

SideStudy sizes(const Study& study) {
  SideStudy side{"sizes", "learning sets of 10, 50, 100 and more instances", {}, {}};
  for (const std::size_t count : {10U, 50U, 100U}) {
    if (count >= study.learning_instances)
      continue;
    const std::string task = study.name + "_" + std::to_string(count);
    side.shortened.push_back({task, count});
    append(cells_of_pairs(study, std::to_string(count) + " instances", "default", task),
           side.cells);
  }
  return side;
}

}  // namespace

std::string cell_name(const std::string& sources, const std::string& variant) {
  return sources + kSeparator + variant;
}

std::string variant_of(const std::string& cell_name) {
  const std::size_t separator = cell_name.find(kSeparator);
  return separator == std::string::npos ? "" : cell_name.substr(separator + 1);
}

std::vector<SideStudy> side_studies(const Study& study) {
  return {pooled(study), components(study), paper(study), scenes(study), sizes(study)};
}

SideStudy find_side_study(const Study& study, std::string_view name) {
  std::string names;
  for (SideStudy& side : side_studies(study)) {
    if (side.name == name)
      return side;
    names += (names.empty() ? "" : ", ") + side.name;
  }
  throw Failure(ErrorCode::NotFound,
                "no side study '" + std::string(name) + "'; there are " + names);
}

}  // namespace kinship::experiments
