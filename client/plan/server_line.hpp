#pragma once

#include <iosfwd>
#include <memory>
#include <vector>

#include "client/link/client.hpp"
#include "client/plan/guidance.hpp"
#include "client/plan/plan_options.hpp"
#include "client/plan/problem_lines.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::plan {

/// A run's line to kinshipd. Without need of a server, or without a server, everything still
/// works: there is no guidance, and reports stay in the outbox.
class ServerLine {
 public:
  /// Registers the robot if the options need the server.
  /// \param messages  for people; borrowed.
  ServerLine(const PlanOptions& options, const RobotDescription& description,
             std::ostream& messages);

  /// Asks for guidance for every placement of the problems, and says what came of it.
  /// \return why guidance that the options require is missing.
  NoGuidance fetch_guidance(const GuidanceWish& wish, const std::vector<ProblemLine>& lines);

  /// Never waits. \return null: plan uniformly.
  const Guidance* guidance(const std::optional<Eigen::Isometry3d>& T_task_base) const;

  /// Puts the attempt into the outbox; says so if it cannot be kept.
  void report(const Attempt& attempt);

  /// Waits, at most for the timeout, for receipts of what was reported, and says how many came.
  void finish();

 private:
  bool register_robot();

  const PlanOptions options_;
  const RobotDescription description_;
  std::ostream& messages_;
  std::unique_ptr<link::Client> client_;  // null: no server needed
  std::unique_ptr<GuidanceBook> guidance_;
  bool registered_ = false;
  std::size_t reported_ = 0;
  std::size_t unreportable_ = 0;
};

}  // namespace kinship::plan
