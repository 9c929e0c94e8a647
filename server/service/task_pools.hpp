#pragma once

#include <cstddef>
#include <stop_token>
#include <string>

#include "proto/types/conversations.hpp"
#include "server/quotas/client_quotas.hpp"
#include "server/runtime/worker_pool.hpp"

namespace kinship::service {

/// Pools of one thread each for short tasks: a task waits for none that may take longer. May be
/// shared between threads.
class TaskPools {
 public:
  static constexpr RetryAfter kRetryAfter{1000};  ///< of requests for which there was no room

  /// \param queue_limit   tasks of a pool that wait.
  /// \param client_limit  of them, tasks of one client; 0: no limit.
  /// \param clients       counts refusals; outlives the pools.
  TaskPools(std::size_t queue_limit, std::size_t client_limit, quotas::ClientQuotas& clients);

  ~TaskPools() { stop(); }
  TaskPools(const TaskPools&) = delete;
  TaskPools& operator=(const TaskPools&) = delete;

  runtime::WorkerPool store;   ///< tasks that may ask the store
  runtime::WorkerPool memory;  ///< tasks that ask the store nothing
  runtime::WorkerPool status;  ///< reads the status of a store that may not answer

  /// Whether a client itself filled its place in a queue; then that is counted.
  bool is_over_waiting(const std::string& client);
  /// The reason of a refusal for want of room in a queue; counted as is_over_waiting().
  std::string busy_message(const std::string& client);
  std::size_t queued() const;  ///< tasks that wait, of all pools

  /// Marks the server as stopping; the pools go on until stop().
  void request_stop() { stop_source_.request_stop(); }
  bool is_stopping() const { return stop_source_.stop_requested(); }
  std::stop_token stop_token() const { return stop_source_.get_token(); }
  /// Abandons the tasks that wait and returns when the running ones have ended.
  void stop();

 private:
  const std::size_t client_limit_;
  quotas::ClientQuotas& clients_;
  std::stop_source stop_source_;
};

}  // namespace kinship::service
