#include "server/service/task_pools.hpp"

#include <algorithm>

namespace kinship::service {

using runtime::WorkerPool;

TaskPools::TaskPools(std::size_t queue_limit, std::size_t client_limit,
                     quotas::ClientQuotas& clients)
    : store({.threads = 1, .queue_limit = queue_limit, .client_limit = client_limit}),
      memory({.threads = 1, .queue_limit = queue_limit, .client_limit = client_limit}),
      status({.threads = 1, .queue_limit = queue_limit, .client_limit = client_limit}),
      client_limit_(client_limit),
      clients_(clients) {}

bool TaskPools::is_over_waiting(const std::string& client) {
  if (client.empty() || client_limit_ == 0 ||
      std::max({store.queued_of(client), memory.queued_of(client), status.queued_of(client)}) <
          client_limit_)
    return false;
  clients_.count_refusal(client, quotas::Quota::Waiting);
  return true;
}

std::string TaskPools::busy_message(const std::string& client) {
  return is_over_waiting(client) ? "busy: this client has as much waiting as one may have"
                                 : "the server is busy";
}

std::size_t TaskPools::queued() const { return store.queued() + memory.queued() + status.queued(); }

void TaskPools::stop() {
  for (WorkerPool* const pool : {&memory, &store, &status})
    pool->stop(WorkerPool::Leftovers::Abandon);
}

}  // namespace kinship::service
