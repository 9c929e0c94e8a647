// A refit with 5 % new paths, warm and cold: what each costs and how well it describes paths that
// neither saw. Each robot of the study `cobots` as target, the next one's learning set as source.
//
//   refit_bench LEARNING_FOLDER [PROFILE...]
//
// CPU seconds on one thread, medians of three.

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <future>
#include <string>

#include "proto/types/profile_text.hpp"
#include "server/fitting/branch_cuts.hpp"
#include "server/fitting/fit_distribution.hpp"
#include "server/fitting/source_transfer.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/bench/learning_sets.hpp"
#include "tests/support/log_density.hpp"
#include "tests/support/temporary_directory.hpp"

namespace {

using namespace kinship;
using namespace kinship::service;

constexpr std::ptrdiff_t kFirst = 380, kAll = 400;  // of about 500; the others are held out

double cpu_now() { return static_cast<double>(std::clock()) / CLOCKS_PER_SEC; }

/// A store of one robot's paths.
class Fleet {
 public:
  Fleet(const bench::LearningSet& source, const RobotDescription& target)
      : target_(registry_.register_robot(target, 1).robot) {
    source_ = registry_.register_robot(source.robot, 1).robot;
  }
  void report(std::vector<Attempt> attempts) {
    for (Attempt& attempt : attempts)
      attempt.robot = source_;
    std::promise<void> done;
    store_->commit_reports(std::move(attempts),
                           [&](const std::vector<Receipt>&) { done.set_value(); });
    done.get_future().wait();
  }
  store::Store& store() { return *store_; }
  RobotRegistry& robots() { return registry_; }
  const Digest& target() const { return target_; }

 private:
  test::TemporaryDirectory directory_{test::disk_root()};
  std::unique_ptr<store::Store> store_ = store::open_sqlite_store(directory_ / "fleet.db");
  RobotRegistry registry_{*store_};
  Digest target_, source_;
};

/// A clock of CPU time, so that what a distribution says of its times is that.
Clock cpu_clock() {
  Clock clock;
  clock.now = [] {
    return std::chrono::steady_clock::time_point(
        std::chrono::duration_cast<std::chrono::steady_clock::duration>(
            std::chrono::duration<double>(cpu_now())));
  };
  return clock;
}

struct Cost {
  double transfer = 0, fit = 0, score = 0;
};

/// Mean over configurations of log(0.99 p + 0.01 u), u uniform within the limits.
double score_of(const Distribution& distribution, Eigen::MatrixXd others) {
  constexpr double kBackground = 0.01;
  wrap(distribution.cuts, others);
  const double log_uniform =
      -(distribution.limits.row(1) - distribution.limits.row(0)).array().log().sum();
  const Eigen::ArrayXd densities = test::log_density(*distribution.mixture, others);
  return ((1 - kBackground) * densities.exp() + kBackground * std::exp(log_uniform)).log().mean();
}

/// The median of three by transfer and by fit.
Cost cost_of(const DistributionKey& key, const FitContext& context, const Eigen::MatrixXd& others) {
  std::vector<double> transfers, fits;
  Cost cost;
  for (int i = 0; i < 3; ++i) {
    const Distribution distribution = fit_distribution(key, context, {}).distribution.value();
    transfers.push_back(distribution.transfer_time_s);
    fits.push_back(distribution.fit_time_s);
    cost.score = score_of(distribution, others);
  }
  std::sort(transfers.begin(), transfers.end());
  std::sort(fits.begin(), fits.end());
  cost.transfer = transfers[1];
  cost.fit = fits[1];
  return cost;
}

void measure(const std::string& profile, const bench::LearningSet& target,
             const bench::LearningSet& source) {
  const Clock clock = cpu_clock();
  Fleet fleet(source, target.robot), rest(source, target.robot);
  const auto begin = source.solved.begin();
  DistributionKey key{.task = source.solved.front().task,
                      .robot = fleet.target(),
                      .T_task_base = target.solved.front().T_task_base,
                      .profile = profile_from_text(profile).value_or_throw()};
  rest.report({begin + kAll, source.solved.end()});
  SourceTransfer held_out(rest.store(), rest.robots(), key,
                          *rest.robots().find(key.robot).value_or_throw());
  transfer_sources(held_out, key, rest.store().experience(key.task), kAll, {});
  const Eigen::MatrixXd others = held_out.pool().configurations();

  fleet.report({begin, begin + kFirst});
  FitContext context{.store = fleet.store(), .robots = fleet.robots(), .clock = clock};
  const FitOutcome first = fit_distribution(key, context, {});
  const double stale = score_of(*first.distribution, others);
  first.remains->revision = first.remains->full.revision = 1;
  fleet.report({begin + kFirst, begin + kAll});
  const Cost cold = cost_of(key, context, others);
  context.before = first.remains;
  const Cost warm = cost_of(key, context, others);
  const FitOrigin origin = fit_distribution(key, context, {}).distribution->fit.value();
  std::printf(
      "%-9s from %-9s %6lu configurations | transfer cold %.3f warm %.3f | fit cold %.3f "
      "warm %.3f | warm / cold: fit %.2f all %.2f | score cold %.3f warm %.3f before %.3f | "
      "%s | %s\n",
      target.robot.label.c_str(), source.robot.label.c_str(),
      static_cast<unsigned long>(first.distribution->configurations), cold.transfer, warm.transfer,
      cold.fit, warm.fit, warm.fit / cold.fit,
      (warm.transfer + warm.fit) / (cold.transfer + cold.fit), cold.score, warm.score, stale,
      profile.c_str(), in_words(origin).c_str());
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) {
    std::fprintf(stderr, "refit_bench LEARNING_FOLDER [PROFILE...]\n");
    return 2;
  }
  const std::vector<std::string> profiles =
      argc > 2 ? std::vector<std::string>(argv + 2, argv + argc)
               : std::vector<std::string>{"default,pose_spacing=0.05,max_poses_per_path=0",
                                          "default,pose_spacing=0.05,max_poses_per_path=0,"
                                          "components=auto"};
  std::vector<bench::LearningSet> sets;
  for (const std::string& robot : bench::cobots())
    sets.push_back(bench::read_learning_set(argv[1], robot));
  for (const std::string& profile : profiles)
    for (std::size_t i = 0; i < sets.size(); ++i)
      measure(profile, sets[i], sets[(i + 1) % sets.size()]);
  return 0;
}
