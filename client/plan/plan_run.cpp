#include "client/plan/plan_run.hpp"

#include <unistd.h>

#include <array>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "client/plan/attempt_record.hpp"
#include "client/plan/problem_lines.hpp"
#include "client/plan/progress.hpp"
#include "client/plan/scene_record.hpp"
#include "client/plan/server_line.hpp"
#include "proto/json/problem_json.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::plan {
namespace {

std::string host_name() {
  std::array<char, 65> name{};  // HOST_NAME_MAX and a terminator
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

int exit_code_without(NoGuidance why_not) {
  switch (why_not) {
    case NoGuidance::None:
      return kDone;
    case NoGuidance::NoServer:
      return kNoServer;
    case NoGuidance::NotFound:
      return kNotFound;
    case NoGuidance::Failed:
      break;
  }
  return kFailed;
}

void write_result(const ProblemResult& result, std::ostream& results) {
  results << json::to_json(result) << std::endl;  // flushed: a reader may follow
  if (!results)
    throw Failure(ErrorCode::Storage, "cannot write the results");
}

/// Gives attempts the scenes of their problems, and says once why one goes without.
class SceneRecorder {
 public:
  SceneRecorder(const PlanOptions& options, const kinematics::Chain& chain, std::ostream& messages)
      : wanted_(options.record_scenes), chain_(chain), messages_(messages) {}

  void add(const Problem& problem, Attempt& attempt) {
    if (!wanted_ || (problem.scene.objects.empty() && problem.attached.empty()))
      return;
    Result<RecordedScene> scene = record_scene(chain_, problem);
    if (scene)
      attempt.scene = std::move(scene).value();
    else if (!std::exchange(told_, true))
      messages_ << "problem '" << problem.name
                << "' is reported without its scene: " << scene.error().message << "\n";
  }

 private:
  const bool wanted_;
  const kinematics::Chain& chain_;
  std::ostream& messages_;
  bool told_ = false;
};

GuidanceWish wish_of(const PlanOptions& options, const kinematics::Chain& chain) {
  GuidanceWish wish;
  wish.task = options.task;
  wish.robot = chain.digest();
  wish.dof = chain.dof();
  wish.profile = options.profile;
  wish.selection = options.selection;
  wish.arms = options.arms;
  wish.wait = options.wait;
  return wish;
}

}  // namespace

int run_plan(const PlanOptions& options, const RunStreams& streams,
             const std::function<bool()>& stop) {
  const models::LoadedRobot robot = models::load_robot(options.robot).value_or_throw();
  const PlannedRobot planned_robot = {robot.chain, robot.shapes};
  std::vector<ProblemLine> lines = read_problem_lines(streams.problems);
  ServerLine server(options, robot.description, streams.messages, stop);
  const GuidanceWish wish = wish_of(options, robot.chain);
  const NoGuidance why_not = server.fetch_guidance(wish, lines);
  if (options.guidance == GuidanceMode::Require && why_not != NoGuidance::None && !stop()) {
    streams.messages << "nothing is planned: --guidance require, and there is none\n";
    return exit_code_without(why_not);
  }

  const std::string machine = options.machine.empty() ? host_name() : options.machine;
  const Reporter reporter{wish.robot, machine, options.task};
  SceneRecorder scenes(options, robot.chain, streams.messages);
  Progress progress(streams.messages, streams.messages_on_terminal, lines.size());
  bool complete = true;
  for (ProblemLine& line : lines) {
    if (stop()) {
      complete = false;
      break;
    }
    if (!line.problem) {
      const ProblemResult broken = broken_line_result(line.number, line.problem.error());
      write_result(broken, streams.results);
      progress.add(broken, false);
      continue;
    }
    Problem problem = *std::move(line.problem);
    problem.seed += options.seed_offset;
    const PlannedProblem planned =
        plan_problem(planned_robot, problem, server.choose(problem), options.settings, stop);
    if (planned.interrupted) {
      complete = false;
      break;
    }
    if (planned.attempted)
      server.add(planned);
    if (options.report && planned.attempted)
      server.report([&] {
        Attempt attempt = make_attempt(reporter, problem, planned, options.settings);
        scenes.add(problem, attempt);
        return attempt;
      });
    write_result(planned.result, streams.results);  // after: what has a result is in the outbox
    progress.add(planned.result, planned.attempted);
  }
  progress.finish();
  server.finish();
  if (!complete)
    streams.messages << "interrupted: the remaining problems were not planned\n";
  return complete ? kDone : kFailed;
}

}  // namespace kinship::plan
