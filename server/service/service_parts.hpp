#pragma once

#include <string>

#include "server/quotas/client_quotas.hpp"
#include "server/runtime/error_counters.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/service/event_feed.hpp"
#include "server/service/measures.hpp"
#include "server/service/service_options.hpp"
#include "server/service/task_pools.hpp"

namespace kinship::service {

/// References that every service needs; the objects outlive the services.
struct ServiceParts {
  /// Logs an administrative event and tells it to people who watch.
  /// \param task  may be empty.
  void tell(const std::string& task, const std::string& what) const {
    options.log((task.empty() ? "" : "task '" + task + "': ") + what);
    events.tell(EventKind::Administration, task, {}, [&] { return what; });
  }

  const ServiceOptions& options;
  runtime::ErrorCounters& troubles;
  Measures& measures;
  EventFeed& events;
  quotas::ClientQuotas& clients;
  runtime::RobotRegistry& robots;
  TaskPools& pools;
};

}  // namespace kinship::service
