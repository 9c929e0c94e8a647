#include "server/console/figures.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pages/plots/plot_pages.hpp"
#include "server/console/recent_attempts.hpp"

namespace kinship::console {
namespace {

constexpr std::size_t kMaxAttempts = 200'000;  // of a task's history

std::string distribution_figure(Questions& questions, const std::string& id) {
  auto distribution =
      questions.row<Distribution>({.verb = AdminVerb::ShowDistribution, .argument = id});
  const auto description = questions.row<RobotDescription>(
      {.verb = AdminVerb::ShowRobot, .argument = distribution.robot.hex()});
  return plots::to_json(plots::plot_of(std::move(distribution), description));
}

std::string task_figure(Questions& questions, const std::string& task) {
  auto attempts =
      questions.rows<AttemptSummary>({.verb = AdminVerb::ListAttempts, .task = task}, kMaxAttempts);
  if (attempts.empty())
    throw Failure(ErrorCode::NotFound, "no attempt of task '" + task + "'");
  const auto distributions = questions.rows<DistributionSummary>(
      {.verb = AdminVerb::ListDistributions, .task = task}, kMaxAttempts);
  return plots::to_json(plots::history_of(task, std::move(attempts), distributions));
}

std::string robot_figure(Questions& questions, const std::string& label) {
  const AdminRequest request{.verb = AdminVerb::ShowRobot, .argument = label};
  const auto meshes = questions.rows<StoredMesh>({.verb = AdminVerb::ListMeshes, .argument = label},
                                                 kMaxLinkMeshes);
  return plots::to_json(plots::robot_figure(questions.row<RobotSummary>(request),
                                            questions.row<RobotDescription>(request), meshes));
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
