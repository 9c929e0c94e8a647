#include "server/console/figures.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pages/plots/plot_pages.hpp"
#include "server/console/recent_attempts.hpp"

namespace kinship::console {
namespace {

constexpr std::size_t kMaxListed = 200'000;  // rows of a task's history

std::vector<PathSummary> newest_paths(Questions& questions, AdminRequest request,
                                      std::size_t most) {
  std::vector<PathSummary> paths;
  std::size_t in_use = 0;
  request.limit = static_cast<std::uint32_t>(std::min<std::size_t>(most, kMaxPageRows));
  do {
    service::AdminPage page = questions.answer(request);
    for (service::AdminRow& row : page.rows) {
      paths.push_back(std::get<PathSummary>(std::move(row)));
      if (paths.back().retired_ms == 0)
        ++in_use;
    }
    request.cursor = page.next_cursor;
  } while (!request.cursor.empty() && in_use < most);
  return paths;
}

plots::LookUp look_up_of(Questions& questions) {
  return {
      .paths =
          [&](const std::string& task, const std::optional<Digest>& robot, std::size_t most) {
            return newest_paths(
                questions,
                {.verb = AdminVerb::ListPaths, .robot = robot ? robot->hex() : "", .task = task},
                most);
          },
      .attempt =
          [&](const Uuid& report) {
            return questions.row<Attempt>({.verb = AdminVerb::ShowPath, .argument = report.text()});
          },
      .robot =
          [&](const Digest& robot) {
            return questions.row<RobotDescription>(
                {.verb = AdminVerb::ShowRobot, .argument = robot.hex()});
          },
      .distributions =
          [&](const std::string& task, const Digest& robot) {
            return questions.rows<DistributionSummary>(
                {.verb = AdminVerb::ListDistributions, .robot = robot.hex(), .task = task},
                kMaxListed);
          },
      .distribution =
          [&](const Digest& id) {
            return questions.row<Distribution>(
                {.verb = AdminVerb::ShowDistribution, .argument = id.hex()});
          }};
}

std::string distribution_figure(Questions& questions, const std::string& id) {
  auto distribution =
      questions.row<Distribution>({.verb = AdminVerb::ShowDistribution, .argument = id});
  const plots::LookUp look_up = look_up_of(questions);
  return plots::to_json(plots::distribution_figure(std::move(distribution), look_up));
}

std::string task_figure(Questions& questions, const std::string& task) {
  auto attempts =
      questions.rows<AttemptSummary>({.verb = AdminVerb::ListAttempts, .task = task}, kMaxListed);
  if (attempts.empty())
    throw Failure(ErrorCode::NotFound, "no attempt of task '" + task + "'");
  const auto distributions = questions.rows<DistributionSummary>(
      {.verb = AdminVerb::ListDistributions, .task = task}, kMaxListed);
  const auto summary = questions.row<TaskSummary>({.verb = AdminVerb::ShowTask, .argument = task});
  const plots::LookUp look_up = look_up_of(questions);
  return plots::to_json({plots::history_of(task, std::move(attempts), distributions),
                         plots::task_paths(summary, look_up)});
}

std::string robot_figure(Questions& questions, const std::string& label) {
  const AdminRequest request{.verb = AdminVerb::ShowRobot, .argument = label};
  return plots::to_json(plots::robot_figure(questions.row<RobotSummary>(request),
                                            questions.row<RobotDescription>(request)));
}

/// Of a path, or of an attempt that found none.
std::string attempt_figure(Questions& questions, const std::string& report) {
  auto attempt = questions.row<Attempt>({.verb = AdminVerb::ShowPath, .argument = report});
  const auto description = questions.row<RobotDescription>(
      {.verb = AdminVerb::ShowRobot, .argument = attempt.robot.hex()});
  return plots::to_json(plots::attempt_figure(std::move(attempt), description));
}

struct Maker {
  std::string_view kind;
  FigureMaker make;
};

constexpr std::array kMakers = {
    Maker{"robot", robot_figure},     Maker{"path", attempt_figure},
    Maker{"attempt", attempt_figure}, Maker{"distribution", distribution_figure},
    Maker{"task", task_figure},       Maker{"savings", savings_figure},
    Maker{"slow", slow_figure},
};

}  // namespace

FigureMaker figure_maker(std::string_view kind) {
  const auto found = std::ranges::find(kMakers, kind, &Maker::kind);
  return found == kMakers.end() ? nullptr : found->make;
}

}  // namespace kinship::console
