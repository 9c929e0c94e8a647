#pragma once

#include <atomic>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "server/catalog/advice_cache.hpp"
#include "server/quotas/quota.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/runtime/worker_pool.hpp"
#include "server/store/report_store.hpp"

namespace kinship::service {

/// Takes in reports: checks each attempt against its robot, passes valid ones to the store, and
/// answers a batch once, in its order, when every attempt has its receipt. May be shared between
/// threads.
class Ingest {
 public:
  struct Options {
    std::size_t max_attempts = 4096;  ///< taken in and not yet answered; more get TryAgain
    std::size_t max_bytes = std::size_t{64} << 20U;  ///< of their waypoints and scenes
    // Of one client, 0: no limit.
    std::size_t client_attempts = 1024;
    std::size_t client_bytes = std::size_t{16} << 20U;
    /// Called when a client was refused because its own limit is reached.
    std::function<void(const std::string& client, const std::string& message)> on_over_quota =
        [](const std::string&, const std::string&) {};
    /// Whether the store is known to have a task, without asking it.
    std::function<bool(const std::string& task)> is_known_task = [](const std::string&) {
      return true;
    };
    /// Whether a client may report attempts of a task for which is_known_task is false; may ask the
    /// store.
    std::function<std::optional<quotas::Refusal>(const std::string& client,
                                                 const std::string& task)>
        may_begin_task = [](const std::string&, const std::string&) { return std::nullopt; };
    /// Called on the store's writer thread for each stored attempt of a client, with the bytes of
    /// its path if the path was stored.
    std::function<void(const std::string& client, const std::string& task, std::size_t bytes)>
        on_kept = [](const std::string&, const std::string&, std::size_t) {};
    /// Called on the store's writer thread for each task that has a new path, before the reply.
    std::function<void(std::string_view task)> on_new_experience = [](std::string_view) {};
    /// Called before each reply, on its thread, with the costs and receipts of a batch's attempts.
    /// Must not throw or block.
    std::function<void(std::span<const catalog::AttemptCost>, std::span<const Receipt>)> on_answer =
        [](std::span<const catalog::AttemptCost>, std::span<const Receipt>) {};
  };

  /// \param store, robots, short_task_pool  outlive the ingest, which drains on destruction;
  /// `short_task_pool` reads robots that are not in memory.
  Ingest(store::ReportStore& store, runtime::RobotRegistry& robots,
         runtime::WorkerPool& short_task_pool, Options options);
  ~Ingest() { drain(); }
  Ingest(const Ingest&) = delete;
  Ingest& operator=(const Ingest&) = delete;

  /// \param retry_after  when to send TryAgain attempts again; 0: the client decides.
  using Done = std::function<void(const std::vector<Receipt>&, RetryAfter retry_after)>;

  /// `done` is called once, on this thread, a worker of `short_task_pool` or the store's writer
  /// thread; it must not throw or block. TryAgain for all of them if too much waits already.
  /// \param client  that reports them; empty: no client, without a quota.
  void submit(std::vector<Attempt> attempts, Done done, const std::string& client = {});

  /// Answers every later batch TryAgain; returns when all earlier ones are answered.
  void drain();

  /// Attempts, since construction; counted again when a client resends them.
  std::uint64_t received() const noexcept { return received_; }
  std::uint64_t refused() const noexcept { return refused_; }
  std::size_t queued() const;  ///< attempts taken in and not yet answered
  std::map<std::string, std::size_t> queued_of_clients() const;  ///< without clients that have none

 private:
  struct Batch;
  using BatchPointer = std::shared_ptr<Batch>;

  /// Attempts and bytes taken in and not yet answered.
  struct Load {
    std::size_t attempts = 0, bytes = 0;
  };

  /// \return the reason of a refusal; empty: it was taken in.
  std::string take_in(Batch& batch);
  void let_go_of_client(Batch& batch);
  void let_go(Batch& batch);
  void check_and_commit(const BatchPointer& batch);
  void check(Batch& batch);
  void commit(const BatchPointer& batch);
  void committed(Batch& batch, const std::vector<Receipt>& receipts);
  void answer(Batch& batch);
  void answer_try_again(Batch& batch, std::string_view message);
  bool is_in_memory(const Attempt& attempt, const std::string& client) const;
  std::optional<quotas::Refusal> begins_too_many(const Batch& batch, const Attempt& attempt) const;

  store::ReportStore& store_;
  runtime::RobotRegistry& robots_;
  runtime::WorkerPool& short_task_pool_;
  const Options options_;
  std::atomic<std::uint64_t> received_{0}, refused_{0};

  mutable std::mutex mutex_;  // guards what follows
  std::condition_variable answered_;
  Load load_;
  std::map<std::string, Load> clients_;  // with attempts that are not yet answered
  bool draining_ = false;
};

}  // namespace kinship::service
