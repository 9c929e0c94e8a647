#pragma once

#include <atomic>
#include <chrono>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <string_view>
#include <vector>

#include "server/runtime/clock.hpp"
#include "server/sites/backoff.hpp"
#include "server/sites/carry.hpp"
#include "server/sites/carry_geometry.hpp"
#include "server/sites/positions.hpp"
#include "server/store/store.hpp"

namespace kinship::sites {

/// Hooks of the site's own server for data that comes down, and the tasks it wants.
struct SiteHooks {
  /// Commits reports that came down; empty: directly into the store.
  std::function<void(std::vector<store::ReplicatedReport>, store::Store::ReportsDone)> commit = {};
  /// The fault of an attempt that came down.
  std::function<std::optional<Error>(const Attempt&)> check = {};
  std::function<void(const Retirement&)> on_retired = [](const Retirement&) {};
  TakeGeometry take_geometry = {};  ///< empty: a registry of its own
  /// Tasks that robots of the site use now.
  std::function<std::set<std::string>()> tasks_in_use = [] { return std::set<std::string>(); };
};

struct ExchangeOptions {
  runtime::Clock clock;
  Piece up;
  /// Smaller: robots of the site wait for each commit.
  Piece down = {.reports = 256, .commit = 32, .bytes = std::size_t{1} << 20U, .retirements = 64};
  std::vector<std::string> task_patterns;      ///< of tasks whose experience always comes down
  std::chrono::milliseconds look_every{5000};  ///< polling interval of a stream that had no news
  /// Shortest interval between saves of the positions: each is a write to the site's store, for
  /// which reporting robots wait.
  std::chrono::milliseconds save_every{1000};
  /// Refused reports are tried again after this long, twice as long each time they all are refused
  /// again, up to the longest: whatever was in the way may be gone.
  std::chrono::milliseconds first_refused_retry{10'000};
  std::chrono::milliseconds longest_refused_retry{std::chrono::minutes(10)};
  /// A task's experience comes down until this long after its last use here.
  std::chrono::hours task_use{std::chrono::days(30)};
  /// Called between two transactions of a step, with the load on this machine since the last call.
  std::function<void(std::chrono::nanoseconds load, const std::stop_token&)> rest =
      [](std::chrono::nanoseconds, const std::stop_token&) {};
  /// Lines for people: restarts and refusals.
  std::function<void(std::string_view)> log = [](std::string_view) {};
};

/// Since the server started.
struct ExchangeCounts {
  std::uint64_t sent = 0;           ///< reports new to the memory
  std::uint64_t received = 0;       ///< reports new here
  std::uint64_t retired_above = 0;  ///< retirements sent
  std::uint64_t retired_here = 0;   ///< paths
  std::uint64_t left_out = 0;       ///< reports that their store could not read whole
  std::uint64_t passed_by = 0;      ///< refused reports beyond Positions::kMaxRefused: never again
};

/// Exchanges reports between a site and the memory above it while they are connected: in pieces,
/// the site's reports up and those of each wanted task down. Used by one thread.
class Exchange {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// Begins again from the start if either side has lost data since the last exchange.
  /// \param positions, counts  outlive it, as the stores do.
  Exchange(store::Store& site, store::Store& memory, Positions& positions, ExchangeCounts& counts,
           SiteHooks hooks, ExchangeOptions options);

  struct Step {
    bool has_worked = false;
    std::chrono::nanoseconds load{0};  ///< on this machine since the last rest
    TimePoint next;                    ///< when the next step is due
  };
  /// Carries one piece of the next stream in turn. \throws Failure of either store.
  Step step(const std::stop_token& stop = {});

  /// Saves the positions, before the connection is closed. Data behind unsaved positions is carried
  /// again.
  /// \throws Failure(Storage)
  void save_positions();

  /// Call when the site has new reports.
  void look_up_now() { up_due_ = {}; }
  /// Call when new tasks are in use.
  void look_for_tasks_now() { tasks_due_ = {}; }

 private:
  void begin();
  void try_refused_again(const std::stop_token& stop);
  void want_tasks();
  bool carry_up(const std::stop_token& stop);
  bool carry_down(const std::string& task, const std::stop_token& stop);
  std::uint64_t take(const CarriedReports& carried, bool is_up);
  std::chrono::nanoseconds take_load();
  void rest_before_write(const std::stop_token& stop);
  void save_if_due();
  TakeGeometry take_with_registry(store::RobotStore& store) const;
  std::optional<Error> bring_robot(store::RobotStore& from, store::RobotStore& to,
                                   const Digest& robot);
  Way way_up(const std::stop_token& stop);
  Way way_down(const std::stop_token& stop);
  void commit_here(std::vector<store::ReplicatedReport> reports, store::Store::ReportsDone done);
  std::vector<Retirement> retire_here(std::span<const Uuid> reports);
  TimePoint look_again() const { return options_.clock.now() + options_.look_every; }

  store::Store& site_;
  store::Store& memory_;
  Positions& positions_;
  ExchangeCounts& counts_;
  const SiteHooks hooks_;
  const ExchangeOptions options_;
  TimePoint up_due_{}, tasks_due_{};
  TimePoint save_due_{};
  std::map<std::string, TimePoint> down_due_;  // by task
  std::set<Digest> robots_of_both_;
  GeometryExchange geometry_;
  std::string last_;  // task of the last turn
  bool is_ups_turn_ = true;
  Backoff refused_backoff_;
  TimePoint refused_due_{};                       // at once with a connection
  bool has_written_ = false;                      // in this step
  std::chrono::nanoseconds processor_before_{0};  // when it last rested
  /// Time of commits here since then. Shared with their callbacks, which may come after the
  /// exchange.
  std::shared_ptr<std::atomic<std::int64_t>> commits_ns_ =
      std::make_shared<std::atomic<std::int64_t>>(0);
};

}  // namespace kinship::sites
