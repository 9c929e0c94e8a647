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
#include "robots/collision/fitted_links.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::planner {

/// A run's connection to kinshipd. If the options need no server, or none answers, the run goes on
/// without guidance, and reports stay in the outbox.
class ServerLine {
 public:
  using FitRobot = std::function<Result<collision::FittedRobot>()>;

  /// Registers the robot if the options need the server. A failed connection or a refused
  /// registration is written to `messages` and means no guidance.
  /// \param fit       makes solids around the robot's meshes; called if the server has no better
  ///                  geometry of the robot. Borrowed.
  /// \param messages  for people; borrowed.
  /// \param stop      called during waits for a server; true ends the wait. Borrowed.
  ServerLine(const PlanOptions& options, kinematics::RobotModel robot, FitRobot fit,
             std::ostream& messages, const std::function<bool()>& stop);

  /// Fetches guidance for every placement of the problems and writes the answers to `messages`.
  /// \return why guidance that the options require is missing.
  guided::NoGuidance fetch_guidance(guided::GuidanceOptions wanted,
                                    const std::vector<ProblemLine>& lines);

  /// Whether a server refused the robot, for example because its label belongs to another one.
  /// Possibly known only after finish(), as the server may start later.
  bool is_robot_refused() const noexcept { return is_robot_refused_; }

  /// Guidance and sampling mode of the next problem; uniform without guidance. Never waits.
  guided::QueryGuidance choose(const Problem& problem) const;

  /// Adds an attempt to the evidence for later choices.
  void add(const guided::PlannedProblem& planned);

  /// Puts the attempt into the outbox; writes to `messages` if it cannot be made or kept.
  void report(const std::function<Attempt()>& make_attempt);

  /// Waits for the receipts of the reports, at most for the timeout, and writes their number. Never
  /// throws: the results are already written.
  /// \return whether every attempt that was to be reported is kept or acknowledged.
  bool finish();

 private:
  /// The result of `call`, which is cancelled soon after `stop` returns true.
  template <typename Reply>
  Result<Reply> wait_for(const std::function<Result<Reply>()>& call);

  void register_robot();
  Result<RegisterReply> send_description();
  bool add_mesh_solids();
  bool add_meshes();
  std::optional<Error> find_sources(Selection& selection);
  void flush();

  const PlanOptions options_;
  kinematics::RobotModel robot_;
  const FitRobot fit_;
  std::ostream& messages_;
  const std::function<bool()>& stop_;
  std::unique_ptr<link::Client> client_;  // null: no server needed, or no line to be had
  std::unique_ptr<guided::GuidanceCache> guidance_;
  std::optional<Error> trouble_;  // why the robot is not registered
  bool is_robot_refused_ = false;
  std::string why_unguided_;  // of every query, while there is no guidance_
  std::string kept_;          // of older stores, in the outbox
  std::size_t reported_ = 0;
  std::size_t unreportable_ = 0;
};

}  // namespace kinship::planner
