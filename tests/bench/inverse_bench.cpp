// Inverse kinematics at reachable poses, all robots of robots/models and arms of general structure:
// configurations per second of CPU time, chosen (L = 8, d = 0.2) and verified; beside KDL, and EAIK
// where it was built, at the same poses. Of these, what is free of collisions among boxes; and
// poses without a solution. One thread.
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
#include "tests/bench/processor.hpp"
#include "tests/bench/reachable_poses.hpp"
#include "tests/bench/reference.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/support/random_chain.hpp"

namespace kinship::bench {
namespace {

constexpr int kPoses = 1000;
constexpr int kPosesForKdl = 300;

struct Subject {
  std::string name;
  kinematics::Chain chain;
  double multiply_adds;  ///< that a configuration may take at the processor's best
  bool is_cobot;
};

std::vector<Subject> subjects() {
  std::vector<Subject> result;
  for (const auto& [model, multiply_adds] :
       {std::pair("ur10e", 23e3), std::pair("iiwa14", 70e3), std::pair("panda", 47e3),
        std::pair("sawyer", 140e3), std::pair("sara_like", 70e3)})
    result.push_back({model, test::model_chain(model), multiply_adds, true});
  for (const char* model : {"planar_5r_a", "planar_7r_c"})
    result.push_back({model, test::model_chain(model), 70e3, false});
  std::mt19937_64 generator(6);
  for (int i = 1; i <= 3; ++i)
    result.push_back(
        {"general 6R, " + std::to_string(i), test::random_chain({}, generator), 175e3, false});
  return result;
}

using Poses = std::vector<Eigen::Isometry3d>;

inverse::InverseSolutions solve(const Subject& subject, const inverse::Solver& solver,
                                const Eigen::Isometry3d& T_base_transfer) {
  return solver.solve(T_base_transfer * subject.chain.T_tip_transfer().inverse(),
                      {.max_solutions = 8, .min_distance = 0.2});
}

struct Run {
  double solutions = 0, missed = 0;
};

Run solve_all(const Subject& subject, const inverse::Solver& solver, const Poses& poses) {
  Run run;
  for (const Eigen::Isometry3d& T_base_transfer : poses) {
    const auto found = solve(subject, solver, T_base_transfer);
    run.solutions += static_cast<double>(found.configurations.cols());
    run.missed += found.configurations.cols() == 0 ? 1 : 0;
  }
  return run;
}

/// Solutions that are free in a shelf cell, self-collisions too, found and checked; beside FCL.
void print_free(const Subject& subject, const inverse::Solver& solver, const Poses& poses) {
  std::mt19937_64 generator(1);
  collision::CollisionWorld world(subject.chain, model_shapes(subject.name),
                                  make_shelf_cell(subject.chain, generator).surroundings);
  Eigen::Index found = 0, free = 0;
  const auto by_lanes = [&](const Eigen::MatrixXd& qs) {
    for (Eigen::Index first = 0; first < qs.cols(); ++first) {
      const Eigen::Index ahead = world.free_ahead(qs.rightCols(qs.cols() - first));
      free += ahead;
      first += ahead;
    }
  };
  const auto by_fcl = [&](const Eigen::MatrixXd& qs) {
    for (const auto& q : qs.colwise())
      free += world.find_contact(q) ? 0 : 1;
  };
  const auto rate = [&](int runs, const auto& check) {
    const double taken_s = least_s(runs, thread_cpu_s, [&] {
      found = free = 0;
      for (const Eigen::Isometry3d& T_base_transfer : poses) {
        const auto solutions = solve(subject, solver, T_base_transfer);
        found += solutions.configurations.cols();
        check(solutions.configurations);
      }
    });
    return static_cast<double>(free) / taken_s;
  };
  const double fcl_rate = rate(1, by_fcl);
  print({.name = subject.name + ", free of collisions",
         .value = rate(3, by_lanes),
         .unit = "configurations/s",
         .better = Better::Higher,
         .reference = Reference{"checked by FCL", fcl_rate},
         .note = std::to_string(100 * free / found) + " % free, among 12 boxes with a held box"});
}

double us_a_pose(const Subject& subject, const inverse::Solver& solver, const Poses& poses) {
  const double taken_s =
      least_s(3, thread_cpu_s, [&] { static_cast<void>(solve_all(subject, solver, poses)); });
  return 1e6 * taken_s / static_cast<double>(poses.size());
}

/// What the answer "none" costs, beside a pose that has solutions.
void print_unreached(const Subject& subject, const inverse::Solver& solver, const Poses& poses) {
  constexpr double kFar_m = 10;
  Poses far, turned;  // too far away; at places within reach, with the orientations of others
  for (std::size_t i = 0; i < poses.size(); ++i) {
    far.push_back(poses[i]);
    far.back().translation() *= kFar_m / poses[i].translation().norm();
    Eigen::Isometry3d each = poses[i];
    each.linear() = poses[(i + poses.size() / 2) % poses.size()].linear();
    if (solve(subject, solver, each).configurations.cols() == 0)
      turned.push_back(each);
  }
  const Reference reached{"a pose with solutions", us_a_pose(subject, solver, poses)};
  print({.name = subject.name + ", a pose that is too far away",
         .value = us_a_pose(subject, solver, far),
         .unit = "us",
         .reference = reached,
         .ratio_budget = 0.1});
  if (!turned.empty())
    print({.name = subject.name + ", a place within reach, an orientation that is not",
           .value = us_a_pose(subject, solver, turned),
           .unit = "us",
           .reference = reached,
           .ratio_budget = 1,
           .note = std::to_string(turned.size()) + " of " + std::to_string(poses.size()) +
                   " places with the orientation of another"});
}

/// Beside KDL. \return poses that KDL missed.
double print_to_kdl(Figure figure) {
  const std::vector<double> kdl = run_reference(
      {beside_this_program("reference_kdl"), figure.name, std::to_string(kPosesForKdl)}, 2);
  figure.name += ", to KDL";
  figure.ratio_budget.reset();
  figure.reference = Reference{"KDL, one solution a pose", kdl[0]};
  print(figure);
  return kdl[1];
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
  figure.ratio_budget.reset();
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
    const Poses wanted = reachable_poses(subject.chain, kPoses);
    Run run;
    const double taken_s =
        least_s(5, thread_cpu_s, [&] { run = solve_all(subject, solver, wanted); });
    const Figure figure{.name = subject.name,
                        .value = run.solutions / taken_s,
                        .unit = "configurations/s",
                        .better = Better::Higher,
                        .reference = rate_at_best(subject.multiply_adds),
                        .ratio_budget = 1,
                        .note = solver.name()};
    print(figure);
    if (has_references && subject.is_cobot) {
      missed_by_kdl += print_to_kdl(figure);
      poses_for_kdl += kPosesForKdl;
      print_to_eaik(figure);
    }
    if (subject.is_cobot) {
      print_free(subject, solver, wanted);
      print_unreached(subject, solver, wanted);
    }
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
