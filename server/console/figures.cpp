#include "server/console/figures.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <functional>
#include <optional>
#include <utility>

#include "pages/plots/plot_pages.hpp"
#include "pages/plots/same_query.hpp"
#include "server/console/recent_attempts.hpp"

namespace kinship::console {
namespace {

constexpr std::size_t kMaxCompared = 100;  // attempts that may have had the same query
constexpr std::size_t kMaxKept = 16;
constexpr int kKeptPerTime = 100;
constexpr std::uint32_t kPathsPerPage = 200;  // many figures need few
constexpr std::size_t kMaxListed = 200'000;   // rows of a task's history

plots::LookUp look_up_of(Questions& questions) {
  return {
      .for_each_path =
          [&](const std::string& task, const std::optional<Digest>& robot, const auto& take) {
            AdminRequest request{.verb = AdminVerb::ListPaths,
                                 .robot = robot ? robot->hex() : "",
                                 .task = task,
                                 .limit = kPathsPerPage};
            do {
              service::AdminPage page = questions.answer(request);
              for (service::AdminRow& row : page.rows)
                if (!take(std::get<PathSummary>(std::move(row))))
                  return;
              request.cursor = page.next_cursor;
            } while (!request.cursor.empty());
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
  const auto meshes = questions.rows<StoredMesh>({.verb = AdminVerb::ListMeshes, .argument = label},
                                                 kMaxLinkMeshes);
  return plots::to_json(plots::robot_figure(questions.row<RobotSummary>(request),
                                            questions.row<RobotDescription>(request), meshes));
}

/// The attempt of the same query by guidance where this one had none, or the other way round: the
/// nearest in time among the newest of its robot and task.
std::optional<Attempt> planned_otherwise(Questions& questions, const plots::AttemptFigure& figure) {
  const Attempt& attempt = figure.attempt;
  const auto is_guided = [](const PlanningRecord& record) {
    return record.sampling_mode == SamplingMode::Guided;
  };
  std::vector<AttemptSummary> newest = questions.rows<AttemptSummary>(
      {.verb = AdminVerb::FindAttempts, .robot = attempt.robot.hex(), .task = attempt.task},
      kMaxPageRows);
  const auto own = std::ranges::find(newest, attempt.report_uuid, &AttemptSummary::report_uuid);
  const std::int64_t received_ms = own == newest.end() ? 0 : own->received_ms;
  std::erase_if(newest, [&](const AttemptSummary& each) {
    return is_guided(each.record) == is_guided(attempt.record);
  });
  std::ranges::stable_sort(newest, std::less(), [&](const AttemptSummary& each) {
    return std::abs(each.received_ms - received_ms);
  });
  newest.resize(std::min(newest.size(), kMaxCompared));
  for (const AttemptSummary& each : newest)
    try {
      auto other = questions.row<Attempt>(
          {.verb = AdminVerb::ShowPath, .argument = each.report_uuid.text()});
      if (plots::is_same_query(figure, other))
        return other;
    } catch (const Failure&) {  // it is gone, or damaged: this is no fault of what is drawn
    }
  return std::nullopt;
}

/// Of a path, or of an attempt that found none.
std::string attempt_figure(Questions& questions, const std::string& report) {
  auto attempt = questions.row<Attempt>({.verb = AdminVerb::ShowPath, .argument = report});
  const auto description = questions.row<RobotDescription>(
      {.verb = AdminVerb::ShowRobot, .argument = attempt.robot.hex()});
  plots::AttemptFigure figure = plots::attempt_figure(std::move(attempt), description);
  if (std::optional<Attempt> other = planned_otherwise(questions, figure))
    figure.others.push_back(plots::attempt_figure(*std::move(other), description));
  return plots::to_json(figure);
}

struct Maker {
  std::string_view kind;
  std::string (*make)(Questions& questions, const std::string& name);
  bool is_kept = false;
};

constexpr std::array kMakers = {
    Maker{"robot", robot_figure},
    Maker{"path", attempt_figure},
    Maker{"attempt", attempt_figure},
    Maker{"distribution", distribution_figure},
    Maker{"task", task_figure},
    Maker{"slow", slow_figure, true},
    Maker{"savings", savings_figure, true},
};

const Maker* maker_of(std::string_view kind) {
  const auto found = std::ranges::find(kMakers, kind, &Maker::kind);
  return found == kMakers.end() ? nullptr : &*found;
}

}  // namespace

bool Figures::has_kind(std::string_view kind) { return maker_of(kind) != nullptr; }

const std::string& Figures::make(const std::string& kind, const std::string& name) {
  const Maker& maker = *maker_of(kind);
  const Clock::time_point begin = now_();
  if (!maker.is_kept)
    return text_ = maker.make(questions_, name);
  const std::pair key(kind, name);
  if (const auto found = kept_.find(key); found != kept_.end() && begin < found->second.until)
    return found->second.text;
  if (kept_.size() >= kMaxKept)
    kept_.clear();
  std::string text = maker.make(questions_, name);
  const Clock::time_point end = now_();
  return (kept_[key] = {std::move(text), end + kKeptPerTime * (end - begin)}).text;
}

}  // namespace kinship::console
