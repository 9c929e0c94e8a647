// Distributions that have to be made, from the request to the client: a kinshipd process, DDS on
// loopback, the learning sets of the study `cobots` (500 queries of each of five robots), default
// profile with poses so dense that as many configurations come out as the budgets speak of.
//
//   cold_fetch_bench [500] [2000] [placement] [refit]      (nothing named: all of them)

#include <algorithm>
#include <map>
#include <set>
#include <string>

#include "client/link/client.hpp"
#include "tests/bench/figure.hpp"
#include "tests/bench/learning_sets.hpp"
#include "tests/bench/measure.hpp"
#include "tests/bench/processor.hpp"
#include "tests/support/reserved_domain.hpp"
#include "tests/support/server_process.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::bench {
namespace {

using std::chrono::seconds;

constexpr auto kDense = "default,max_poses_per_path=0,pose_spacing=0.12";       // about 72 000
constexpr auto kDenseOfAll = "default,max_poses_per_path=0,pose_spacing=0.07";  // about 500 000

std::string text_of(double time_s) {
  std::ostringstream text;
  text << std::fixed << std::setprecision(3) << time_s << " s";
  return text.str();
}

/// \param cpu_s  of the server, all of its threads.
std::string description(const Distribution& distribution, double cpu_s) {
  std::uint64_t paths = 0;
  for (const Source& source : distribution.sources)
    paths += source.paths_used;
  return std::to_string(paths) + " paths, " + std::to_string(distribution.configurations) +
         " configurations, transfer " + text_of(distribution.transfer_time_s) + ", fit " +
         text_of(distribution.fit_time_s) + ", CPU " + text_of(cpu_s);
}

double server_time_s(const Distribution& distribution) {
  return distribution.transfer_time_s + distribution.fit_time_s;
}

/// A server, and the cobots that reported to it.
class Fleet {
 public:
  Fleet()
      : server_({.store = directory_ / "fleet.db", .domain = domain_.number()}),
        client_({.domain = domain_.number(),
                 .outbox = {},
                 .has_outbox = false,
                 .timeout = seconds(120)}) {
    for (const std::string& robot : cobots()) {
      sets_[robot] = read_learning_set(robot);
      robots_[robot] = client_.register_robot(sets_[robot].robot).value_or_throw().robot;
    }
  }

  /// Paths of a robot's learning set, for any task.
  void report(const std::string& robot, const std::string& task, std::size_t first,
              std::size_t end) {
    std::vector<Attempt> attempts;
    for (std::size_t i = first; i < std::min(end, sets_.at(robot).solved.size()); ++i) {
      attempts.push_back(sets_.at(robot).solved[i]);
      attempts.back().report_uuid = Uuid::random();
      attempts.back().task = task;
    }
    client_.deliver(std::move(attempts)).value_or_throw();
  }

  /// What a robot asks for at a placement that nobody has asked for before.
  FetchRequest request(const std::string& target, const std::string& task,
                       const std::string& profile, const std::vector<std::string>& sources) {
    FetchRequest request;
    request.task = task;
    request.robot = robots_.at(target);
    request.profile = profile;
    request.deadline = seconds(600);
    for (const std::string& source : sources)
      request.selection.sources.push_back(robots_.at(source));
    std::sort(request.selection.sources.begin(), request.selection.sources.end());
    constexpr double kGrid_m = 0.001;  // to which placements are snapped
    request.T_task_base = Eigen::Translation3d(0, kGrid_m * (++placements_ % 20 - 10), 0) *
                          sets_.at(target).solved.front().T_task_base.value();
    return request;
  }

  Distribution fetch(const FetchRequest& request) {
    return client_.fetch(request).value_or_throw().distribution.value();
  }

  link::Client& client() { return client_; }

  /// What the server has taken of processors until now, s.
  double cpu_s() const {
    clockid_t clock = 0;
    if (clock_getcpuclockid(server_.pid(), &clock) != 0)
      throw std::runtime_error("no clock of kinshipd");
    return clock_s(clock);
  }

 private:
  const test::ReservedDomain domain_;
  const test::TemporaryDirectory directory_{test::disk_root()};
  test::ServerProcess server_;
  link::Client client_;
  std::map<std::string, LearningSet> sets_;
  std::map<std::string, Digest> robots_;
  int placements_ = 0;
};

/// \param of_all  with the paths of all others; otherwise of one.
void cold_fetches(Fleet& fleet, bool of_all) {
  const std::string task = of_all ? "cobots" : "cobots_of_one";
  for (const std::string& robot : cobots())
    fleet.report(robot, task, 0, 500);
  for (const std::string& target : cobots()) {
    std::vector<std::string> sources = {target == "panda" ? "iiwa14" : "panda"};
    if (of_all) {
      sources = cobots();
      std::erase(sources, target);
    }
    const FetchRequest request =
        fleet.request(target, task, of_all ? kDenseOfAll : kDense, sources);
    const double start_s = wall_s(), start_cpu_s = fleet.cpu_s();
    const Distribution distribution = fleet.fetch(request);
    print({.name = (of_all ? "2000 paths for " : "500 paths for ") + target,
           .value = wall_s() - start_s,
           .unit = "s",
           .reference = time_at_best(of_all ? 175e9 : 17.5e9, 1),
           .ratio_budget = 1,
           .note = description(distribution, fleet.cpu_s() - start_cpu_s)});
  }
}

/// 100 paths with the scenes they were planned in, which the server has transferred before.
void new_placement(Fleet& fleet) {
  fleet.report("panda", "placements", 0, 100);
  const auto request = [&] { return fleet.request("iiwa14", "placements", "default", {"panda"}); };
  fleet.fetch(request());
  std::vector<double> times_s, cpu_s;
  Distribution distribution;
  for (int i = 0; i < 9; ++i) {
    const FetchRequest anew = request();
    const double start_s = wall_s(), start_cpu_s = fleet.cpu_s();
    distribution = fleet.fetch(anew);
    times_s.push_back(wall_s() - start_s);
    cpu_s.push_back(fleet.cpu_s() - start_cpu_s);
  }
  print({.name = "new placement of 100 paths with scenes",
         .value = 1e3 * median(times_s),
         .unit = "ms",
         .reference = time_at_best(2.1e9, 1e-3),
         .ratio_budget = 1,
         .note = description(distribution, median(cpu_s))});
}

/// 20 paths more than 380: what the follower gets against what is made anew of all of them.
void refit(Fleet& fleet) {
  fleet.report("panda", "refit", 0, 380);
  const FetchRequest request = fleet.request("iiwa14", "refit", kDense, {"panda"});
  const auto follower = fleet.client().follow(request);
  const auto deadline = std::chrono::steady_clock::now() + seconds(120);
  const auto first = follower->wait_for_newer(nullptr, deadline);
  const double start_cpu_s = fleet.cpu_s();
  fleet.report("panda", "refit", 380, 400);
  const auto second = follower->wait_for_newer(first, deadline);
  if (!second || second == first || second->fit.value().from_revision == 0)
    throw std::runtime_error("no refit from the mixture before");
  const double refit_cpu_s = fleet.cpu_s() - start_cpu_s;
  const Distribution anew = fleet.fetch(fleet.request("iiwa14", "refit", kDense, {"panda"}));
  print({.name = "refit with 5 % new paths",
         .value = server_time_s(*second),
         .unit = "s",
         .reference = Reference{"made anew", server_time_s(anew)},
         .note = description(*second, refit_cpu_s)});
}

}  // namespace
}  // namespace kinship::bench

int main(int argc, char** argv) {
  const std::set<std::string> named(argv + 1, argv + argc);
  const auto is_wanted = [&](const char* name) { return named.empty() || named.count(name) > 0; };
  kinship::bench::Fleet fleet;
  if (is_wanted("500"))
    kinship::bench::cold_fetches(fleet, false);
  if (is_wanted("2000"))
    kinship::bench::cold_fetches(fleet, true);
  if (is_wanted("placement"))
    kinship::bench::new_placement(fleet);
  if (is_wanted("refit"))
    kinship::bench::refit(fleet);
}
