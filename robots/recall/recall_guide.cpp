#include "robots/recall/recall_guide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/experience_guide.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::recall {
namespace {

constexpr double kRadian_m = 0.3;   // see planning::pose_distance_m
constexpr double kYawWeight = 0.3;  // of a turn of the whole arm, which changes little
constexpr int kBins = 16;
constexpr std::size_t kMostRanked = 64,
                      kFewestRanked = 16;  // paths in a mode: of all goals; of one
constexpr std::size_t kLearnedPaths = 64;  // of a query: farther ones may not have been tried
constexpr double kLeastAlike = 0.02;
constexpr double kFarStart = 2;  // joint units: no path starts so near as to tell what it is worth

Eigen::Isometry3d inverse_of(const Eigen::Isometry3d& T) { return T.inverse(Eigen::Isometry); }

/// Without the turn about the base's z axis that brings its position into the x z plane.
/// \param azimuth  out: that turn, rad.
Eigen::Isometry3d facing(const Eigen::Isometry3d& T, double& azimuth) {
  azimuth = std::atan2(T.translation().y(), T.translation().x());
  return Eigen::AngleAxisd(-azimuth, Eigen::Vector3d::UnitZ()) * T;
}

double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::ranges::nth_element(values, middle);
  return *middle;
}

}  // namespace

std::vector<std::optional<Eigen::Isometry3d>> find_anchors(
    const std::vector<std::string>& anchors, const std::vector<SceneObject>& objects) {
  std::vector<std::optional<Eigen::Isometry3d>> found(anchors.size());
  for (std::size_t i = 0; i < anchors.size(); ++i) {
    const auto object = std::ranges::find(objects, anchors[i], &SceneObject::name);
    if (object != objects.end())
      found[i] = object->T_task_object;
  }
  return found;
}

RecallGuide::RecallGuide(const kinematics::Chain& chain, RecallLibrary library)
    : warper_(chain), library_(std::move(library)), descent_(chain) {
  for (const RecallQuery& query : library_.queries)
    if (query.start.size() != chain.dof())
      throw std::invalid_argument("RecallGuide: the library has " +
                                  std::to_string(query.start.size()) + " joints, the robot " +
                                  std::to_string(chain.dof()));
  if (!library_.modes.empty())
    frame_ = std::max(library_.modes.front().frame, kTaskFrame);  // of the best one
  for (const RecallQuery& query : library_.queries)
    ends_.push_back(ends_of(query.start, kinematics::T_base_transfer(chain, query.goal), query.goal,
                            T_base_frame(query.T_task_base, {query.T_task_anchors.begin(),
                                                             query.T_task_anchors.end()})));
  for (const RecallPath& path : library_.paths) {
    paths_.push_back(warper_.posed(path.waypoints));
    lengths_.push_back(planning::path_length(path.waypoints));
    Ends ends = ends_[path.query];
    ends.goal = path.waypoints.rightCols<1>();  // maybe another posture at the same pose
    path_ends_.push_back(std::move(ends));
  }
  for (const Metric metric : {Metric::Configurations, Metric::Poses})
    learn(metric);
}

/// Of the frame that distances are measured in, in the base link: the task frame where it is not
/// there.
Eigen::Isometry3d RecallGuide::T_base_frame(
    const Eigen::Isometry3d& T_task_base,
    const std::vector<std::optional<Eigen::Isometry3d>>& T_task_anchors) const {
  Eigen::Isometry3d T = inverse_of(T_task_base);
  if (frame_ >= kFirstAnchor && T_task_anchors[frame_ - kFirstAnchor])
    T = T * *T_task_anchors[frame_ - kFirstAnchor];
  return T;
}

RecallGuide::Ends RecallGuide::ends_of(const Eigen::VectorXd& start,
                                       const Eigen::Isometry3d& T_base_goal,
                                       const Eigen::VectorXd& goal,
                                       const Eigen::Isometry3d& T_base_frame) const {
  Ends ends{start, goal, {}, 0, inverse_of(T_base_frame) * T_base_goal};
  ends.T_facing_goal = warper_.yaw_joint() >= 0 ? facing(T_base_goal, ends.azimuth) : T_base_goal;
  return ends;
}

RecallGuide::Distances RecallGuide::distances(Metric metric, const Ends& a, const Ends& b) const {
  double of_starts = 0, of_configurations = 0;  // squared
  for (Eigen::Index i = 0; i < a.start.size(); ++i) {
    const double turns = warper_.turns(i, a.start[i], b.start[i]);
    const double weight = i == warper_.yaw_joint() ? kYawWeight * kYawWeight : 1;
    const double start = b.start[i] - a.start[i] - turns, goal = b.goal[i] - a.goal[i] - turns;
    of_starts += weight * start * start;
    of_configurations += weight * goal * goal;
  }
  if (metric == Metric::Configurations)
    return {std::sqrt(of_starts), std::sqrt(of_configurations)};
  const double of_goals =
      (planning::pose_distance_m(a.T_facing_goal, b.T_facing_goal) +
       planning::pose_distance_m(a.T_frame_goal, b.T_frame_goal)) /
          (2 * kRadian_m) +
      kYawWeight * std::abs(std::remainder(a.azimuth - b.azimuth, planning::kTurn));
  return {std::sqrt(of_starts), of_goals};
}

/// How often each mode worked, by distance.
void RecallGuide::learn(Metric metric) {
  Learned& learned = learned_.at(static_cast<std::size_t>(metric));
  const auto& bits = metric == Metric::Configurations ? library_.solves : library_.reaches;
  for (std::size_t path = 0; path < paths_.size(); ++path)
    for (std::size_t mode = 0; mode < library_.modes.size(); ++mode)
      for (std::size_t query = 0; query < ends_.size(); ++query)
        learned.works.push_back(bit_of(bits, library_.bit(query, path, mode)) ? 1 : 0);
  struct Pair {
    double distance;
    std::size_t query, path;
  };
  std::vector<Pair> pairs;
  std::vector<double> nearest;
  for (std::size_t query = 0; query < ends_.size(); ++query) {
    double least = std::numeric_limits<double>::infinity();
    for (const std::size_t path : nearest_paths(metric, query, kLearnedPaths)) {
      pairs.push_back({distances(metric, path_ends_[path], ends_[query]).together(), query, path});
      least = std::min(least, pairs.back().distance);
    }
    nearest.push_back(least);
  }
  constexpr double kLeastNear = 0.1;
  if (!nearest.empty())
    learned.near = std::max(kLeastNear, std::min(median(nearest), 1e3));
  std::ranges::sort(pairs, {}, &Pair::distance);
  learned.worked.assign(library_.modes.size(), {});
  const auto end_of = [&](int bin) {
    const double part = static_cast<double>(bin) / kBins;
    return static_cast<std::size_t>(part * part * part * static_cast<double>(pairs.size()));
  };
  for (int bin = 0; bin < kBins; ++bin) {
    const std::size_t first = end_of(bin), last = end_of(bin + 1);
    if (bin + 1 < kBins)
      learned.edges.push_back(last < pairs.size() ? pairs[last].distance : 0);
    for (std::size_t mode = 0; mode < library_.modes.size(); ++mode) {
      constexpr double kBefore = 0.1;  // that one more would have worked, before any did
      double worked = kBefore;
      for (std::size_t i = first; i < last; ++i)
        worked += works(metric, pairs[i].path, mode)[pairs[i].query];
      learned.worked[mode].push_back(worked / static_cast<double>(last - first + 1));
    }
  }
}

std::vector<std::size_t> RecallGuide::nearest_paths(Metric metric, std::size_t query,
                                                    std::size_t count) const {
  std::vector<std::pair<double, std::size_t>> found;
  for (std::size_t path = 0; path < paths_.size(); ++path)
    if (!answers(path, query))
      found.emplace_back(distances(metric, path_ends_[path], ends_[query]).together(), path);
  count = std::min(count, found.size());
  std::ranges::nth_element(found, found.begin() + static_cast<std::ptrdiff_t>(count));
  std::vector<std::size_t> nearest;
  for (std::size_t i = 0; i < count; ++i)
    nearest.push_back(found[i].second);
  return nearest;
}

double RecallGuide::chance_at(Metric metric, std::size_t mode, double distance) const {
  const Learned& learned = learned_.at(static_cast<std::size_t>(metric));
  const auto bin = std::ranges::lower_bound(learned.edges, distance) - learned.edges.begin();
  return learned.worked[mode][static_cast<std::size_t>(bin)];
}

bool RecallGuide::is_usable(const Query& query, std::size_t mode) const {
  const std::uint32_t frame = library_.modes[mode].frame;
  return frame < kFirstAnchor || query.T_task_anchors[frame - kFirstAnchor].has_value();
}

std::optional<Eigen::VectorXd> RecallGuide::goal_at_pose(const Query& query,
                                                         std::size_t path) const {
  constexpr int kIterations = 30;
  const Ends& ends = path_ends_[path];
  inverse::JointVector q = ends.goal;
  for (Eigen::Index i = 0; i < q.size(); ++i)
    q[i] += warper_.turns(i, ends.start[i], query.start[i]);
  if (const Eigen::Index yaw = warper_.yaw_joint(); yaw >= 0) {
    double azimuth = 0;
    facing(query.T_base_goal, azimuth);
    q[yaw] += std::remainder(azimuth - ends.azimuth, planning::kTurn);
  }
  const Eigen::VectorXd lower = query.bounds.row(0), upper = query.bounds.row(1);
  q = q.cwiseMax(lower).cwiseMin(upper);
  descent_.run(query.T_base_goal, inverse::Descent::Limits::Hold, kIterations, q);
  if ((q.array() < lower.array()).any() || (q.array() > upper.array()).any() ||
      !inverse::reaches(warper_.chain(), query.T_base_goal, q))
    return std::nullopt;
  return q;
}

std::optional<Warp> RecallGuide::warp(const Query& query, const Candidate& candidate) const {
  const RecallQuery& from = library_.queries[library_.paths[candidate.path].query];
  const WarpMode& mode = library_.modes[candidate.mode];
  WarpTarget target{query.bounds, query.start, {}, {}, query.T_base_goal, query.constraint};
  if (candidate.goal >= 0) {
    target.goal = query.goals.col(candidate.goal);
    target.T_base_goal = kinematics::T_base_transfer(warper_.chain(), target.goal);
  } else if (const auto goal = goal_at_pose(query, candidate.path)) {
    target.goal = *goal;
  } else {
    return std::nullopt;
  }
  target.T_base_start = kinematics::T_base_transfer(warper_.chain(), query.start);
  std::optional<Eigen::Isometry3d> T_new_old;
  if (mode.frame != kGoalFrame) {
    Eigen::Isometry3d T_base_new = inverse_of(query.T_task_base);
    Eigen::Isometry3d T_base_old = inverse_of(from.T_task_base);
    if (mode.frame >= kFirstAnchor) {
      const std::size_t anchor = mode.frame - kFirstAnchor;
      if (!query.T_task_anchors[anchor])
        return std::nullopt;
      T_base_new = T_base_new * *query.T_task_anchors[anchor];
      T_base_old = T_base_old * from.T_task_anchors[anchor];
    }
    T_new_old = T_base_new * inverse_of(T_base_old);
  }
  return Warp(warper_, paths_[candidate.path], std::move(target), kWarpBlends.at(mode.blend),
              T_new_old);
}

Ranking::Ranking(const RecallGuide& guide, const Query& query, double trust)
    : guide_(guide),
      trust_(trust),
      metric_(query.goals.cols() > 0 ? RecallGuide::Metric::Configurations
                                     : RecallGuide::Metric::Poses) {
  const std::size_t goals = static_cast<std::size_t>(std::max<Eigen::Index>(query.goals.cols(), 1));
  for (std::size_t goal = 0; goal < goals; ++goal)
    add_goal(query, query.goals.cols() > 0 ? static_cast<Eigen::Index>(goal) : -1);
}

void Ranking::add_goal(const Query& query, Eigen::Index goal) {
  const RecallLibrary& library = guide_.library_;
  const kinematics::Chain& chain = guide_.warper_.chain();
  const Eigen::VectorXd q = goal >= 0 ? Eigen::VectorXd(query.goals.col(goal)) : query.start;
  const RecallGuide::Ends ends = guide_.ends_of(
      query.start, goal >= 0 ? kinematics::T_base_transfer(chain, q) : query.T_base_goal, q,
      guide_.T_base_frame(query.T_task_base, query.T_task_anchors));
  const double near = guide_.learned_.at(static_cast<std::size_t>(metric_)).near;
  std::vector<RecallGuide::Distances> distances;
  double least_start = std::numeric_limits<double>::infinity();
  for (const RecallGuide::Ends& recorded : guide_.ends_) {
    distances.push_back(guide_.distances(metric_, recorded, ends));
    least_start = std::min(least_start, distances.back().start);
  }
  Group group;
  group.trust = trust_ / (1 + least_start / kFarStart);
  for (std::size_t i = 0; i < library.queries.size(); ++i) {
    const double distance = distances[i].together(least_start) / near;
    const double weight = std::exp(-distance * distance);
    if (query.without != library.queries[i].report && weight > kLeastAlike)
      group.alike.push_back({i, weight});
  }
  std::vector<std::pair<double, std::size_t>> paths;
  for (std::size_t path = 0; path < library.paths.size(); ++path) {
    if (query.without == library.queries[library.paths[path].query].report)
      continue;
    const RecallGuide::Distances from =
        metric_ == RecallGuide::Metric::Poses
            ? distances[library.paths[path].query]
            : guide_.distances(metric_, guide_.path_ends_[path], ends);
    paths.emplace_back(from.together(least_start), path);
  }
  const std::size_t goals = static_cast<std::size_t>(std::max<Eigen::Index>(query.goals.cols(), 1));
  const std::size_t most = std::max(kMostRanked / goals, kFewestRanked) / library.modes.size() + 1;
  const std::size_t kept = std::min(most, paths.size());
  std::ranges::partial_sort(paths, paths.begin() + static_cast<std::ptrdiff_t>(kept));
  for (std::size_t i = 0; i < kept; ++i)
    for (std::size_t mode = 0; mode < library.modes.size(); ++mode)
      if (guide_.is_usable(query, mode))
        group.ranked.push_back({{paths[i].second, mode, goal, paths[i].first}});
  rank(group);
  groups_.push_back(std::move(group));
}

/// The chance of each candidate of a goal, as far as recorded queries tell.
void Ranking::rank(Group& group) const {
  for (Ranked& ranked : group.ranked) {
    double worked = guide_.chance_at(metric_, ranked.candidate.mode, ranked.candidate.distance);
    double weights = 1;
    const std::uint8_t* const works =
        guide_.works(metric_, ranked.candidate.path, ranked.candidate.mode);
    for (const auto& [query, weight] : group.alike)
      if (!guide_.answers(ranked.candidate.path, query)) {
        weights += weight;
        worked += works[query] * weight;
      }
    ranked.chance = group.trust * ranked.goal_is_free * worked / weights;
  }
}

std::optional<Candidate> Ranking::next(double step) {
  constexpr double kOfSearch = 0.7;  // of its checks, which a path that works saves
  last_ = nullptr;
  double best = 0;
  for (Group& group : groups_)
    for (Ranked& ranked : group.ranked) {
      const double chance = doubt_ * ranked.chance,
                   checks = guide_.length(ranked.candidate.path) / step;
      const double failed = (1 - chance) * guide_.library_.try_checks;
      if (ranked.is_tried || chance * (kOfSearch * guide_.library_.search_checks - checks) < failed)
        continue;
      const double worth = chance / (chance * checks + failed);
      if (worth > best) {
        best = worth;
        last_ = &ranked;
        last_chance_ = chance;
        of_last_ = &group;
      }
    }
  return last_ != nullptr ? std::optional(last_->candidate) : std::nullopt;
}

void Ranking::fail_at_goal() {
  constexpr double kPosture = 0.7;    // joint units: postures alike
  constexpr double kCollides = 0.95;  // chance that one collides, where an equal one does
  last_->is_tried = true;
  const Candidate& failed = last_->candidate;
  const Eigen::VectorXd& posture = guide_.path_ends_[failed.path].goal;
  for (Ranked& ranked : of_last_->ranked) {
    const double d = (guide_.path_ends_[ranked.candidate.path].goal - posture).norm() / kPosture;
    const bool is_same = failed.goal >= 0 || ranked.candidate.path == failed.path;
    ranked.goal_is_free *= is_same ? 0 : 1 - kCollides * std::exp(-d * d);
  }
  rank(*of_last_);
}

void Ranking::fail() {
  constexpr double kUnlike = 0.3;  // a query is less alike if what solved it does not work here
  constexpr double kDoubt = 0.9;   // each failure says that this query is unlike those recorded
  doubt_ *= kDoubt;
  last_->is_tried = true;
  const Candidate& candidate = last_->candidate;
  const std::uint8_t* const works = guide_.works(metric_, candidate.path, candidate.mode);
  for (auto& [query, weight] : of_last_->alike)
    if (works[query] != 0)
      weight *= kUnlike;
  rank(*of_last_);
}

}  // namespace kinship::recall
