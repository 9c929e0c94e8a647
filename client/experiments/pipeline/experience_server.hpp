#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "client/experiments/pipeline/fleet.hpp"
#include "client/experiments/pipeline/server_process.hpp"
#include "client/link/client.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/rehearsal.hpp"
#include "proto/types/task_experience.hpp"

namespace kinship::experiments {

/// What a distribution is asked for.
struct DistributionWish {
  std::string task;
  std::size_t target = 0;            ///< index into the fleet
  std::vector<std::size_t> sources;  ///< indices into the fleet
  std::string profile = "default";
  bool rehearsed = true;  ///< wait for the server's rehearsal
};

/// What came of a wish.
struct Fetched {
  Distribution distribution;  ///< Failed ones have the reason and no mixture
  TaskExperience experience;  ///< of the same sources, as any client gets it
  std::optional<Rehearsal> rehearsal;
};

/// A kinshipd that this program started, and the line to it.
class ExperienceServer {
 public:
  /// Starts the server and registers the fleet.
  /// \throws Failure that names the robot which is refused, and as ServerProcess says.
  ExperienceServer(const ServerProcess::Options& options, const std::vector<StudyMember>& fleet);

  /// Returns when the server has every attempt, once.
  /// \throws Failure that names the attempt which is refused.
  void report(const std::vector<Attempt>& attempts);

  /// Waits until it is made.
  /// \throws Failure if the server refuses the wish or does not answer.
  Fetched fetch(const DistributionWish& wish);

 private:
  const std::vector<StudyMember>& fleet_;
  ServerProcess process_;
  link::Client client_;
};

}  // namespace kinship::experiments
