#include "tests/faults/store_answers.hpp"

#include <utility>

#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/sha256.hpp"

namespace kinship::test {
namespace {

template <typename Ask>
void ask(Ask question) {
  try {
    question();
  } catch (const Failure&) {
    // Said in words: no wrong answer.
  }
}

std::string text_of(const Path& path) { return Sha256().add(path.waypoints()).finish().hex(); }

std::string text_of(const store::RobotRecord& robot) {
  return robot.digest.hex() + json::to_json(robot.description) + std::to_string(robot.dof);
}

void ask_about_robots(const store::Store& store, const StoredThings& things, Answers& answers) {
  ask([&] {
    for (const store::RobotRecord& robot : store.robots())
      answers["robot " + robot.description.label] = text_of(robot);
  });
  for (const store::RobotRecord& robot : things.robots)
    ask([&] {
      const auto found = store.find_robot(robot.digest);
      answers["robot of " + robot.digest.hex()] = found ? text_of(*found) : "missing";
    });
  ask([&] {
    for (RobotSummary robot : store.list_robots("", 100).rows) {
      if (robot.dof == 0)
        continue;  // its row is damaged: its name alone is listed
      robot.paths = robot.attempts = 0;
      answers["listed robot " + robot.label] = json::to_json(robot);
    }
  });
  ask([&] {
    for (const TaskSummary& task : store.list_tasks("", 100).rows)
      for (const TaskRobotSummary& robot : task.robots)
        answers["task " + task.task + " of " + robot.label] = robot.robot.hex();
  });
}

void ask_about_paths(const store::Store& store, const Digest& robot, const std::string& task,
                     Answers& answers) {
  const std::string pair = robot.hex() + " " + task;
  std::vector<store::StoredPath> paths;
  ask([&] { paths = store.read_paths(robot, task, {.after_id = 0, .limit = 1000}); });
  for (const store::StoredPath& path : paths) {
    const std::string key = pair + " " + path.report_uuid.text();
    answers["path " + key] = text_of(path.path);
    if (path.scene_id)
      ask([&] {
        if (const auto scene = store.read_scene(*path.scene_id))
          answers["scene " + key] = content_digest(*scene).hex();
      });
  }
  ask([&] {
    const store::AttemptTotals totals = store.attempt_totals(robot, task);
    for (const auto& [name, sums] :
         {std::pair("guided ", totals.guided), std::pair("control ", totals.control)})
      answers[name + pair] = std::to_string(sums.attempts) + " " + std::to_string(sums.solved) +
                             " " + std::to_string(sums.checks);
    for (const store::KnownAttempt& known : totals.recent)
      answers["recent " + pair + " " + std::to_string(known.judged.checks)] = known.planner;
  });
}

void ask_about_attempts(const store::Store& store, const StoredThings& things, Answers& answers) {
  for (const Attempt& attempt : things.attempts)
    ask([&] {
      const std::string uuid = attempt.report_uuid.text();
      std::optional<Attempt> found = store.find_attempt(attempt.report_uuid);
      if (!found) {
        answers["attempt " + uuid] = "missing";
        return;
      }
      if (found->path)
        answers["attempt's path " + uuid] = text_of(*found->path);
      if (found->scene)
        answers["attempt's scene " + uuid] = content_digest(*found->scene).hex();
      found->path.reset();
      found->scene.reset();
      answers["attempt " + uuid] = json::to_json(*found);
    });
  ask([&] {
    for (PathSummary path : store.list_paths({}, "", "", 1000).rows) {
      path.received_ms = 0;
      path.retired_ms = path.retired_ms > 0 ? 1 : 0;
      answers["listed path " + path.report_uuid.text()] = json::to_json(path);
    }
  });
  ask([&] {
    for (Attempt& attempt : store.export_attempts({}, "", "", 1000, 100'000'000).rows) {
      attempt.scene.reset();  // it may be damaged alone
      answers["exported " + attempt.report_uuid.text()] = json::to_json(attempt);
    }
  });
}

void ask_about_distributions(const store::Store& store, const StoredThings& things,
                             Answers& answers) {
  for (const Distribution& distribution : things.distributions)
    ask([&] {
      if (std::optional<Distribution> found = store.find_distribution(distribution.id)) {
        found->revision = 0;
        found->store_epoch = {};
        answers["distribution " + found->id.hex()] = json::to_json(*found);
      }
    });
  ask([&] {
    for (DistributionSummary listed : store.list_distributions({}, "", "", 100).rows) {
      listed.revision = 0;
      answers["listed distribution " + listed.id.hex()] = json::to_json(listed);
    }
  });
}

}  // namespace

Answers ask_everything(const store::Store& store, const StoredThings& things) {
  Answers answers;
  ask_about_robots(store, things, answers);
  for (const store::RobotRecord& robot : things.robots)
    for (const std::string& task : things.tasks)
      ask_about_paths(store, robot.digest, task, answers);
  ask_about_attempts(store, things, answers);
  ask_about_distributions(store, things, answers);
  ask([&] { static_cast<void>(store.status()); });
  return answers;
}

std::vector<std::string> wrong_ones(const Answers& answers, const Answers& right) {
  constexpr std::size_t kShown = 200;
  std::vector<std::string> wrong;
  for (const auto& [question, answer] : answers) {
    const auto found = right.find(question);
    if (found == right.end())
      wrong.push_back(question + ": " + answer.substr(0, kShown) + " instead of nothing");
    else if (found->second != answer)
      wrong.push_back(question + ": " + answer.substr(0, kShown) + " instead of " +
                      found->second.substr(0, kShown));
  }
  return wrong;
}

}  // namespace kinship::test
