#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/publications.hpp"
#include "proto/types/summaries.hpp"
#include "server/catalog/catalog.hpp"
#include "server/catalog/experience_index.hpp"
#include "server/quotas/client_quotas.hpp"
#include "server/runtime/clock.hpp"
#include "server/service/backup_job.hpp"
#include "server/service/jobs.hpp"
#include "server/store/store.hpp"

namespace kinship::service {

/// The memory above a site.
struct UpstreamOptions {
  std::function<std::unique_ptr<store::Store>()> open;  ///< empty: there is none
  std::string name;                                     ///< for people, without passwords
  std::vector<std::string> tasks;  ///< patterns of tasks whose experience always comes down
};

struct ServiceOptions {
  std::string version;
  /// When the server's certificate ends, Unix time; 0: it has none.
  std::int64_t credentials_expire_ms = 0;
  std::size_t fit_threads = 1;
  std::size_t fit_memory_bytes = std::size_t{2048} << 20U;  ///< of all fits together, at most
  std::size_t fit_queue = 256;           ///< fits that wait; more are answered Busy
  int fit_niceness = 10;                 ///< so that planners on the same machine come first
  double rehearsal_fraction = 0.1;       ///< see RehearsalSchedulerOptions::processor_fraction
  std::size_t short_task_queue = 1024;   ///< short jobs that wait: registering, listing, looking up
  std::size_t client_short_tasks = 128;  ///< of one client that wait
  std::chrono::milliseconds store_patience{2000};  ///< see StoreStatusReader
  std::size_t max_queued_attempts = 4096;
  std::size_t client_attempts = 1024;  ///< of one client, taken in and not yet answered
  quotas::ClientRates client_rates;    ///< quotas of one client over time
  std::size_t max_robots = 1024;       ///< parsed and in memory; others are read when needed
  std::uint64_t max_mesh_bytes = std::uint64_t{256} << 20U;  ///< of robots' meshes; 0: none
  /// Of replies, leases, waiting fetches and fits, in all and of one client.
  catalog::CatalogState::Limits catalog;
  catalog::ExperienceIndex::Limits experience;
  BackupPlace backups;
  UpstreamOptions upstream;
  runtime::Clock clock;
  catalog::Catalog::Fit fit;  ///< empty: fit_distribution
  Jobs::Limits jobs;
  /// Events for people who watch; at most 1000 a second (event_feed.hpp). Called from any thread,
  /// must not block. Empty: no events.
  std::function<void(const Event&)> on_event;
  /// A followed distribution has a newer revision. Called on a worker.
  std::function<void(const Announcement&)> on_announcement = [](const Announcement&) {};
  /// The last client has stopped following a distribution. Called from any thread.
  std::function<void(const Digest& id)> on_unfollowed = [](const Digest&) {};
  /// next_deadline() is earlier than it was. Called from any thread.
  std::function<void()> wake = [] {};
  /// Of the status (ServerStatus::challenge), for requests that show the server's token.
  std::function<std::string()> challenge = [] { return std::string(); };
  /// Rows of the status about the network, which the service does not know.
  std::function<std::vector<TroubleCount>()> network_troubles = [] {
    return std::vector<TroubleCount>();
  };
  std::function<std::vector<BoundUse>()> network_bounds = [] { return std::vector<BoundUse>(); };
  /// A line for people, without a line feed. Called from any thread, must not block for long.
  std::function<void(std::string_view)> log = [](std::string_view) {};
};

}  // namespace kinship::service
