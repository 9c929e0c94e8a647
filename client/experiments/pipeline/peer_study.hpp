#pragma once

#include <cstdint>
#include <iosfwd>
#include <string>
#include <vector>

#include "client/experiments/pipeline/fleet.hpp"
#include "client/experiments/pipeline/query_log.hpp"
#include "client/experiments/pipeline/query_runner.hpp"
#include "client/ompl/ompl_experience.hpp"
#include "proto/types/attempt.hpp"

namespace kinship::experiments {

/// An experience planner of OMPL as it is measured.
struct Peer {
  std::string name;
  planning::ExperienceKind kind = planning::ExperienceKind::Lightning;
  double range = 0;  ///< of its RRTConnects, joint units; 0: OMPL's choice
};

/// Lightning and Thunder as they come, and with a range tuned by hand.
const std::vector<Peer>& peers();

/// What the halves of a peer cost by themselves becomes what two threads cost that ask by turns:
/// the query ends when one of them has a path.
struct PeerHalves {
  struct Half {
    bool solved = false;
    std::uint64_t checks = 0;  ///< until it had a path or gave up
    double cpu_s = 0, length = 0;
  };
  Half recall, scratch;

  /// \param max_checks  of both together: more is unsolved.
  Half both_threads(std::uint64_t max_checks) const;
  /// The same, but only the checks of the thread that has the path: as if the other were free.
  Half faster_thread(std::uint64_t max_checks) const;
};

/// The variants (side_study.hpp) that one peer's queries are results of: both threads, the faster
/// one, and of Lightning's also its planning from scratch.
std::vector<std::string> variants_of(const Peer& peer);

/// Plans what is not in the log yet: each robot with each peer, which was given the robot's own
/// learning set and learns nothing from queries. A peer and robot have a process of their own, in
/// case OMPL's databases crash: the query under way then counts as unsolved, and the next process
/// goes on after it; a peer that crashes while learning has no results. All of it is told on
/// `messages`.
/// \param learning_sets  by robot: one attempt per learning instance, in order.
/// \throws Failure(Unavailable) if processes cannot be had.
void run_peers(const Study& study, const std::vector<StudyMember>& fleet,
               const std::vector<std::vector<Attempt>>& learning_sets, const QueryPlan& plan,
               QueryLog& log, std::ostream& messages);

}  // namespace kinship::experiments
