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
#include "server/sites/carry.hpp"
#include "server/sites/carry_geometry.hpp"
#include "server/sites/positions.hpp"
#include "server/store/store.hpp"

namespace kinship::sites {

/// What a site's own server does with what comes down, and what it wants.
struct SiteHooks {
  /// Commits what came down; empty: the store alone is told.
  std::function<void(std::vector<store::SharedReport>, store::Store::ReportsDone)> commit = {};
  /// What is wrong with an attempt that came down.
  std::function<std::optional<Error>(const Attempt&)> check = {};
  std::function<void(const Retirement&)> on_retired = [](const Retirement&) {};
  TakeGeometry take_geometry = {};  ///< empty: a registry that nobody else asks
  /// Tasks that robots here use just now.
  std::function<std::set<std::string>()> tasks_in_use = [] { return std::set<std::string>(); };
};

struct ExchangeOptions {
  runtime::Clock clock;
  Piece up;
  /// Smaller: robots of the site wait for each commit.
  Piece down = {.reports = 256, .commit = 32, .bytes = std::size_t{1} << 20U, .retirements = 64};
  std::vector<std::string> task_patterns;      ///< of tasks that are always brought down
  std::chrono::milliseconds look_every{5000};  ///< at a stream that had nothing
  /// How far it came is written no more often: each time is a write of the site's store, for which
  /// robots wait that report just then.
  std::chrono::milliseconds save_every{1000};
  /// A task that nobody here asked for is not brought down any more.
  std::chrono::hours task_use{std::chrono::days(30)};
  /// Called between two transactions of a step, with what was taken of this machine since the last
  /// time.
  std::function<void(std::chrono::nanoseconds load, const std::stop_token&)> rest =
      [](std::chrono::nanoseconds, const std::stop_token&) {};
  /// Lines for people: what begins again, what is refused.
  std::function<void(std::string_view)> log = [](std::string_view) {};
};

/// Since the server started.
struct ExchangeCounts {
  std::uint64_t sent = 0;           ///< reports that are new to the memory
  std::uint64_t received = 0;       ///< that are new here
  std::uint64_t retired_above = 0;  ///< retirements told
  std::uint64_t retired_here = 0;   ///< paths
  std::uint64_t left_out = 0;       ///< reports that could not be read whole where they are
};

/// What a site and the memory above it tell each other while they are connected: piece by piece,
/// the site's reports up, and down those of each wanted task. Used by one thread.
class Exchange {
 public:
  using TimePoint = std::chrono::steady_clock::time_point;

  /// Notices whether either side lost something since, and then begins again.
  /// \param positions, counts  outlive it, as the stores do.
  Exchange(store::Store& site, store::Store& memory, Positions& positions, ExchangeCounts& counts,
           SiteHooks hooks, ExchangeOptions options);

  struct Step {
    bool has_worked = false;
    std::chrono::nanoseconds load{0};  ///< that it was to this machine since it last rested
    TimePoint next;                    ///< when there is something to look at again
  };
  /// Carries one piece of the stream whose turn it is. \throws Failure of either store.
  Step step(const std::stop_token& stop = {});

  /// Writes how far it came: for who lets go of the connection. What is not written goes again.
  /// \throws Failure(Storage)
  void save_positions();

  /// There are new reports of the site.
  void look_up_now() { up_due_ = {}; }
  /// There are new tasks in use.
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
  TakeGeometry take_with_registry(store::Store& store) const;
  std::optional<Error> bring_robot(store::Store& from, store::Store& to, const Digest& robot);
  Way way_up(const std::stop_token& stop);
  Way way_down(const std::stop_token& stop);
  void commit_here(std::vector<store::SharedReport> reports, store::Store::ReportsDone done);
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
  std::string last_;  // task that had its turn
  bool is_ups_turn_ = true;
  bool has_tried_refused_ = false;
  bool has_written_ = false;                      // in this step
  std::chrono::nanoseconds processor_before_{0};  // when it last rested
  /// How long commits here took since. Shared with their callbacks, which may come after the
  /// exchange.
  std::shared_ptr<std::atomic<std::int64_t>> commits_ns_ =
      std::make_shared<std::atomic<std::int64_t>>(0);
};

}  // namespace kinship::sites
