// Uniform plans of RRT-Connect with proven edges in problem files of one's own, as kinship-plan
// makes them: processor time of one thread, of the search and the proofs, and of the whole query,
// with its world and shortening.
//
//   public_sets_bench DIR [--vamp PROGRAM]
//
// DIR: problem_files.hpp. PROGRAM ROBOT FILE plans the problems of a file, too, and prints a line
// for each: the ms of its plan and of shortening it, or "-" where it has no path.

#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <iostream>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "client/guided/plan_problem.hpp"
#include "client/planner/problem_lines.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/problem_files.hpp"

namespace kinship::bench {
namespace {

namespace fs = std::filesystem;

/// Of the problems that were solved, in their order.
struct Times {
  std::vector<double> plan_ms;   ///< until there is a path
  std::vector<double> whole_ms;  ///< with all that belongs to a query, and shortened

  void add(const Times& others) {
    plan_ms.insert(plan_ms.end(), others.plan_ms.begin(), others.plan_ms.end());
    whole_ms.insert(whole_ms.end(), others.whole_ms.begin(), others.whole_ms.end());
  }
};

std::string spread_text(const std::vector<double>& times_ms) {
  std::array<char, 100> text{};
  std::snprintf(text.data(), text.size(), "mean %.3f, 95 %% %.3f", mean(times_ms),
                percentile(times_ms, 0.95));
  return text.data();
}

Times plan_all(const guided::PlannedRobot& robot, const fs::path& file, std::string& note) {
  std::ifstream stream(file);
  guided::PlanSettings settings;
  settings.planner.kind = guided::PlannerKind::RrtConnect;
  Times times;
  std::size_t count = 0, proven = 0;
  for (planner::ProblemLine& line : planner::read_problem_lines(stream)) {
    const Problem problem = std::move(line.problem).value_or_throw();
    const double begin_s = thread_cpu_s();
    const guided::PlannedProblem planned =
        guided::plan_problem(robot, problem, {}, settings, [] { return false; });
    const double whole_s = thread_cpu_s() - begin_s;
    ++count;
    if (!planned.result.solved)
      continue;
    proven += planned.result.proven ? 1 : 0;
    times.plan_ms.push_back(1e3 * planned.result.planning_time_s);
    times.whole_ms.push_back(1e3 * whole_s);
  }
  if (times.plan_ms.empty())
    throw std::runtime_error(file.string() + ": none of its " + std::to_string(count) +
                             " problems is solved; kinship-plan tells why");
  note = "solved " + std::to_string(times.plan_ms.size()) + " of " + std::to_string(count) +
         ", proven " + std::to_string(proven);
  return times;
}

/// \throws std::runtime_error if the program fails, or prints something else.
Times times_of(const std::string& program, const std::string& robot, const fs::path& file) {
  const std::string command = "'" + program + "' '" + robot + "' '" + file.string() + "'";
  const auto close = [](FILE* pipe) { pclose(pipe); };
  const std::unique_ptr<FILE, decltype(close)> pipe(popen(command.c_str(), "r"), close);
  if (!pipe)
    throw std::runtime_error("cannot run " + command);
  Times times;
  std::array<char, 256> line{};
  while (std::fgets(line.data(), line.size(), pipe.get()) != nullptr) {
    if (line[0] == '-')
      continue;
    std::istringstream words(line.data());
    double plan_ms = 0, shorten_ms = 0;
    if (!(words >> plan_ms >> shorten_ms))
      throw std::runtime_error(command + " printed: " + line.data());
    times.plan_ms.push_back(plan_ms);
    times.whole_ms.push_back(plan_ms + shorten_ms);
  }
  if (times.plan_ms.empty())
    throw std::runtime_error(command + " has no path");
  return times;
}

void print_as(const std::string& name, const Times& ours, const std::optional<Times>& theirs,
              const std::string& note) {
  const auto row = [&](const std::string& what, std::vector<double> Times::*times_ms) {
    Figure figure{.name = name + ", " + what, .value = median(ours.*times_ms), .unit = "ms"};
    figure.note = spread_text(ours.*times_ms);
    if (theirs) {
      figure.reference = Reference{"VAMP", median((*theirs).*times_ms)};
      figure.note += " (VAMP: " + spread_text((*theirs).*times_ms) + ", of " +
                     std::to_string(theirs->plan_ms.size()) + ")";
    }
    figure.note += note.empty() ? "" : "; " + note;
    print(figure);
  };
  row("median of a plan", &Times::plan_ms);
  row("median of a query with shortening", &Times::whole_ms);
}

void run(const fs::path& folder, const std::string& vamp) {
  const std::vector<fs::path> robots = files_below(folder, "robot.urdf");
  if (robots.empty())
    throw std::runtime_error(folder.string() + ": no robot.urdf in it or in its folders");
  for (const fs::path& urdf : robots) {
    const models::LoadedRobot loaded = load_robot_of(urdf.parent_path());
    const guided::PlannedRobot robot(loaded.chain, loaded.shapes);
    const std::string name = urdf.parent_path().filename();
    Times all, all_theirs;
    for (const fs::path& file : files_below(urdf.parent_path(), kProblemsEnding)) {
      std::string note;
      const Times ours = plan_all(robot, file, note);
      std::optional<Times> theirs;
      if (!vamp.empty()) {
        theirs = times_of(vamp, name, file);
        all_theirs.add(*theirs);
      }
      print_as(name + " " + kind_of(file), ours, theirs, note);
      all.add(ours);
    }
    print_as(name + ", all kinds", all, vamp.empty() ? std::nullopt : std::optional(all_theirs),
             "");
  }
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  const std::vector<std::string> words(argv + 1, argv + argc);
  const bool has_vamp = words.size() == 3 && words[1] == "--vamp";
  if (words.size() != 1 && !has_vamp) {
    std::cerr << "usage: public_sets_bench DIR [--vamp PROGRAM]\n";
    return 2;
  }
  try {
    kinship::bench::run(words[0], has_vamp ? words[2] : "");
  } catch (const std::exception& exception) {
    std::cerr << exception.what() << '\n';
    return 1;
  }
}
