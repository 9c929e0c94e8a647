#include "server/rehearsal/subject.hpp"

#include <future>
#include <optional>

#include "proto/types/stopped.hpp"
#include "server/fitting/fit_distribution.hpp"
#include "server/rehearsal/asked_queries.hpp"

namespace kinship::rehearsal {
namespace {

/// The mixture of the paths that are not in one half; nothing if none can be fitted.
std::optional<Mixture> fit_without(std::size_t half, const fitting::DistributionKey& key,
                                   const RehearsalScheduler::Parts& parts,
                                   const std::stop_token& stop) {
  const fitting::FitOutcome outcome = fitting::fit_distribution(
      key,
      {.store = parts.store,
       .robots = parts.robots,
       .clock = parts.clock,
       .leaves_out = [half](const Uuid& report) { return half_of(report) == half; },
       .memory = parts.memory},
      stop);
  return outcome.distribution ? outcome.distribution->mixture : std::nullopt;
}

}  // namespace

Result<Subject> read_subject(const RehearsalKey& key, const RehearsalScheduler::Parts& parts,
                             std::size_t max_queries, const std::stop_token& stop) {
  Subject subject;
  const auto robot = parts.robots.find(key.distribution.robot);
  if (!robot)
    return robot.error();
  subject.robot = *robot;
  if (subject.robot->shapes.shapes.empty())
    return Error{ErrorCode::InvalidInput, "the server knows no shapes of robot '" +
                                              subject.robot->label +
                                              "': " + subject.robot->geometry};
  subject.to_configuration = key.to_configuration;
  subject.T_task_base = key.distribution.T_task_base.value_or(Eigen::Isometry3d::Identity());
  subject.recorded = read_queries(parts.store, parts.robots, key.distribution, max_queries, stop);
  subject.starts =
      find_starts(subject.robot->chain, subject.T_task_base, subject.recorded.queries, key.start);
  if (key.T_task_goal)
    ask_in_recorded_scenes(*key.T_task_goal, *subject.robot, subject.T_task_base, subject.starts,
                           subject.recorded.queries);
  std::promise<catalog::SharedChoice> chosen;
  parts.experience.ask(
      {key.distribution.task, key.distribution.sources, key.distribution.since_ms,
       key.experience_bytes},
      [&chosen](const catalog::SharedChoice& choice) { chosen.set_value(choice); });
  const catalog::SharedChoice ways = chosen.get_future().get();
  subject.experience = std::make_shared<const planning::ExperienceGuide>(
      subject.robot->chain, ways ? to_experience(*ways) : TaskExperience{});
  for (std::size_t half = 0; half < kHalves; ++half)
    subject.mixtures.at(half) = fit_without(half, key.distribution, parts, stop);
  throw_if_stopped(stop);
  return subject;
}

}  // namespace kinship::rehearsal
