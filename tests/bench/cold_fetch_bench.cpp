// A distribution that nobody has asked for before, from the request to the client: a kinshipd
// process, DDS on loopback, the learning sets of the study `cobots`, each of its robots as target.
//
//   cold_fetch_bench LEARNING_FOLDER [REPEATS] [PROFILE...]
//
// Prints per target, amount and profile the medians of REPEATS (3) cold fetches: all of it, the
// transfer and the fit as the server says, the wire (the same reply again, from memory), and the
// rest: look-up, storing it durably. CPU is that of the server's process.

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>

#include "client/link/client.hpp"
#include "tests/bench/learning_sets.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;
using std::chrono::seconds;

/// A profile, and the spacings of poses that make about 72 000 configurations of one robot's paths
/// and 500 000 of four robots'.
struct Case {
  std::string profile, small, large;
};

const std::vector<Case> kCases = {
    {"default", "0.12", "0.07"},
    {"default,tracks=0", "0.3", "0.18"},
    {"default,max_solutions=8,min_distance=0.2,dropped_end_share=0", "0.24", "0.18"}};

/// Seconds of a process's life on processors.
double cpu_of(pid_t process) {
  std::ifstream file("/proc/" + std::to_string(process) + "/stat");
  std::string word;
  while (file >> word && word.back() != ')') {
  }
  constexpr int kUser = 12;  // words after the name
  double user = 0, kernel = 0;
  for (int i = 1; i < kUser; ++i)
    file >> word;
  file >> user >> kernel;
  return (user + kernel) / static_cast<double>(sysconf(_SC_CLK_TCK));
}

struct Sample {
  double total = 0, transfer = 0, fit = 0, wire = 0, cpu = 0;
};

double median(std::vector<Sample> samples, double Sample::*member) {
  std::sort(samples.begin(), samples.end(),
            [&](const Sample& a, const Sample& b) { return a.*member < b.*member; });
  return samples[samples.size() / 2].*member;
}

/// What is asked for a target, but for the profile.
struct Amount {
  const char* name;
  bool all_sources;
  std::string profile;
};

class Bench {
 public:
  Bench(const std::filesystem::path& folder, int repeats)
      : repeats_(repeats),
        server_({.store = directory_ / "fleet.db", .domain = domain_.number(), .arguments = {}}),
        client_({.domain = domain_.number(),
                 .outbox = {},
                 .has_outbox = false,
                 .timeout = seconds(120)}) {
    for (const std::string& robot : bench::cobots()) {
      bench::LearningSet set = bench::read_learning_set(folder, robot);
      robots_[robot] = client_.register_robot(set.robot).value_or_throw().robot;
      placements_[robot] = set.solved.front().T_task_base.value();
      task_ = set.solved.front().task;
      client_.deliver(std::move(set.solved)).value_or_throw();
    }
  }

  void measure(const std::string& target, const Amount& amount) {
    FetchRequest request;
    request.task = task_;
    request.robot = robots_.at(target);
    request.profile = amount.profile;
    request.deadline = seconds(600);
    for (const auto& [name, robot] : robots_)
      if (amount.all_sources ? name != target : name == (target == "panda" ? "iiwa14" : "panda"))
        request.selection.sources.push_back(robot);
    std::sort(request.selection.sources.begin(), request.selection.sources.end());
    std::vector<Sample> samples;
    Distribution distribution;
    for (int i = 0; i < repeats_; ++i) {
      constexpr double kGrid_m = 0.001;  // another placement is another distribution
      request.T_task_base =
          Eigen::Translation3d(0, kGrid_m * (shift_++ % 20 - 10), 0) * placements_.at(target);
      samples.push_back(fetch_cold(request, distribution));
    }
    print(target, amount, samples, distribution);
  }

 private:
  double fetch(const FetchRequest& request, Distribution& distribution) {
    const auto begin = std::chrono::steady_clock::now();
    FetchReply reply = client_.fetch(request).value_or_throw();
    const double time =
        std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    distribution = std::move(reply.distribution).value();
    return time;
  }

  Sample fetch_cold(const FetchRequest& request, Distribution& distribution) {
    constexpr int kWarm = 20;
    Sample sample;
    const double before = cpu_of(server_.pid());
    sample.total = fetch(request, distribution);
    sample.cpu = cpu_of(server_.pid()) - before;
    sample.transfer = distribution.transfer_time_s;
    sample.fit = distribution.fit_time_s;
    sample.wire = sample.total;
    for (int i = 0; i < kWarm; ++i)
      sample.wire = std::min(sample.wire, fetch(request, distribution));
    return sample;
  }

  static void print(const std::string& target, const Amount& amount,
                    const std::vector<Sample>& samples, const Distribution& distribution) {
    std::uint64_t paths = 0, poses = 0;
    for (const Source& source : distribution.sources) {
      paths += source.paths_used;
      poses += source.poses;
    }
    const double total = median(samples, &Sample::total), wire = median(samples, &Sample::wire);
    const double transfer = median(samples, &Sample::transfer), fit = median(samples, &Sample::fit);
    std::printf(
        "%-10s %-5s %5lu paths %6lu poses %7lu configurations K %3ld | total %6.2f s = "
        "transfer %6.2f + fit %5.2f + rest %.3f + wire %.4f | cpu %6.2f s | %s\n",
        target.c_str(), amount.name, static_cast<unsigned long>(paths),
        static_cast<unsigned long>(poses), static_cast<unsigned long>(distribution.configurations),
        distribution.mixture ? static_cast<long>(distribution.mixture->size()) : 0, total, transfer,
        fit, total - transfer - fit - wire, wire, median(samples, &Sample::cpu),
        amount.profile.c_str());
    std::fflush(stdout);
  }

  const int repeats_;
  const test::ReservedDomain domain_;
  const test::TemporaryDirectory directory_{test::disk_root()};
  test::ServerProcess server_;
  link::Client client_;
  std::map<std::string, Digest> robots_;
  std::map<std::string, Eigen::Isometry3d> placements_;
  std::string task_;
  int shift_ = 0;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "cold_fetch_bench LEARNING_FOLDER [REPEATS] [PROFILE...]\n");
    return 2;
  }
  Bench bench(argv[1], argc > 2 ? std::max(1, std::atoi(argv[2])) : 3);
  std::vector<Case> cases = kCases;
  if (argc > 3) {
    cases.clear();
    for (int i = 3; i < argc; ++i)
      cases.push_back({argv[i], kCases.front().small, kCases.front().large});
  }
  for (const Case& wanted : cases)
    for (const bool is_large : {false, true}) {
      const std::string profile = wanted.profile + ",max_poses_per_path=0,pose_spacing=" +
                                  (is_large ? wanted.large : wanted.small);
      for (const std::string& target : bench::cobots())
        bench.measure(target, {is_large ? "large" : "small", is_large, profile});
    }
  return 0;
}
