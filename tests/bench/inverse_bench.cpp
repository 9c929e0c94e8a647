// Inverse kinematics at reachable poses, all robots of robots/models and arms of general structure:
// configurations per second of CPU time, chosen (L = 8, d = 0.2) and verified; beside KDL, and EAIK
// where it was built, at the same poses. One thread.
//
//   inverse_bench [--no-references]

#include <algorithm>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "robots/inverse/solver.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/reachable_poses.hpp"
#include "tests/bench/reference.hpp"
#include "tests/support/random_chain.hpp"

namespace kinship::bench {
namespace {

constexpr int kPoses = 1000;
constexpr int kPosesForKdl = 300;

struct Subject {
  std::string name;
  kinematics::Chain chain;
  double budget_per_s;
  bool is_cobot;
};

std::vector<Subject> subjects() {
  std::vector<Subject> result;
  for (const auto& [model, budget_per_s] :
       {std::pair("ur10e", 1e6), std::pair("iiwa14", 1e6), std::pair("panda", 350e3),
        std::pair("sawyer", 500e3), std::pair("sara_like", 1e6)})
    result.push_back({model, test::model_chain(model), budget_per_s, true});
  for (const char* model : {"planar_5r_a", "planar_7r_c"})
    result.push_back({model, test::model_chain(model), 1e6, false});
  std::mt19937_64 generator(6);
  for (int i = 1; i <= 3; ++i)
    result.push_back(
        {"general 6R, " + std::to_string(i), test::random_chain({}, generator), 400e3, false});
  return result;
}

struct Run {
  double solutions = 0, missed = 0;
};

Run solve_all(const Subject& subject, const inverse::Solver& solver,
              const std::vector<Eigen::Isometry3d>& poses) {
  const Eigen::Isometry3d T_transfer_tip = subject.chain.T_tip_transfer().inverse();
  Run run;
  for (const Eigen::Isometry3d& T_base_transfer : poses) {
    const auto found =
        solver.solve(T_base_transfer * T_transfer_tip, {.max_solutions = 8, .min_distance = 0.2});
    run.solutions += static_cast<double>(found.configurations.cols());
    run.missed += found.configurations.cols() == 0 ? 1 : 0;
  }
  return run;
}

/// Beside EAIK, if the build was pointed to it and it can decompose the arm.
void print_to_eaik(Figure figure) {
  const std::string program = beside_this_program("reference_eaik");
  if (!std::filesystem::exists(program))
    return;
  const std::vector<double> eaik = run_reference({program, figure.name, std::to_string(kPoses)}, 3);
  if (eaik[0] == 0)
    return;
  figure.name += ", to EAIK";
  figure.budget.reset();
  figure.reference = Reference{"EAIK", eaik[0]};
  const int lock = static_cast<int>(eaik[2]);
  figure.note =
      "EAIK: counted as ours, chosen outside its time; " +
      (lock == 0 ? "" : "joint " + std::to_string(lock) + " locked, drawn anew a pose; ") +
      std::to_string(static_cast<int>(eaik[1])) + " of " + std::to_string(kPoses) + " poses missed";
  print(figure);
}

void measure(bool has_references) {
  double missed = 0, missed_by_kdl = 0, poses_for_kdl = 0, poses = 0;
  for (const Subject& subject : subjects()) {
    const inverse::Solver solver(subject.chain);
    const std::vector<Eigen::Isometry3d> wanted = reachable_poses(subject.chain, kPoses);
    Run run;
    const double taken_s =
        least_s(5, thread_cpu_s, [&] { run = solve_all(subject, solver, wanted); });
    Figure figure{.name = subject.name,
                  .value = run.solutions / taken_s,
                  .unit = "configurations/s",
                  .better = Better::Higher,
                  .budget = subject.budget_per_s,
                  .note = solver.name()};
    if (has_references && subject.is_cobot) {
      const std::vector<double> kdl = run_reference(
          {beside_this_program("reference_kdl"), subject.name, std::to_string(kPosesForKdl)}, 2);
      figure.reference = Reference{"KDL, one solution a pose", kdl[0]};
      missed_by_kdl += kdl[1];
      poses_for_kdl += kPosesForKdl;
    }
    print(figure);
    if (has_references && subject.is_cobot)
      print_to_eaik(figure);
    missed += run.missed;
    poses += kPoses;
  }
  Figure all{
      .name = "poses missed, all robots", .value = 100 * missed / poses, .unit = "%", .budget = 0};
  if (has_references)
    all.reference = Reference{"KDL, 100 starts, cobots", 100 * missed_by_kdl / poses_for_kdl};
  print(all);
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  kinship::bench::measure(kinship::bench::wants_references(argc, argv));
}
