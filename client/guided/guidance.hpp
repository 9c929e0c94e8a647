#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <functional>
#include <iosfwd>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "client/guided/plan_problem.hpp"
#include "client/guided/sampling_mode_choice.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/pose.hpp"
#include "proto/types/result.hpp"
#include "robots/kinematics/chain.hpp"

namespace kinship::guided {

/// Asks the server; link::Client::fetch in the program.
using Fetch = std::function<Result<FetchReply>(const FetchRequest&)>;

/// What a run wants guidance for.
struct GuidanceOptions {
  std::string task;
  Digest robot;
  Eigen::Index dof = 0;
  std::optional<kinematics::Chain> chain;  ///< to follow stored ways of the hand; missing: none
  std::string profile = "default";
  Selection selection;
  SamplingModeOptions sampling;
  std::optional<Guide> guide;  ///< missing: what the server found by rehearsal, else all there is
  bool rehearsed = false;      ///< wait for a rehearsal, as for a distribution
  std::chrono::milliseconds wait{30000};  ///< for a distribution that is still being made
};

/// Why there is no guidance, as a program's exit code tells it.
enum class NoGuidance { None, NoServer, NotFound, Failed };

/// What came of asking for one placement.
struct GuidanceAnswer {
  std::optional<Guidance> guidance;
  std::optional<SamplingModeChooser> sampling;  ///< present exactly if there is guidance
  NoGuidance why_not = NoGuidance::None;
  std::string message;  ///< for people: what was got, or why nothing
};

/// The task's experience as one robot follows it; null: none.
using SharedExperience = std::shared_ptr<const planning::ExperienceGuide>;

/// Asks once. Never throws for what a server may answer.
/// \param known  what the robot got of the task before: kept unless there is something newer.
GuidanceAnswer fetch_guidance(const Fetch& fetch, const GuidanceOptions& wanted,
                              const std::optional<Eigen::Isometry3d>& T_task_base,
                              SharedExperience known = nullptr);

/// The guidance of a run, asked for once per distinct placement (snapped to 1 mm and 1 mrad) before
/// planning; a missing placement is one of its own. When nobody answers once, nobody is asked
/// again.
class GuidanceCache {
 public:
  GuidanceCache(Fetch fetch, GuidanceOptions wanted)
      : fetch_(std::move(fetch)), wanted_(std::move(wanted)) {}

  /// Asks unless the placement is known. \return the answer, and whether it is new.
  std::pair<const GuidanceAnswer&, bool> ask(const std::optional<Eigen::Isometry3d>& T_task_base);

  /// How the next problem shall be planned, by what ask() brought and add() was told. Never waits.
  QueryGuidance choose(const Problem& problem) const;

  /// A problem was attempted: all that come after choose their sampling mode by that, too.
  void add(const PlannedProblem& planned);

 private:
  using Key = std::optional<PoseArray>;
  static Key key_of(const std::optional<Eigen::Isometry3d>& T_task_base);

  Fetch fetch_;
  GuidanceOptions wanted_;
  std::map<Key, GuidanceAnswer> answers_;
  SharedExperience experience_;                  // of all placements
  std::optional<SamplingModeChooser> sampling_;  // of all placements: same task, same robot
  bool server_missing_ = false;
};

}  // namespace kinship::guided
