#include "client/experiments/pipeline/side_study.hpp"

#include "client/experiments/formatted.hpp"
#include "client/experiments/pipeline/peer_study.hpp"
#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

constexpr char kSeparator = '|';
constexpr const char* kUniformly = "uniform";

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
    for (WishedCell& cell : side.cells)
      cell.guide.reset();
  }
  return side;
}

SideStudy components(const Study& study) {
  SideStudy side{
      "components", "20, 50 and 100 components, and as many as held-out paths want", {}, {}};
  for (const char* const count : {"20", "50", "100", "auto"})
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
    std::vector<WishedCell> cells =
        cells_of_pairs(study, std::to_string(count) + " instances", "default", task);
    for (WishedCell& cell : cells)
      cell.guide.reset();
    append(std::move(cells), side.cells);
  }
  return side;
}

/// Uniform sampling alone. The ratio is that of uniform sampling as the main tables have it.
SideStudy overshoot(const Study& study) {
  SideStudy side{
      "overshoot", "uniform sampling with overshoot, against uniform sampling without", {}, {}};
  for (const double factor : {1.5, 2.0})
    for (std::size_t robot = 0; robot < study.robots.size(); ++robot)
      side.cells.push_back({cell_name(kUniformly, formatted("uniform, overshoot %g", factor)),
                            {study.name, robot, {}, ""},
                            factor,
                            0});
  return side;
}

/// What following one's own path through one's own self-motions costs, and what inverse kinematics
/// makes of it.
SideStudy inverse(const Study& study) {
  SideStudy side{
      "inverse", "own paths through inverse kinematics, like those of other robots", {}, {}};
  for (std::size_t robot = 0; robot < study.robots.size(); ++robot)
    side.cells.push_back({cell_name(study.robots[robot].model, "own through inverse kinematics"),
                          {study.name, robot, {robot}, "default,take_over=0"},
                          study.settings.overshoot,
                          study.guided_share});
  return side;
}

/// What each guide is worth by itself, and what needs no experience at all.
SideStudy guides(const Study& study) {
  SideStudy side{"guides",
                 "the mixture alone, stored ways of the hand alone, and what needs no experience",
                 {},
                 {}};
  for (const auto& [guide, variant] :
       {std::pair{Guide::Mixture, "mixture"}, std::pair{Guide::Ways, "stored ways"}}) {
    std::vector<WishedCell> cells = cells_of_pairs(study, variant, "default", study.name);
    for (WishedCell& cell : cells)
      cell.guide = guide;
    append(std::move(cells), side.cells);
  }
  const std::optional<double> as_planners_have_it;
  for (const auto& [retreat_m, variant] :
       {std::pair{std::optional(0.0), "straight way of the hand"},
        std::pair{as_planners_have_it, "retreat"}})
    for (std::size_t robot = 0; robot < study.robots.size(); ++robot) {
      WishedCell cell{cell_name(kNobody, variant),
                      {study.name, robot, {robot}, "default"},
                      study.settings.overshoot,
                      study.guided_share};
      cell.guide = Guide::Retreat;
      cell.retreat_m = retreat_m;
      side.cells.push_back(std::move(cell));
    }
  return side;
}

/// What bounds the worth of samples: those around an answer to the very query.
SideStudy oracle(const Study& study) {
  SideStudy side{"oracle", "samples around a path that answers the query itself", {}, {}};
  for (const double deviation : {0.1, 0.3})
    for (std::size_t robot = 0; robot < study.robots.size(); ++robot) {
      WishedCell cell{cell_name(kNobody, formatted("own answer, %g about it", deviation)),
                      {study.name, robot, {}, ""},
                      study.settings.overshoot,
                      0};
      cell.oracle_deviation = deviation;
      side.cells.push_back(std::move(cell));
    }
  return side;
}

/// The same distributions in the hands of another planner.
SideStudy roadmap(const Study& study) {
  SideStudy side{"roadmap", "Repetition Roadmap over the components, then the trees", {}, {}};
  side.cells = cells_of_pairs(study, "Repetition Roadmap", "default", study.name);
  for (WishedCell& cell : side.cells)
    cell.planner = guided::PlannerKind::Roadmap;
  return side;
}

/// The robot's own learning set in the hands of others.
SideStudy ompl_peers(const Study& study) {
  SideStudy side{
      "peers",
      "experience planners of OMPL 1.5 with the robot's own learning set. They plan from "
      "scratch in a second thread: both threads ask by turns until one has a path, and "
      "the checks of both count, or those of the thread that has it",
      {},
      {},
      true};
  for (const Peer& peer : peers())
    for (const std::string& variant : variants_of(peer))
      for (std::size_t robot = 0; robot < study.robots.size(); ++robot)
        side.cells.push_back({cell_name(study.robots[robot].model, variant),
                              {study.name, robot, {robot}, ""},
                              1,
                              0});
  return side;
}

}  // namespace

std::string cell_name(const std::string& sources, const std::string& variant) {
  return sources + kSeparator + variant;
}

std::string uniform_name(double overshoot) {
  return overshoot == 1 ? kUniformly : formatted("%s f%g", kUniformly, overshoot);
}

std::vector<SideStudy> side_studies(const Study& study) {
  std::vector<SideStudy> sides = {
      pooled(study),  components(study), paper(study),   scenes(study), sizes(study),
      inverse(study), overshoot(study),  roadmap(study), guides(study), oracle(study)};
  if (!study.is_constrained)
    sides.push_back(ompl_peers(study));
  return sides;
}

SideStudy find_side_study(const Study& study, std::string_view name) {
  std::string names;
  for (SideStudy& side : side_studies(study)) {
    if (side.name == name)
      return side;
    names += (names.empty() ? "" : ", ") + side.name;
  }
  throw Failure(ErrorCode::NotFound, "study '" + study.name + "' has no side study '" +
                                         std::string(name) + "'; there are " + names);
}

}  // namespace kinship::experiments
