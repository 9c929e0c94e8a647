#include "server/app/serve.hpp"

#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <optional>
#include <ostream>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/codec/conversation.hpp"
#include "proto/dds/log.hpp"
#include "proto/dds/packet_guard.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/publication.hpp"
#include "proto/dds/wait_loop.hpp"
#include "proto/security/admin_token.hpp"
#include "proto/types/names.hpp"
#include "server/access/access.hpp"
#include "server/app/console_server.hpp"
#include "server/app/endpoints.hpp"
#include "server/app/expiry_watch.hpp"
#include "server/app/heap_trim.hpp"
#include "server/app/join.hpp"
#include "server/app/line_limit.hpp"
#include "server/app/metrics_page.hpp"
#include "server/app/revocation_watch.hpp"
#include "server/app/service_manager.hpp"
#include "server/app/signal_watcher.hpp"
#include "server/http/listener.hpp"
#include "server/ros2/node.hpp"
#include "server/runtime/memory_reserve.hpp"
#include "server/service/service.hpp"
#include "server/store/open_store.hpp"

namespace kinship::app {
namespace {

using WaitClock = dds::WaitLoop::Clock;

void start_log(const std::string& level) {
  const auto logger = std::make_shared<spdlog::logger>(
      "kinshipd", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  logger->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  logger->set_level(spdlog::level::from_str(level));
  spdlog::set_default_logger(logger);
  dds::set_log_sink([](std::string_view line) { spdlog::warn("dds: {}", line); });
}

void set_quotas(const ClientQuotaOptions& client, service::ServiceOptions& service) {
  constexpr double kBytesOfMegabyte = 1e6;
  service.client_rates.attempts_per_s = client.attempts_per_s;
  service.client_rates.bytes_per_s = kBytesOfMegabyte * client.mb_per_s;
  service.client_rates.robots_per_day = client.robots_per_day;
  service.client_rates.tasks_per_day = client.tasks_per_day;
  service.client_rates.stored_bytes_per_day = kBytesOfMegabyte * client.stored_mb_per_day;
  service.client_short_tasks = client.waiting;
  service.catalog.client_waiters = client.waiting;
  service.catalog.client_leases = client.leases;
  service.catalog.client_fits = client.fits;
}

service::ServiceOptions service_options(const ServerOptions& options) {
  service::ServiceOptions service;
  service.version = KINSHIP_VERSION;
  service.fit_threads = options.workers;
  service.backups.folder = options.backup_folder;
  service.fit_memory_bytes = options.fit_memory_mb << 20U;
  service.max_mesh_bytes = options.stored_meshes_mb << 20U;
  service.fit_niceness = options.fit_niceness;
  service.rehearsal_fraction = options.rehearsal_fraction;
  service.catalog.memory.bytes = options.distribution_memory_mb << 20U;
  service.experience.paths.bytes = options.path_memory_mb << 20U;
  set_quotas(options.client, service);
  return service;
}

store::StoreOptions store_options(const ServerOptions& options) {
  constexpr double kBytesOfMb = 1e6;
  constexpr std::uint64_t kMega = std::uint64_t{1} << 20U;
  store::StoreOptions store;
  store.sqlite.free_space_watermark_bytes = options.free_space_watermark_mb * kMega;
  store.sqlite.ballast_bytes = options.ballast_mb * kMega;
  store.sqlite.new_store = options.new_store;
  store.sqlite.max_wal_bytes = options.max_wal_mb * kMega;
  store.sqlite.max_paths_per_pair = options.max_paths_per_pair;
  store.sqlite.max_distribution_bytes = options.stored_distributions_mb * kMega;
  store.sqlite.searches = {.bytes = options.search_records_mb * kMega,
                           .days = options.search_record_days};
  store.postgres.searches = store.sqlite.searches;
  store.sqlite.scrub_bytes_per_s = static_cast<std::size_t>(kBytesOfMb * options.scrub_mb_per_s);
  store.sqlite.log = [](std::string_view line) { spdlog::warn("store: {}", line); };
  store.postgres.max_paths_per_pair = options.max_paths_per_pair;
  store.postgres.max_distribution_bytes = options.stored_distributions_mb * kMega;
  store.postgres.require_synchronous = options.require_synchronous;
  store.postgres.read_replicas = !options.primary_only;
  store.postgres.log = store.sqlite.log;
  return store;
}

void set_upstream(const ServerOptions& options, service::ServiceOptions& service) {
  if (options.upstream.empty())
    return;
  service.upstream.name = store::displayed_store(options.upstream);
  service.upstream.tasks = options.upstream_tasks;
  service.upstream.open = [url = options.upstream, settings = store_options(options)] {
    return store::open_store(url, settings);
  };
}

/// Before anything is opened.
void tell_insecurity(const ServerOptions& options) {
  // Whatever the log leaves out.
  if (const std::string insecurity = insecurity_of(options); !insecurity.empty())
    std::cerr << "kinshipd: --insecure: " << insecurity << std::endl;
}

using Events = dds::Publisher<codec::EventPublication>;
using Announcements = dds::Publisher<codec::AnnouncementPublication>;

/// Null without --ros2.
std::unique_ptr<ros2::Node> join_ros2(const ServerOptions& options) {
  if (!options.ros2)
    return nullptr;
  auto node = std::make_unique<ros2::Node>(
      ros2::NodeOptions{options.ros2_domain, options.network_interface, options.ros2_enclave});
  spdlog::info("ROS 2: serves domain {} (topics kinship/...){}", options.ros2_domain,
               options.ros2_enclave.empty() ? "" : " with security");
  return node;
}

/// The service's events and announcements go to these, which outlive it.
void publish_with(service::ServiceOptions& settings, const Events& events,
                  const Announcements& announcements, console::Broadcast& broadcast,
                  ros2::Node* node) {
  settings.on_event = [&events, &broadcast](const Event& event) {
    events.publish(event);
    broadcast.publish(event);
  };
  settings.on_announcement = [&announcements, node](const Announcement& announcement) {
    announcements.publish(announcement);
    if (node)
      node->announce(announcement);
  };
  settings.on_unfollowed = [&announcements](const Digest& id) { announcements.withdraw(id); };
}

/// Its robot is a digest, which says nothing to a client that does not know the robot.
bool may_hear_announcement(const Caller& caller, const Announcement& announcement) {
  return access::may_see(caller, announcement.task, "");
}

/// The records of the security folder; null without security.
std::shared_ptr<security::ClientDirectory> clients_of(const ServerOptions& options) {
  if (options.security.empty())
    return nullptr;
  return std::make_shared<security::ClientDirectory>(
      security::SecurityFolder(options.security).clients());
}

std::unique_ptr<RevocationWatch> watch_revocations(
    const ServerOptions& options, const std::shared_ptr<security::ClientDirectory>& clients,
    store::Store& store) {
  if (!clients)
    return nullptr;
  return std::make_unique<RevocationWatch>(
      security::SecurityFolder(options.security), *clients, store,
      [](std::string_view line) { spdlog::warn("security: {}", line); });
}

std::optional<http::Port> open_metrics_port(const ServerOptions& options) {
  if (options.metrics.empty())
    return std::nullopt;
  return http::Port(http::read_address(options.metrics).value_or_throw(), {"metrics", "--metrics"});
}

ExpiryWatch watch_expiry(const dds::Participant& participant) {
  return {participant.credentials(),
          [] { return std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()); },
          [](std::string_view warning) { spdlog::warn("security: {}", warning); }};
}

std::int64_t expiry_ms(const dds::Participant& participant) {
  const auto& credentials = participant.credentials();
  return credentials ? std::chrono::milliseconds(credentials->expires.time_since_epoch()).count()
                     : 0;
}

void tell_what_is_served(const ServerStatus& status, std::uint32_t domain,
                         const std::string& store) {
  spdlog::info("kinshipd {} serves domain {} from {}: {} robots, {} paths, {} distributions",
               status.version, domain, store, status.robots, status.paths, status.distributions);
  if (!status.storage_message.empty())
    spdlog::warn("store: {}", status.storage_message);
}

/// What the packet guard dropped, as troubles.
std::vector<TroubleCount> network_troubles() {
  std::vector<TroubleCount> rows;
  for (const dds::DroppedPackets& each : dds::dropped_packets())
    if (each.count > 0)
      rows.push_back({.what = std::string(each.reason),
                      .count = each.count,
                      .last = "dropped, the last one from " + each.last_source,
                      .last_ms = each.last_ms});
  return rows;
}

/// The status tells of the network, and of the token that changes need.
void set_network(service::ServiceOptions& settings, security::AdminTokenCheck* token) {
  settings.network_troubles = network_troubles;
  settings.network_bounds = [] {
    return std::vector<BoundUse>{{"participants", dds::known_peers(), dds::PeerTable::kMaxPeers}};
  };
  if (token != nullptr)
    settings.challenge = [token] { return token->challenge(std::chrono::steady_clock::now()); };
}

/// Null where changes need no token.
std::unique_ptr<security::AdminTokenCheck> check_of_token(const ServerOptions& options) {
  const std::filesystem::path file = token_file_of(options);
  if (file.empty())
    return nullptr;
  return std::make_unique<security::AdminTokenCheck>(security::make_admin_token(file),
                                                     std::chrono::steady_clock::now());
}

/// \param port  is taken. \return null without one.
std::unique_ptr<http::Listener> serve_metrics(std::optional<http::Port>& port,
                                              const ServerOptions& options,
                                              service::Service& service,
                                              const Endpoints& endpoints) {
  if (!port)
    return nullptr;
  spdlog::info("metrics at {}/metrics", port->url());
  return std::make_unique<http::Listener>(
      *std::move(port), metrics_handler([&service, &endpoints] {
        return metrics_page(service, endpoints.clients());
      }),
      http::Limits{.hosts = options.metrics_hosts, .host_option = "--metrics-host"});
}

/// Serves until the loop is stopped.
void run(dds::WaitLoop& loop, service::Service& service, ExpiryWatch& expiry) {
  Watchdog watchdog;
  HeapTrim heap;
  loop.run([&] {
    const auto now = WaitClock::now();
    service.expire(now);
    return std::min({watchdog.beat(now), expiry.beat(now), heap.beat(now, dds::known_peers()),
                     service.next_deadline().value_or(WaitClock::time_point::max())});
  });
}

}  // namespace

int serve(const ServerOptions& options, std::ostream& out) {
  start_log(options.log_level);
  runtime::keep_memory_reserve();
  std::signal(SIGPIPE, SIG_IGN);  // the output may have no reader
  tell_insecurity(options);
  hold_termination_signals();

  // Before the store: a server that cannot join the domain, or has no port, leaves no file behind.
  const std::shared_ptr<security::ClientDirectory> clients = clients_of(options);
  const dds::Participant participant = join_domain(options, clients);
  std::optional<http::Port> metrics_port = open_metrics_port(options);
  std::optional<http::Port> console_port = open_console_port(options);
  const std::unique_ptr<ros2::Node> node = join_ros2(options);
  console::Broadcast broadcast;
  dds::WaitLoop loop(participant);
  const Events events(participant, loop, access::may_hear);
  const Announcements announcements(participant, loop, may_hear_announcement);
  LineLimit log([](std::string_view line) { spdlog::info("{}", on_one_line(std::string(line))); },
                {});
  service::ServiceOptions settings = service_options(options);
  settings.credentials_expire_ms = expiry_ms(participant);
  settings.log = [&log](std::string_view line) { log.write(line); };
  set_upstream(options, settings);
  publish_with(settings, events, announcements, broadcast, node.get());
  settings.wake = [&loop] { loop.wake(); };
  std::unique_ptr<store::Store> opened =
      store::open_store(options.store.string(), store_options(options));
  store::Store& store = *opened;
  const std::unique_ptr<security::AdminTokenCheck> token = check_of_token(options);
  set_network(settings, token.get());
  service::Service service(std::move(opened), std::move(settings));
  const auto revocations = watch_revocations(options, clients, store);
  const Endpoints endpoints(participant, loop, service, token.get());
  const SignalWatcher signals([&loop](int signal) {
    spdlog::info("signal {}: draining", signal);
    loop.stop();
  });

  const std::string store_name = store::displayed_store(options.store.string());
  tell_what_is_served(service.status(), options.domain, store_name);
  ExpiryWatch expiry = watch_expiry(participant);
  expiry.beat(WaitClock::now());
  auto metrics = serve_metrics(metrics_port, options, service, endpoints);
  std::optional<ConsoleServer> console;
  if (console_port)
    console.emplace(std::move(*console_port), options, service, broadcast);
  std::optional<ros2::Node::Serving> nodes;
  if (node)
    nodes.emplace(*node, service);
  out << "ready domain=" << options.domain << " store=" << store_name << std::endl;
  notify_service_manager("READY=1");
  run(loop, service, expiry);
  notify_service_manager("STOPPING=1");
  metrics.reset();
  console.reset();
  nodes.reset();
  service.shutdown();
  spdlog::info("ended");
  return kDone;
}

}  // namespace kinship::app
