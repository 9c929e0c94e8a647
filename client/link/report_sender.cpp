#include "client/link/report_sender.hpp"

#include <algorithm>
#include <set>
#include <utility>

#include "proto/codec/report_codec.hpp"
#include "proto/types/limits.hpp"

namespace kinship::link {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kRetry = 1s;      // after "try again" or without an answer
constexpr std::chrono::milliseconds kIdle = 2s;       // another process may have added reports
constexpr std::chrono::milliseconds kLockRetry = 1s;  // another process sends
constexpr std::chrono::milliseconds kStorageRetry = 5s;
constexpr std::chrono::milliseconds kPoll = 50ms;  // for what another process sends

bool is_final(ReceiptStatus status) { return status != ReceiptStatus::TryAgain; }

}  // namespace

ReportSender::ReportSender(Outbox& outbox, Send send)
    : outbox_(outbox), send_(std::move(send)), thread_([this] { run(); }) {}

ReportSender::~ReportSender() {
  {
    const std::lock_guard lock(mutex_);
    is_stopped_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void ReportSender::wake() {
  {
    const std::lock_guard lock(mutex_);
    is_woken_ = true;
  }
  changed_.notify_all();
}

ReportSender::Counts ReportSender::counts() const {
  const std::lock_guard lock(mutex_);
  return counts_;
}

bool ReportSender::is_stopped() const {
  const std::lock_guard lock(mutex_);
  return is_stopped_;
}

void ReportSender::wait_until_empty(std::chrono::steady_clock::time_point deadline) {
  while (outbox_.pending_count() > 0) {
    std::unique_lock lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (is_stopped_ || now >= deadline)
      return;
    changed_.wait_until(lock, std::min(deadline, now + kPoll));
  }
}

void ReportSender::run() {
  std::optional<SenderLock> lock;
  while (!is_stopped()) {
    {
      const std::lock_guard guard(mutex_);
      is_woken_ = false;
    }
    std::chrono::milliseconds pause = kStorageRetry;
    try {
      pause = work(lock);
    } catch (const Failure& failure) {  // of the disk: nothing is lost, it is tried again
      report_problem(failure.what());
    }
    changed_.notify_all();
    std::unique_lock guard(mutex_);
    changed_.wait_for(guard, pause, [&] { return is_stopped_ || (is_woken_ && pause == kIdle); });
  }
}

/// One round. \return how long to pause.
std::chrono::milliseconds ReportSender::work(std::optional<SenderLock>& lock) {
  if (!lock) {
    lock = SenderLock::try_acquire(outbox_.folder());
    if (!lock)
      return kLockRetry;
    outbox_.purge();
  }
  return send_all_pending() ? kIdle : kRetry;
}

/// \return false if something is left that should be tried again.
bool ReportSender::send_all_pending() {
  ReportRequest batch;
  std::size_t bytes = 0;
  const auto send_collected = [&] {
    const bool is_done = batch.attempts.empty() || send_batch(batch);
    batch.attempts.clear();
    bytes = 0;
    return is_done;
  };
  for (const Uuid& uuid : outbox_.pending()) {
    if (is_stopped())
      return false;
    Result<Attempt> attempt = outbox_.read(uuid);
    const auto error = attempt ? codec::check(*attempt) : attempt.error();
    if (error && error->code != ErrorCode::NotFound)
      apply({uuid, ReceiptStatus::Refused, error->message});
    if (error)
      continue;
    const std::size_t size = codec::batch_bytes(*attempt);
    if (batch.attempts.size() == kMaxAttemptsPerBatch || bytes + size > kMaxBatchBytes)
      if (!send_collected())
        return false;
    bytes += size;
    batch.attempts.push_back(std::move(attempt).value());
  }
  return send_collected();
}

/// \return false if an attempt of the batch should be tried again.
bool ReportSender::send_batch(const ReportRequest& batch) {
  const Result<ReportReply> reply = send_(batch);
  if (!reply) {
    report_problem(reply.error().message);
    return false;
  }
  std::set<Uuid> open;
  for (const Attempt& attempt : batch.attempts)
    open.insert(attempt.report_uuid);
  if (!reply->receipts.empty())
    outbox_.note_store_epoch(reply->store_epoch);
  std::string problem;
  for (const Receipt& receipt : reply->receipts) {
    if (!is_final(receipt.status))
      problem = receipt.message;
    else if (open.erase(receipt.report_uuid) == 1)
      apply(receipt);
  }
  if (!open.empty() && problem.empty())
    problem = "the server gave no receipt for " + std::to_string(open.size()) + " reports";
  report_problem(open.empty() ? "" : problem);
  return open.empty();
}

void ReportSender::apply(const Receipt& receipt) {
  const bool is_refused = receipt.status == ReceiptStatus::Refused;
  if (is_refused)
    outbox_.reject(receipt.report_uuid, receipt.message);
  else
    outbox_.mark_sent(receipt.report_uuid);
  const std::lock_guard lock(mutex_);
  ++(is_refused ? counts_.refused : counts_.accepted);
}

void ReportSender::report_problem(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  counts_.problem = problem;
}

}  // namespace kinship::link
