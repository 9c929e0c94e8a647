#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <utility>

#include "client/guided/guidance.hpp"
#include "client/python/robot.hpp"
#include "client/python/sampled_distribution.hpp"
#include "robots/planning/is_free.hpp"
#include "robots/recall/recall_trust.hpp"

namespace kinship::python {

/// The guidance of a robot's queries at one placement, with the choice between guided and control,
/// which learns from the attempts. Shared by threads.
class GuidanceHandle {
 public:
  /// \param answer  with guidance.
  /// \param chain        of the robot; missing: the guidance has no paths to recall.
  /// \param T_task_base  where the robot stands for which it was made; missing: as identity.
  GuidanceHandle(const Digest& robot, guided::GuidanceAnswer answer,
                 std::optional<kinematics::Chain> chain = std::nullopt,
                 std::optional<Eigen::Isometry3d> T_task_base = std::nullopt)
      : robot_(robot),
        chain_(std::move(chain)),
        T_task_base_(std::move(T_task_base)),
        answer_(std::move(answer)) {}

  /// A distribution alone: without stored ways, and without control.
  /// \throws Failure(InvalidInput) if it can guide no robot.
  static std::shared_ptr<GuidanceHandle> of_distribution(const SampledDistribution& distribution);

  /// The robot alone, each query by a guide that needs no experience.
  /// \throws Failure(InvalidInput) if the guide needs experience.
  static std::shared_ptr<GuidanceHandle> of_robot(const Robot& robot, Guide guide);

  const Digest& robot() const noexcept { return robot_; }
  const std::optional<Eigen::Isometry3d>& T_task_base() const noexcept { return T_task_base_; }
  const guided::Guidance& guidance() const noexcept { return *answer_.guidance; }
  const std::string& message() const noexcept { return answer_.message; }

  double guided_part() const;
  SamplingMode choose(const Problem& problem) const;
  double recall_trust() const;

  /// Tries whole stored paths on a problem, however they are rated beside other guides.
  /// \return dof x n; nothing if none was free, or there are none.
  /// \throws Failure(InvalidInput) if the problem does not fit the robot, begins at a pose, or has
  ///         a constraint.
  std::optional<Eigen::MatrixXd> recall(const Problem& problem, const planning::IsFree& is_free,
                                        double step);
  void add(const guided::PlannedProblem& planned);

 private:
  const Digest robot_;
  const std::optional<kinematics::Chain> chain_;
  const std::optional<Eigen::Isometry3d> T_task_base_;
  recall::RecallTrust recall_trust_;
  guided::GuidanceAnswer answer_;  // but for its chooser never changed
  mutable std::mutex mutex_;       // guards chooser and trust
};

}  // namespace kinship::python
