#include "client/experiments/pipeline/peer_study.hpp"

#include <algorithm>
#include <mutex>
#include <optional>
#include <ostream>
#include <random>

#include "client/experiments/formatted.hpp"
#include "client/experiments/pipeline/parallel_for.hpp"
#include "client/experiments/pipeline/peer_process.hpp"
#include "client/experiments/pipeline/side_study.hpp"
#include "client/ompl/ompl_planner.hpp"
#include "proto/types/failure.hpp"
#include "robots/collision/collision_world.hpp"
#include "robots/planning/goal_configurations.hpp"
#include "robots/planning/path_vertices.hpp"
#include "robots/planning/planning_bounds.hpp"
#include "robots/planning/planning_budget.hpp"

namespace kinship::experiments {
namespace {

using Half = PeerHalves::Half;

/// A problem of a robot with what answers its collision questions.
struct Scenery {
  Scenery(const StudyMember& member, Problem drawn)
      : problem(std::move(drawn)),
        world(member.robot.chain, member.robot.shapes,
              {problem.T_task_base.value(), problem.scene, problem.attached,
               problem.allowed_collisions}) {}

  planning::IsFree is_free() {
    return [this](const Eigen::VectorXd& q) { return !world.collides(q); };
  }

  Problem problem;
  collision::CollisionWorld world;
};

Half half_of(const planning::PlanSummary& summary) {
  return {summary.waypoints.has_value(), summary.collision_checks, summary.planning_time_s,
          summary.waypoints ? planning::path_length(*summary.waypoints) : 0};
}

/// How much of what a half cost was spent when the other had spent so many checks.
double spent(const Half& half, std::uint64_t checks) {
  if (half.checks <= checks)
    return 1;
  return static_cast<double>(checks) / static_cast<double>(half.checks);
}

/// One robot with one peer, in the process that is its own.
class PeerRun {
 public:
  PeerRun(const Study& study, const StudyMember& member, const Peer& peer)
      : study_(study), member_(member), peer_(peer) {}

  /// \return for people: what became of the learning set.
  std::string learn(std::size_t robot, const std::vector<Attempt>& attempts) {
    const std::uint64_t seed = seed_of(InstanceSet::Learning, robot);
    std::size_t solved = 0, kept = 0;
    const double begin_s = planning::thread_time_s();
    for (std::size_t i = 0; i < attempts.size(); ++i) {
      if (!attempts[i].path)
        continue;
      Scenery scenery(member_, read_instance(member_, seed, static_cast<std::uint32_t>(i)));
      if (!experience_)
        experience_.emplace(peer_.kind, bounds_of(scenery.problem), study_.settings.resolution,
                            peer_.range);
      ++solved;
      kept += experience_->learn(attempts[i].path->waypoints(), scenery.is_free()) ? 1U : 0U;
    }
    if (!experience_)
      throw Failure(ErrorCode::NotFound, "no paths to learn");
    return formatted("%zu of %zu paths kept whole, %zu %s, %llu checks, %.1f s", kept, solved,
                     experience_->size(),
                     peer_.kind == planning::ExperienceKind::Lightning ? "paths" : "vertices",
                     static_cast<unsigned long long>(experience_->learning_checks()),
                     planning::thread_time_s() - begin_s);
  }

  PeerHalves answer(const Problem& problem) {
    Scenery scenery(member_, problem);
    const planning::IsFree is_free = scenery.is_free();
    const Eigen::Matrix2Xd bounds = bounds_of(problem);
    planning::GoalOptions goal_options;
    goal_options.max_configurations = study_.settings.max_goals;
    goal_options.seed = problem.seed;
    const Eigen::MatrixXd goals =
        planning::goal_configurations(member_.robot.chain,
                                      problem.T_task_base->inverse() * problem.T_task_goal.value(),
                                      bounds, is_free, goal_options)
            .configurations;
    planning::OmplOptions ompl;
    ompl.planner = "RRTConnect";
    ompl.range = peer_.range;
    ompl.limits.step = study_.settings.resolution;
    ompl.limits.max_checks = study_.settings.max_checks;
    ompl.limits.time_limit = std::chrono::hours(1);
    std::mt19937_64 scratch(problem.seed), recall(~problem.seed);
    return {
        half_of(experience_->recall(problem.start, goals, is_free, ompl.limits, recall)),
        half_of(planning::plan_with_ompl(problem.start, goals, is_free,
                                         planning::ConfigurationSampler(bounds), ompl, scratch))};
  }

 private:
  Eigen::Matrix2Xd bounds_of(const Problem& problem) const {
    return planning::planning_bounds(member_.robot.chain, problem.start);
  }

  const Study& study_;
  const StudyMember& member_;
  const Peer& peer_;
  std::optional<planning::OmplExperience> experience_;
};

/// A query of one robot and peer.
struct PeerQuery {
  Problem problem;
  std::uint32_t seed = 0;  ///< 0, 1, ...: already added to the problem's own
};

/// One robot and one peer, over as many processes as it takes.
class PeerBatch {
 public:
  PeerBatch(const Study& study, const StudyMember& member, std::size_t robot, const Peer& peer,
            QueryLog& log)
      : study_(study), member_(member), robot_(robot), peer_(peer), log_(log) {}

  /// \return for people.
  std::string run(const std::vector<Attempt>& attempts, const QueryPlan& plan) {
    std::vector<PeerQuery> open = open_queries(plan);
    std::string text = member_.label() + ", " + peer_.name + ": ";
    if (open.empty())
      return text + "nothing to do";
    std::size_t crashes = 0;
    while (!open.empty()) {
      std::string learned;
      const std::string end = run_process(attempts, open, learned);
      if (learned.empty())
        return text + "no results, its process ended while learning (" + end + ")";
      if (crashes == 0)
        text += learned;
      open = open_queries(plan);
      if (open.empty())
        break;
      ++crashes;
      text += "; " + open.front().problem.name + " ended the process (" + end + ")";
      const Half lost{.checks = study_.settings.max_checks};
      for (const QueryResult& result : results_of(open.front(), {lost, lost}))
        log_.add(result);
      open.erase(open.begin());
    }
    return text;
  }

 private:
  QueryKey key_of(const PeerQuery& query, const std::string& variant) const {
    return {member_.label(), cell_name(member_.label(), variant), query.problem.name, query.seed};
  }

  std::vector<PeerQuery> open_queries(const QueryPlan& plan) const {
    std::vector<PeerQuery> open;
    for (std::uint32_t index = 0; index < plan.instances; ++index) {
      const Problem problem = read_instance(member_, plan.seed, index);
      for (std::uint32_t seed = 0; seed < plan.seeds; ++seed) {
        PeerQuery query{problem, seed};
        query.problem.seed += seed;
        const auto is_known = [&](const std::string& variant) {
          return log_.has(key_of(query, variant), std::nullopt);
        };
        if (!std::ranges::all_of(variants_of(peer_), is_known))
          open.push_back(std::move(query));
      }
    }
    return open;
  }

  std::string run_process(const std::vector<Attempt>& attempts, const std::vector<PeerQuery>& open,
                          std::string& learned) {
    const auto work = [&](const std::function<void(const std::string&)>& write) {
      PeerRun run(study_, member_, peer_);
      write(run.learn(robot_, attempts));
      for (const PeerQuery& query : open) {
        const PeerHalves halves = run.answer(query.problem);
        for (const QueryResult& result : results_of(query, halves))
          write(to_json(result));
      }
    };
    return run_apart(work, [&](const std::string& line) {
      if (learned.empty())
        learned = line;
      else
        log_.add(query_result_from_json(line).value_or_throw());
    });
  }

  std::vector<QueryResult> results_of(const PeerQuery& query, const PeerHalves& halves) const {
    const std::uint64_t most = study_.settings.max_checks;
    const std::vector<Half> values = {halves.both_threads(most), halves.faster_thread(most),
                                      halves.scratch};
    const std::vector<std::string> variants = variants_of(peer_);
    std::vector<QueryResult> results;
    for (std::size_t i = 0; i < variants.size(); ++i) {
      QueryResult result;
      result.key = key_of(query, variants[i]);
      result.solved = values[i].solved;
      result.checks = values[i].checks;
      result.cpu_s = values[i].cpu_s;
      result.length = values[i].solved ? values[i].length : 0;
      results.push_back(std::move(result));
    }
    return results;
  }

  const Study& study_;
  const StudyMember& member_;
  const std::size_t robot_;
  const Peer& peer_;
  QueryLog& log_;
};

}  // namespace

const std::vector<Peer>& peers() {
  using planning::ExperienceKind;
  constexpr double kTunedRange = 0.5;
  static const std::vector<Peer> kPeers = {
      {"Lightning", ExperienceKind::Lightning, 0},
      {"Thunder", ExperienceKind::Thunder, 0},
      {"Lightning, range 0.5", ExperienceKind::Lightning, kTunedRange},
      {"Thunder, range 0.5", ExperienceKind::Thunder, kTunedRange}};
  return kPeers;
}

Half PeerHalves::both_threads(std::uint64_t max_checks) const {
  const bool recalled = recall.solved && (!scratch.solved || recall.checks <= scratch.checks);
  const Half& winner = recalled ? recall : scratch;
  const Half& other = recalled ? scratch : recall;
  Half both = winner;
  both.checks = winner.checks + std::min(other.checks, winner.checks);
  both.cpu_s = winner.cpu_s + spent(other, winner.checks) * other.cpu_s;
  if (!both.solved || both.checks > max_checks) {
    both.solved = false;
    both.checks = max_checks;
  }
  return both;
}

Half PeerHalves::faster_thread(std::uint64_t max_checks) const {
  const bool recalled = recall.solved && (!scratch.solved || recall.checks <= scratch.checks);
  Half winner = recalled ? recall : scratch;
  if (!winner.solved)
    winner.checks = max_checks;
  return winner;
}

std::vector<std::string> variants_of(const Peer& peer) {
  std::vector<std::string> variants = {peer.name + ": both threads",
                                       peer.name + ": the faster thread alone"};
  if (peer.kind == planning::ExperienceKind::Lightning)
    variants.push_back(peer.range > 0 ? formatted("RRTConnect of OMPL, range %g", peer.range)
                                      : "RRTConnect of OMPL");
  return variants;
}

void run_peers(const Study& study, const std::vector<StudyMember>& fleet,
               const std::vector<std::vector<Attempt>>& learning_sets, const QueryPlan& plan,
               QueryLog& log, std::ostream& messages) {
  std::mutex mutex;  // guards `messages`
  parallel_for(plan.threads, fleet.size() * peers().size(), [&](std::size_t i) {
    const std::size_t robot = i / peers().size();
    PeerBatch batch(study, fleet[robot], robot, peers()[i % peers().size()], log);
    const std::string text = batch.run(learning_sets.at(robot), plan);
    const std::lock_guard lock(mutex);
    messages << study.name << ": peers: " << text << std::endl;
  });
}

}  // namespace kinship::experiments
