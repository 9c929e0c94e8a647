#pragma once

#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/guided/guidance.hpp"
#include "client/link/client.hpp"
#include "client/planner/plan_options.hpp"
#include "client/planner/problem_lines.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/collision/fitted_links.hpp"

namespace kinship::planner {

/// A run's line to kinshipd. Without need of a server, or without a server, everything still
/// works: there is no guidance, and reports stay in the outbox.
class ServerLine {
 public:
  using FitRobot = std::function<Result<collision::FittedRobot>()>;

  /// Registers the robot if the options need the server. A line that cannot be had, or a refused
  /// registration, is said and means no guidance.
  /// \param fit       fits solids around the robot's meshes; called if the server knows the robot
  /// no
  ///                  better without them. Borrowed.
  /// \param messages  for people; borrowed.
  /// \param stop      asked while a server is waited for; true ends the waiting. Borrowed.
  ServerLine(const PlanOptions& options, RobotDescription description, FitRobot fit,
             std::ostream& messages, const std::function<bool()>& stop);

  /// Asks for guidance for every placement of the problems, and says what came of it.
  /// \return why guidance that the options require is missing.
  guided::NoGuidance fetch_guidance(guided::GuidanceOptions wanted,
                                    const std::vector<ProblemLine>& lines);

  /// Whether a server refused the robot, for example because its label belongs to another one. That
  /// may come out only in finish(): the server may come up later than this.
  bool is_robot_refused() const noexcept { return is_robot_refused_; }

  /// How the next problem shall be planned; without guidance uniformly. Never waits.
  guided::QueryGuidance choose(const Problem& problem) const;

  /// A problem was attempted: the choice for those after it learns from it.
  void add(const guided::PlannedProblem& planned);

  /// Puts the attempt into the outbox; says so if it cannot be made or kept.
  void report(const std::function<Attempt()>& make_attempt);

  /// Waits, at most for the timeout, for receipts of what was reported, and says how many came.
  /// Never throws: the run is answered.
  /// \return whether every attempt that was to be reported is kept or acknowledged.
  bool finish();

 private:
  /// What `call` brings, or that it was cancelled, soon after `stop` says so.
  template <typename Reply>
  Result<Reply> wait_for(const std::function<Result<Reply>()>& call);

  void register_robot();
  Result<RegisterReply> send_description();
  bool add_mesh_solids();
  std::optional<Error> find_sources(Selection& selection);
  void flush();

  const PlanOptions options_;
  RobotDescription description_;
  const FitRobot fit_;
  std::ostream& messages_;
  const std::function<bool()>& stop_;
  std::unique_ptr<link::Client> client_;  // null: no server needed, or no line to be had
  std::unique_ptr<guided::GuidanceCache> guidance_;
  std::optional<Error> trouble_;  // why the robot is not registered
  bool is_robot_refused_ = false;
  std::string why_unguided_;  // of every query, while there is no guidance_
  std::size_t reported_ = 0;
  std::size_t unreportable_ = 0;
};

}  // namespace kinship::planner
