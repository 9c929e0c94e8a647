#include "robots/planning/track_lanes.hpp"

#include <algorithm>

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

}  // namespace kinship::planning
