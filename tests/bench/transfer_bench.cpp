#include <zstd.h>

#include <algorithm>
#include <chrono>
#include <ctime>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iomanip>
#include <iostream>
#include <iterator>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "robots/inverse/descent.hpp"
#include "robots/inverse/joint_space.hpp"
#include "server/transfer/path_poses.hpp"
#include "server/transfer/resample.hpp"
#include "server/transfer/transfer.hpp"
#include "tests/support/robots.hpp"

// Transfer end to end between the five cobots: the paths of their learning sets, resampled, from
// each to each other, on two threads, without filters; with random solutions (L = 8, d = 0.2) and
// with the tracks of the default profile. Rates per second of wall clock, and per two seconds of
// CPU time for machines that others use too. Of the poses without a solution some are asked of
// another engine: scalar descents from many starts.
//
//   cobots_bench [paths a pair] [folder of learning sets]
namespace kinship {
namespace {

namespace fs = std::filesystem;

constexpr int kThreads = 2;
constexpr std::size_t kGroup = 16;
constexpr std::size_t kAskedAgain = 60;  // poses without a solution, of each pair
constexpr int kOtherStarts = 1000;
constexpr int kOtherIterations = 40;

struct Teacher {
  std::string name;
  std::unique_ptr<kinematics::Chain> chain;
  Eigen::Isometry3d T_task_base = Eigen::Isometry3d::Identity();
  std::vector<Path> paths;
};

std::string expanded(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  const std::string packed((std::istreambuf_iterator<char>(stream)), {});
  const auto size = ZSTD_getFrameContentSize(packed.data(), packed.size());
  if (packed.empty() || size == ZSTD_CONTENTSIZE_UNKNOWN || size == ZSTD_CONTENTSIZE_ERROR)
    throw std::runtime_error(file.string() + ": no learning set");
  std::string text(size, '\0');
  if (ZSTD_decompress(text.data(), size, packed.data(), packed.size()) != size)
    throw std::runtime_error(file.string() + ": damaged");
  return text;
}

Teacher read_teacher(const std::string& name, const fs::path& folder, std::size_t most) {
  Teacher teacher{name, std::make_unique<kinematics::Chain>(test::model_chain(name)), {}, {}};
  teacher.T_task_base.setIdentity();
  std::istringstream lines(expanded(folder / (name + ".jsonl.zst")));
  for (std::string line; teacher.paths.size() < most && std::getline(lines, line);) {
    const nlohmann::json attempt = nlohmann::json::parse(line);
    if (!attempt.contains("waypoints") || attempt["waypoints"].is_null())
      continue;
    const auto waypoints = attempt["waypoints"].get<std::vector<std::vector<double>>>();
    Eigen::MatrixXd path(teacher.chain->dof(), static_cast<Eigen::Index>(waypoints.size()));
    for (std::size_t i = 0; i < waypoints.size(); ++i)
      path.col(static_cast<Eigen::Index>(i)) =
          Eigen::Map<const Eigen::VectorXd>(waypoints[i].data(), path.rows());
    teacher.paths.emplace_back(path);
    const auto pose = attempt["T_task_base"].get<std::vector<double>>();
    teacher.T_task_base = Eigen::Translation3d(pose.at(0), pose.at(1), pose.at(2)) *
                          Eigen::Quaterniond(pose.at(6), pose.at(3), pose.at(4), pose.at(5));
  }
  return teacher;
}

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

struct Run {
  transfer::TransferSummary summary;
  std::vector<Eigen::Isometry3d> unsolved;  // of the transfer frame, in the target's base
  double wall_s = 0, processor_s = 0;

  double per_wall_second() const { return static_cast<double>(summary.configurations) / wall_s; }
  double per_processors_second() const {
    return kThreads * static_cast<double>(summary.configurations) / processor_s;
  }
};

/// Threads take groups of paths in turn, as the server does.
Run run_pair(const Teacher& source, const transfer::ArmPair& pair,
             const Eigen::Isometry3d& T_target_source, const TransferParameters& parameters) {
  const transfer::Filters none;
  std::vector<transfer::TransferredPath> results(source.paths.size());
  const auto work = [&](std::size_t thread) {
    for (std::size_t first = thread * kGroup; first < results.size(); first += kThreads * kGroup) {
      std::vector<transfer::PathToTransfer> group;
      for (std::size_t i = first; i < std::min(first + kGroup, results.size()); ++i)
        group.push_back({source.paths[i], T_target_source, none});
      std::ranges::move(transfer::transfer_paths(group, pair, parameters, 0),
                        results.begin() + static_cast<std::ptrdiff_t>(first));
    }
  };
  Run run;
  const auto start = std::chrono::steady_clock::now();
  const double start_cpu_s = cpu_s();
  {
    std::vector<std::jthread> threads;
    for (std::size_t i = 0; i < kThreads; ++i)
      threads.emplace_back(work, i);
  }
  run.processor_s = cpu_s() - start_cpu_s;
  run.wall_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  for (std::size_t i = 0; i < results.size(); ++i) {
    run.summary.add(results[i].summary);
    const auto poses = transfer::path_poses(transfer::resample(source.paths[i], parameters), pair,
                                            T_target_source);
    std::vector<bool> solved(poses.T_base_transfer.size(), false);
    for (const int pose : results[i].pose_index)
      solved[static_cast<std::size_t>(pose)] = true;
    for (std::size_t pose = 0; pose < solved.size(); ++pose)
      if (!solved[pose])
        run.unsolved.push_back(poses.T_base_transfer[pose]);
  }
  return run;
}

/// Whether one of many scalar descents, half of them holding the limits, reaches the pose.
bool other_engine_reaches(const kinematics::Chain& chain,
                          const Eigen::Isometry3d& T_base_transfer) {
  const inverse::Descent descent(chain);
  const inverse::JointSpace space(chain);
  std::mt19937_64 generator(5);
  for (int i = 0; i < kOtherStarts; ++i) {
    inverse::JointVector q = test::random_configuration(chain, generator);
    descent.run(T_base_transfer,
                i % 2 == 0 ? inverse::Descent::Limits::Steer : inverse::Descent::Limits::Hold,
                kOtherIterations, q);
    if (space.normalize(q.data()) && inverse::reaches(chain, T_base_transfer, q))
      return true;
  }
  return false;
}

/// Share of all poses that the other engine reaches and ours left, judged by a part of these.
double missed_share(const kinematics::Chain& target, Run& run) {
  if (run.unsolved.empty())
    return 0;
  std::mt19937_64 generator(3);
  std::shuffle(run.unsolved.begin(), run.unsolved.end(), generator);
  const std::size_t asked = std::min(kAskedAgain, run.unsolved.size());
  std::size_t reached = 0;
  for (std::size_t i = 0; i < asked; ++i)
    reached += other_engine_reaches(target, run.unsolved[i]) ? 1U : 0U;
  return static_cast<double>(reached) / static_cast<double>(asked) *
         static_cast<double>(run.unsolved.size()) / static_cast<double>(run.summary.poses);
}

void print_pairs(const std::vector<Teacher>& teachers) {
  const TransferParameters random{.max_solutions = 8, .min_distance = 0.2, .tracks = 0};
  double rates[4] = {}, missed = 0;
  int pairs = 0;
  for (const Teacher& source : teachers)
    for (const Teacher& target : teachers) {
      if (&source == &target)
        continue;
      const transfer::ArmPair pair(*source.chain, *target.chain);
      const Eigen::Isometry3d T_target_source = target.T_task_base.inverse() * source.T_task_base;
      Run alone = run_pair(source, pair, T_target_source, random);
      const Run tracked = run_pair(source, pair, T_target_source, {});
      const double share = missed_share(*target.chain, alone);
      const double all[4] = {alone.per_wall_second(), alone.per_processors_second(),
                             tracked.per_wall_second(), tracked.per_processors_second()};
      ++pairs;
      missed += share;
      std::cout << "| " << source.name << " | " << target.name << " | " << alone.summary.poses
                << " | " << std::setprecision(1)
                << 100.0 * static_cast<double>(alone.summary.poses_solved) /
                       static_cast<double>(alone.summary.poses)
                << " % | " << std::setprecision(3) << 100 * share << " % |" << std::setprecision(0);
      for (int i = 0; i < 4; ++i) {
        rates[i] += all[i];
        std::cout << ' ' << all[i] / 1000 << " |";
      }
      std::cout << std::endl;
    }
  std::cout << "| mean of pairs | | | | " << std::setprecision(3) << 100 * missed / pairs << " % |"
            << std::setprecision(0);
  for (const double rate : rates)
    std::cout << ' ' << rate / pairs / 1000 << " |";
  std::cout << "\n";
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  using namespace kinship;
  const std::size_t most = argc > 1 ? std::stoul(argv[1]) : 500;
  const fs::path folder =
      argc > 2 ? argv[2] : KINSHIP_SOURCE_DIR "/client/experiments/results/cobots/learning";
  std::vector<Teacher> teachers;
  for (const char* name : {"ur10e", "iiwa14", "panda", "sawyer", "sara_like"})
    teachers.push_back(read_teacher(name, folder, most));
  std::cout
      << std::fixed
      << "| From | To | poses | solved | missed | random k/s | by CPU time | default k/s | by "
         "CPU time |\n|---|---|---|---|---|---|---|---|---|\n";
  print_pairs(teachers);
}
