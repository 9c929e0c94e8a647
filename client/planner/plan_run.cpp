#include "client/planner/plan_run.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <limits>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "client/guided/attempt_record.hpp"
#include "client/guided/geometry_warnings.hpp"
#include "client/guided/path_measures.hpp"
#include "client/guided/scene_record.hpp"
#include "client/planner/problem_lines.hpp"
#include "client/planner/progress.hpp"
#include "client/planner/server_line.hpp"
#include "proto/json/problem_json.hpp"
#include "robots/collision/fitted_links.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/models/mesh_files.hpp"

namespace kinship::planner {
namespace {

std::string host_name() {
  std::array<char, 65> name{};  // HOST_NAME_MAX and a terminator
  return gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "";
}

int exit_code_without(guided::NoGuidance why_not) {
  switch (why_not) {
    case guided::NoGuidance::None:
      return kDone;
    case guided::NoGuidance::NoServer:
      return kNoServer;
    case guided::NoGuidance::NoExperience:
    case guided::NoGuidance::NotFound:
      return kNotFound;
    case guided::NoGuidance::Failed:
      break;
  }
  return kFailed;
}

/// An empty one of a problem that was not searched for.
void write_search(const std::string& name, const planning::SearchRecorder& recorder,
                  std::ostream& searches) {
  RecordedSearch search = recorder.search();
  search.name = name;
  searches << json::to_json(search) << '\n';
  if (!searches)
    throw Failure(ErrorCode::Storage, "cannot write the searches");
}

void write_result(const ProblemResult& result, const RunStreams& streams) {
  streams.results << (streams.results_for_people ? result_text(result) : json::to_json(result))
                  << std::endl;  // flushed: a reader may follow
  if (!streams.results)
    throw Failure(ErrorCode::Storage, "cannot write the results");
}

/// Gives attempts the scenes of their problems, and says once why one goes without.
class SceneRecorder {
 public:
  SceneRecorder(const PlanOptions& options, const kinematics::Chain& chain, std::ostream& messages)
      : wanted_(options.record_scenes), chain_(chain), messages_(messages) {}

  void add(const Problem& problem, Attempt& attempt) {
    const bool is_open = problem.scene.objects.empty() && problem.scene.meshes.empty() &&
                         problem.scene.clouds.empty();
    if (!wanted_ || (is_open && problem.attached.empty() && !problem.constraint))
      return;
    Result<RecordedScene> scene = records_.record(chain_, problem);
    const bool has_mesh = !problem.scene.meshes.empty() || !problem.scene.clouds.empty() ||
                          std::ranges::any_of(problem.attached, [](const AttachedObject& each) {
                            return each.mesh.has_value();
                          });
    if (scene && has_mesh && !std::exchange(told_of_meshes_, true))
      messages_ << "problem '" << problem.name
                << "' is reported with solids around its meshes and clouds (approximate): the "
                   "server filters "
                   "with these\n";
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
  guided::SceneRecords records_;
  bool told_ = false, told_of_meshes_ = false;
};

/// What counts as slow in a run.
class SlowQueries {
 public:
  /// The 95th percentile of the queries so far; infinity as long as there are few.
  double time_s() const {
    constexpr std::size_t kEnough = 20;
    if (times_s_.size() < kEnough)
      return std::numeric_limits<double>::infinity();
    std::vector<double> times_s = times_s_;
    const auto slow = times_s.begin() + static_cast<std::ptrdiff_t>(times_s.size() * 95 / 100);
    std::ranges::nth_element(times_s, slow);
    return *slow;
  }
  void add(double time_s) { times_s_.push_back(time_s); }

 private:
  std::vector<double> times_s_;
};

/// The answer to a problem whose meshes cannot be had.
guided::PlannedProblem unread(const Problem& problem, const Error& error) {
  guided::PlannedProblem planned;
  planned.result.name = problem.name;
  planned.result.time_limit_s = problem.time_limit_s;
  planned.result.reason = error.message;
  planned.result.not_planned = NotPlanned::Unreadable;
  return planned;
}

guided::GuidanceOptions guidance_options(const PlanOptions& options,
                                         const kinematics::Chain& chain) {
  guided::GuidanceOptions wanted;
  wanted.task = options.task;
  wanted.robot = chain.digest();
  wanted.dof = chain.dof();
  if (options.guide != Guide::Mixture)
    wanted.chain = chain;
  wanted.guide = options.guide;
  wanted.rehearsed = options.rehearsed;
  wanted.profile = options.profile;
  wanted.selection = options.selection;
  wanted.sampling = options.sampling;
  wanted.wait = options.wait;
  return wanted;
}

/// The problems of a run, one after another.
class Run {
 public:
  Run(const PlanOptions& options, const models::LoadedRobot& robot, ServerLine& server,
      const RunStreams& streams)
      : options_(options),
        robot_(robot.chain, robot.shapes),
        warnings_(robot.chain, robot.shapes),
        server_(server),
        streams_(streams),
        reporter_{robot_, options.machine.empty() ? host_name() : options.machine, options.task},
        meshes_(options.problems.parent_path(),
                models::packages_of(options.robot).value_or_throw()),
        scenes_(options, robot_.chain, streams.messages) {
    if (const std::string touching = collision::describe_always_touching(robot_.solids);
        !touching.empty())
      streams.messages << "warning: " << touching << '\n';
  }

  /// \return whether every line has its result; false if `stop` ended it.
  bool answer(std::vector<ProblemLine>& lines, Progress& progress,
              const std::function<bool()>& stop) {
    for (ProblemLine& line : lines) {
      if (stop())
        return false;
      guided::PlannedProblem planned;
      if (line.problem)
        planned = plan(*std::move(line.problem), stop);
      else
        planned.result = broken_line_result(line.number, line.problem.error());
      if (planned.interrupted)
        return false;
      if (streams_.searches != nullptr)
        write_search(planned.result.name, recorder_, *streams_.searches);
      recorder_ = {};
      write_result(planned.result, streams_);  // after: an attempt with a result is in the outbox
      progress.add(planned.result, planned.attempted);
    }
    return true;
  }

 private:
  guided::PlannedProblem plan(Problem problem, const std::function<bool()>& stop) {
    problem.seed += options_.seed_offset;
    if (const auto error = meshes_.read(problem.scene, problem.attached))
      return unread(problem, *error);
    guided::PlanSettings settings = options_.settings;
    settings.slow_time_s = slow_.time_s();
    guided::PlannedProblem planned =
        guided::plan_problem(robot_, problem, server_.choose(problem), settings, stop,
                             streams_.searches != nullptr ? &recorder_ : nullptr);
    slow_.add(planned.result.processor_time_s);
    guided::measure_path(robot_, problem, planned.result);
    for (const std::string& warning : warnings_.find(problem, planned))
      streams_.messages << "warning: " << warning << '\n';
    for (const std::string& moved : planned.moved)
      streams_.messages << "warning: problem '" << problem.name << "': " << moved << '\n';
    if (planned.interrupted || !planned.attempted)
      return planned;
    server_.add(planned);
    if (options_.report)
      server_.report([&] {
        Attempt attempt = guided::make_attempt(reporter_, problem, planned, options_.settings);
        scenes_.add(problem, attempt);
        return attempt;
      });
    return planned;
  }

  const PlanOptions& options_;
  const guided::PlannedRobot robot_;
  guided::GeometryWarnings warnings_;
  ServerLine& server_;
  const RunStreams& streams_;
  const guided::Reporter reporter_;
  models::SceneMeshes meshes_;
  SceneRecorder scenes_;
  SlowQueries slow_;
  planning::SearchRecorder recorder_;  // of the search under way
};

}  // namespace

RunSummary run_plan(const PlanOptions& given, const RunStreams& streams,
                    const std::function<bool()>& stop) {
  const models::LoadedRobot robot = models::load_robot(given.robot).value_or_throw();
  PlanOptions options = given;
  options.settings.limit_slack = robot.limit_slack.value_or(options.settings.limit_slack);
  for (const std::string& doubt : geometry::find_doubts(robot.chain, robot.shapes))
    streams.messages << "warning: " << doubt << '\n';
  for (const std::string& warning : robot.warnings)
    streams.messages << "warning: " << warning << '\n';
  std::vector<ProblemLine> lines = read_problem_lines(streams.problems);
  if (!models::says_transfer(options.robot))
    streams.messages << transfer_warning(lines, robot.chain.tip_link());
  const kinematics::RobotModel& model = robot;
  ServerLine server(
      options, model, [&robot] { return collision::fit_robot(robot.chain, robot.shapes); },
      streams.messages, stop);
  if (server.is_robot_refused()) {
    streams.messages << "nothing is planned: the robot cannot be registered\n";
    return {kFailed, false};
  }
  const guided::NoGuidance why_not =
      server.fetch_guidance(guidance_options(options, robot.chain), lines);
  if (options.guidance == GuidanceMode::Require && why_not != guided::NoGuidance::None && !stop()) {
    streams.messages << "nothing is planned: --guidance require, and there is none\n";
    return {exit_code_without(why_not), false};
  }

  Progress progress(streams.messages, streams.messages_on_terminal, lines.size());
  const bool is_complete = Run(options, robot, server, streams).answer(lines, progress, stop);
  progress.finish();
  const bool is_all_kept = server.finish();
  if (!is_complete)
    streams.messages << "interrupted: the remaining problems were not planned\n";
  const bool is_done =
      is_complete && is_all_kept && !progress.nothing_attempted() && !server.is_robot_refused();
  return {is_done ? kDone : kFailed, is_complete};
}

}  // namespace kinship::planner
