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
#include "robots/recall/recall_trust.hpp"

namespace kinship::guided {

/// Fetches from the server; link::Client::fetch in the program.
using Fetch = std::function<Result<FetchReply>(const FetchRequest&)>;

/// The guidance that a run requests.
struct GuidanceOptions {
  std::string task;
  Digest robot;
  Eigen::Index dof = 0;
  /// To retreat and to follow stored ways of the hand; missing: neither.
  std::optional<kinematics::Chain> chain;
  std::string profile = "default";
  Selection selection;
  Eigen::VectorXd start;                              ///< FetchRequest::start; empty: not told
  std::optional<Eigen::Isometry3d> T_task_goal = {};  ///< of FetchRequest
  bool to_configuration = false;                      ///< of FetchRequest
  SamplingModeOptions sampling;
  std::optional<Guide> guide;             ///< missing: the one found by rehearsal, else all
  bool rehearsed = false;                 ///< wait for a rehearsal, as for a distribution
  std::chrono::milliseconds wait{30000};  ///< for a distribution that is still being made
};

/// Why there is no guidance, for a program's exit code.
enum class NoGuidance { None, NoServer, NoExperience, NotFound, Failed };

/// The answer for one placement.
struct GuidanceAnswer {
  std::optional<Guidance> guidance;
  std::optional<SamplingModeChooser> sampling;  ///< present exactly if there is guidance
  NoGuidance why_not = NoGuidance::None;
  std::string message;  ///< for people: the guidance, or why there is none
};

/// The task's experience as one robot follows it; null: none.
using SharedExperience = std::shared_ptr<const planning::ExperienceGuide>;

/// What a robot holds of a task's experience, for all placements.
struct KnownExperience {
  SharedExperience ways;
  std::shared_ptr<const recall::RecallGuide> recall;  ///< null: none
};

/// Fetches once; not at all with a guide that needs no experience: the robot alone is enough. Never
/// throws for a server's reply.
/// \param known  earlier experience of robot and task: kept unless the reply has newer.
GuidanceAnswer fetch_guidance(const Fetch& fetch, const GuidanceOptions& wanted,
                              const std::optional<Eigen::Isometry3d>& T_task_base,
                              KnownExperience known = {});

/// The guidance of a run, fetched once per distinct placement (snapped to 1 mm and 1 mrad) before
/// planning; a missing placement counts as one of its own. After one fetch without an answer it
/// sends no more.
class GuidanceCache {
 public:
  GuidanceCache(Fetch fetch, GuidanceOptions wanted)
      : fetch_(std::move(fetch)), wanted_(std::move(wanted)) {}

  /// Fetches unless the placement is known.
  /// \return the answer, kept as long as the cache, and whether it is new.
  std::pair<const GuidanceAnswer&, bool> ask(const std::optional<Eigen::Isometry3d>& T_task_base) {
    return ask(T_task_base, wanted_);
  }
  /// The same for a problem, whose goal the server is told.
  std::pair<const GuidanceAnswer&, bool> ask(const Problem& problem);

  /// Guidance and sampling mode of the next problem, from the answers of ask() and the attempts of
  /// add(). Never waits.
  QueryGuidance choose(const Problem& problem) const;

  /// Adds an attempt to the evidence by which later problems choose their sampling mode.
  void add(const PlannedProblem& planned);

 private:
  using Key = std::optional<PoseArray>;
  static Key key_of(const std::optional<Eigen::Isometry3d>& T_task_base);
  std::pair<const GuidanceAnswer&, bool> ask(const std::optional<Eigen::Isometry3d>& T_task_base,
                                             const GuidanceOptions& wanted);

  Fetch fetch_;
  const GuidanceOptions wanted_;
  std::map<Key, GuidanceAnswer> answers_;
  KnownExperience known_;                        // of all placements
  std::optional<SamplingModeChooser> sampling_;  // of all placements: same task, same robot
  recall::RecallTrust recall_trust_;
  bool server_missing_ = false;
};

}  // namespace kinship::guided
