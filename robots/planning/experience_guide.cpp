#include "robots/planning/experience_guide.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>
#include <stdexcept>
#include <utility>

#include "robots/kinematics/forward_kinematics.hpp"
#include "robots/planning/planning_bounds.hpp"

namespace kinship::planning {
namespace {

constexpr int kCount = inverse::kLanes;
constexpr int kStepsPerPose = 3;
constexpr double kPull = 0.1;  // of the way to the straight line, per pose
constexpr double kTolerance_m = 0.04;
constexpr double kTolerance_rad = 0.25;

/// Up to eight tracks side by side.
class Lanes {
 public:
  Lanes(const inverse::Solver& solver, std::span<const PoseTrack> tracks)
      : solver_(solver), chain_(solver.lanes()), tracks_(tracks) {
    for (int lane = 0; lane < kCount; ++lane) {
      const PoseTrack& track = of(lane);
      for (int j = 0; j < chain_.dof; ++j)
        batch_.q[j][lane] = lane_value(j, track.begin[j]);
    }
  }

  std::vector<Track> run() {
    std::vector<Track> followed(tracks_.size());
    std::size_t most = 0;
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      followed[i].configurations.resize(
          chain_.dof, static_cast<Eigen::Index>(tracks_[i].T_base_transfer.size()));
      followed[i].configurations.col(0) = tracks_[i].begin;
      most = std::max(most, tracks_[i].T_base_transfer.size());
    }
    std::vector<Eigen::Index> kept(tracks_.size(), 1);
    for (std::size_t pose = 1; pose < most; ++pose) {
      step_to(pose);
      for (std::size_t i = 0; i < tracks_.size(); ++i)
        if (pose < tracks_[i].T_base_transfer.size() && is_near(static_cast<int>(i)))
          followed[i].configurations.col(kept[i]++) = configuration(static_cast<int>(i));
    }
    for (std::size_t i = 0; i < tracks_.size(); ++i) {
      followed[i].configurations.conservativeResize(Eigen::NoChange, kept[i]);
      followed[i].gap = (followed[i].configurations.rightCols<1>() - tracks_[i].towards).norm();
    }
    return followed;
  }

 private:
  /// Lanes beyond the tracks repeat the last one.
  const PoseTrack& of(int lane) const {
    return tracks_[std::min(static_cast<std::size_t>(lane), tracks_.size() - 1)];
  }
  double lane_value(int joint, double q) const {
    return q * chain_.joints[joint].scale + chain_.joints[joint].offset;
  }

  void step_to(std::size_t pose) {
    for (int lane = 0; lane < kCount; ++lane) {
      const PoseTrack& track = of(lane);
      const std::size_t last = track.T_base_transfer.size() - 1;
      const std::size_t at = std::min(pose, last);
      const Eigen::Isometry3d& T = track.T_base_transfer[at];
      for (int i = 0; i < 12; ++i)
        batch_.target[i][lane] = i < 9 ? T(i / 3, i % 3) : T(i - 9, 3) / chain_.length_m;
      const double share = static_cast<double>(at) / static_cast<double>(last);
      for (int j = 0; j < chain_.dof; ++j) {
        const double line = track.begin[j] + share * (track.towards[j] - track.begin[j]);
        batch_.q[j][lane] += kPull * (lane_value(j, line) - batch_.q[j][lane]);
      }
    }
    for (int i = 0; i < kStepsPerPose; ++i)
      solver_.kernels().step(chain_, inverse::LaneLimits::Hold, batch_);
  }

  /// Before the last step, which can only have come nearer.
  bool is_near(int lane) const {
    const double tolerance = std::min(kTolerance_m / chain_.length_m, kTolerance_rad);
    return batch_.squared[lane] < tolerance * tolerance;
  }

  Eigen::VectorXd configuration(int lane) const {
    Eigen::VectorXd q(chain_.dof);
    for (int j = 0; j < chain_.dof; ++j)
      q[j] = (batch_.q[j][lane] - chain_.joints[j].offset) / chain_.joints[j].scale;
    return q;
  }

  const inverse::Solver& solver_;
  const inverse::LaneChain& chain_;
  std::span<const PoseTrack> tracks_;
  inverse::LaneBatch batch_;
};

constexpr double kRadian_m = 0.3;
constexpr double kGoalAlone = 0.5;  // share of the path after which it moves with the goal alone

/// The configurations of a track that lie within bounds, turning joints moved by full turns.
void keep_within(const Eigen::Matrix2Xd& bounds, const std::vector<bool>& turning, Track& track) {
  Eigen::Index kept = 0;
  for (Eigen::Index i = 0; i < track.configurations.cols(); ++i)
    if (const auto q = turned_into(bounds, turning, track.configurations.col(i)))
      track.configurations.col(kept++) = *q;
  track.configurations.conservativeResize(Eigen::NoChange, kept);
}

}  // namespace

std::vector<Track> follow(const inverse::Solver& solver, std::span<const PoseTrack> tracks) {
  std::vector<Track> followed;
  followed.reserve(tracks.size());
  for (std::size_t first = 0; first < tracks.size(); first += kCount) {
    auto some =
        Lanes(solver, tracks.subspan(first, std::min<std::size_t>(kCount, tracks.size() - first)))
            .run();
    std::ranges::move(some, std::back_inserter(followed));
  }
  return followed;
}

double pose_distance_m(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b) {
  const double cosine = ((a.linear().transpose() * b.linear()).trace() - 1) / 2;
  return (a.translation() - b.translation()).norm() +
         kRadian_m * std::acos(std::clamp(cosine, -1.0, 1.0));
}

Eigen::Isometry3d blended(const Eigen::Isometry3d& a, const Eigen::Isometry3d& b, double weight) {
  if (weight <= 0)
    return a;
  if (weight >= 1)
    return b;
  const Eigen::Quaterniond from(a.linear());
  Eigen::Quaterniond to(b.linear());
  if (from.dot(to) < 0)
    to.coeffs() *= -1;
  Eigen::Isometry3d pose = Eigen::Isometry3d::Identity();
  pose.linear() = Eigen::Quaterniond((1 - weight) * from.coeffs() + weight * to.coeffs())
                      .normalized()
                      .toRotationMatrix();
  pose.translation() = (1 - weight) * a.translation() + weight * b.translation();
  return pose;
}

PosePath retreat(double distance_m) {
  constexpr double kRetreating = 0.5;  // share of the path
  PosePath path;
  for (int i = 0; i < kExperiencePoses; ++i) {
    const double left = 1 - i / (kExperiencePoses - 1.0);
    path.poses.emplace_back(
        Eigen::Translation3d(0, 0, -distance_m * std::min(left / kRetreating, 1.0)));
  }
  return path;
}

std::vector<std::size_t> nearest_paths(const std::vector<PosePath>& paths, const PoseQuery& query,
                                       std::size_t count) {
  std::vector<double> distances(paths.size());
  for (std::size_t i = 0; i < paths.size(); ++i)
    distances[i] = pose_distance_m(paths[i].poses.back(), query.T_task_goal) +
                   pose_distance_m(paths[i].poses.front(), query.T_task_start);
  std::vector<std::size_t> order(paths.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  const auto kept = static_cast<std::ptrdiff_t>(std::min(count, order.size()));
  std::ranges::partial_sort(order, order.begin() + kept, [&](std::size_t a, std::size_t b) {
    return distances[a] != distances[b] ? distances[a] < distances[b] : a < b;
  });
  order.resize(static_cast<std::size_t>(kept));
  return order;
}

std::vector<Eigen::Isometry3d> moved_onto(const PosePath& path, const PoseQuery& query) {
  const Eigen::Isometry3d by_start = query.T_task_start * path.poses.front().inverse();
  const Eigen::Isometry3d by_goal = query.T_task_goal * path.poses.back().inverse();
  std::vector<Eigen::Isometry3d> moved;
  moved.reserve(path.poses.size());
  const double last = static_cast<double>(path.poses.size()) - 1;
  for (std::size_t i = 0; i < path.poses.size(); ++i) {
    const double share = static_cast<double>(i) / last;
    moved.push_back(blended(by_start * path.poses[i], by_goal * path.poses[i],
                            std::min(share / kGoalAlone, 1.0)));
  }
  return moved;
}

ExperienceGuide::ExperienceGuide(const kinematics::Chain& chain, TaskExperience experience)
    : chain_(chain), solver_(chain), experience_(std::move(experience)) {
  for (const PosePath& path : experience_.paths)
    if (path.poses.size() < 2)
      throw std::invalid_argument("ExperienceGuide: a path has less than two poses");
}

std::vector<std::size_t> ExperienceGuide::nearest(const PoseQuery& query, std::size_t count,
                                                  const std::optional<Uuid>& without) const {
  if (count == 0)
    return {};
  std::vector<std::size_t> paths =
      nearest_paths(experience_.paths, query, without ? count + 1 : count);
  std::erase_if(paths, [&](std::size_t path) { return experience_.paths[path].path == without; });
  if (paths.size() > count)
    paths.pop_back();
  return paths;
}

std::vector<ExperienceGuide::Choice> ExperienceGuide::choose(const TrackQuery& query,
                                                             const TrackOptions& options) const {
  const Eigen::VectorXd distances = (query.goals.colwise() - query.start).colwise().norm();
  std::vector<Eigen::Index> goals(static_cast<std::size_t>(query.goals.cols()));
  std::iota(goals.begin(), goals.end(), Eigen::Index{0});
  std::ranges::stable_sort(goals, {}, [&](Eigen::Index goal) { return distances[goal]; });
  if (goals.size() > options.tracks)
    goals.resize(options.tracks);

  PoseQuery posed{query.T_task_base * kinematics::T_base_transfer(chain_, query.start), {}};
  std::vector<std::vector<std::size_t>> paths;
  for (const Eigen::Index goal : goals) {
    posed.T_task_goal =
        query.T_task_base * kinematics::T_base_transfer(chain_, query.goals.col(goal));
    paths.push_back(nearest(posed, options.paths, query.without));
  }
  std::vector<Choice> choices;
  for (std::size_t i = 0; i < std::min(goals.size(), options.retreats); ++i)
    choices.push_back({goals[i], std::nullopt});
  for (std::size_t rank = 0; rank < options.paths; ++rank)
    for (std::size_t i = 0; i < goals.size(); ++i)
      if (rank < paths[i].size())
        choices.push_back({goals[i], paths[i][rank]});
  choices.resize(std::min(choices.size(), options.tracks));
  return choices;
}

std::vector<Track> ExperienceGuide::follow(const TrackQuery& query, std::span<const Choice> choices,
                                           const TrackOptions& options) const {
  const PosePath without_experience = retreat(options.retreat_m);
  const Eigen::Isometry3d T_base_task = query.T_task_base.inverse();
  PoseQuery posed{query.T_task_base * kinematics::T_base_transfer(chain_, query.start), {}};
  std::vector<PoseTrack> wanted;
  for (const Choice& choice : choices) {
    const Eigen::VectorXd goal = query.goals.col(choice.goal);
    posed.T_task_goal = query.T_task_base * kinematics::T_base_transfer(chain_, goal);
    const PosePath& path = choice.path ? experience_.paths[*choice.path] : without_experience;
    PoseTrack track{moved_onto(path, posed), goal, query.start};
    std::ranges::reverse(track.T_base_transfer);
    for (Eigen::Isometry3d& pose : track.T_base_transfer)
      pose = T_base_task * pose;
    wanted.push_back(std::move(track));
  }
  std::vector<Track> tracks = planning::follow(solver_, wanted);
  const std::vector<bool> turning = turning_joints(chain_);
  for (Track& track : tracks)
    keep_within(query.bounds, turning, track);
  std::erase_if(tracks, [](const Track& track) { return track.configurations.cols() == 0; });
  std::ranges::stable_sort(tracks, {}, &Track::gap);
  return tracks;
}

QueryTracks::QueryTracks(std::shared_ptr<const ExperienceGuide> guide, TrackQuery query,
                         const TrackOptions& options)
    : guide_(std::move(guide)), query_(std::move(query)), options_(options) {
  if (!(options.deviation >= 0) || !std::isfinite(options.deviation))
    throw std::invalid_argument("QueryTracks: the deviation is negative or not finite");
}

void QueryTracks::make_some() {
  if (!choices_)
    choices_ = guide_->choose(query_, options_);
  const std::size_t count = std::min<std::size_t>(inverse::kLanes, choices_->size() - followed_);
  for (Track& track :
       guide_->follow(query_, std::span(*choices_).subspan(followed_, count), options_))
    add(std::move(track));
  followed_ += count;
}

void QueryTracks::add(Track track) {
  for (const auto& q : track.configurations.colwise())
    configurations_.emplace_back(q);
  tracks_.push_back(std::move(track));
}

void QueryTracks::add_failed_paths() {
  for (const Eigen::MatrixXd& path : std::exchange(query_.failed_paths, {})()) {
    Eigen::Index finite = 1;
    while (finite < path.cols() && path.col(path.cols() - 1 - finite).allFinite())
      ++finite;
    add({.configurations = path.rightCols(finite).rowwise().reverse(), .is_goal_free = true});
  }
}

const Track* QueryTracks::track(std::size_t index) {
  while (index >= tracks_.size() && (!choices_ || followed_ < choices_->size()))
    make_some();
  if (index >= tracks_.size() && query_.failed_paths)
    add_failed_paths();
  return index < tracks_.size() ? &tracks_[index] : nullptr;
}

std::optional<Eigen::VectorXd> QueryTracks::sample(std::mt19937_64& generator) {
  if (track(0) == nullptr)
    return std::nullopt;
  constexpr int kMaxDraws = 100;
  std::uniform_int_distribution<std::size_t> index(0, configurations_.size() - 1);
  std::normal_distribution<double> normal(0, 1);
  Eigen::VectorXd q(query_.bounds.cols());
  for (int draw = 0; draw < kMaxDraws; ++draw) {
    const Eigen::VectorXd& mean = configurations_[index(generator)];
    bool inside = true;
    for (Eigen::Index joint = 0; joint < q.size() && inside; ++joint) {
      q[joint] = mean[joint] + options_.deviation * normal(generator);
      inside = q[joint] >= query_.bounds(0, joint) && q[joint] <= query_.bounds(1, joint);
    }
    if (inside)
      return q;
  }
  return std::nullopt;
}

}  // namespace kinship::planning
