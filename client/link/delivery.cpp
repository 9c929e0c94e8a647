#include "client/link/delivery.hpp"

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "proto/types/limits.hpp"

namespace kinship::link {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Send = std::function<Result<ReportReply>(const ReportRequest&, Clock::time_point)>;
using Receipts = std::map<Uuid, Receipt>;

constexpr std::chrono::milliseconds kPause = 200ms;  // after "try again"

/// Takes those attempts out of the batch whose receipts are final.
/// \return what is wrong if there was no reply.
std::optional<Error> send_once(ReportRequest& batch, Clock::time_point deadline, const Send& send,
                               Receipts& receipts) {
  const Result<ReportReply> reply = send(batch, deadline);
  if (!reply)
    return reply.error();
  for (const Receipt& receipt : reply->receipts)
    receipts.insert_or_assign(receipt.report_uuid, receipt);
  std::erase_if(batch.attempts, [&](const Attempt& attempt) {
    const auto found = receipts.find(attempt.report_uuid);
    return found != receipts.end() && found->second.status != ReceiptStatus::TryAgain;
  });
  return std::nullopt;
}

/// \return what is wrong if there was no reply at all.
std::optional<Error> hand_over(ReportRequest batch, std::chrono::milliseconds timeout,
                               const Send& send, Receipts& receipts) {
  const Clock::time_point deadline = Clock::now() + timeout;
  if (batch.attempts.empty())
    return std::nullopt;
  if (const auto error = send_once(batch, deadline, send, receipts))
    return error;
  while (!batch.attempts.empty() && Clock::now() + kPause < deadline) {
    std::this_thread::sleep_for(kPause);
    if (send_once(batch, deadline, send, receipts))
      break;  // what the server said before stands
  }
  return std::nullopt;
}

/// Attempts on their way into a batch, and the receipts of those before.
class Delivery {
 public:
  Delivery(std::chrono::milliseconds timeout, const Send& send) : timeout_(timeout), send_(send) {}

  /// \return what is wrong if a batch had no reply.
  std::optional<Error> add(Attempt attempt) {
    if (const auto error = find_fault(attempt)) {
      receipts_.push_back({attempt.report_uuid, ReceiptStatus::Refused, error->message});
      return std::nullopt;
    }
    const BatchBytes bytes = bytes_ + batch_bytes(attempt);
    const bool is_full = batch_.attempts.size() == kMaxAttemptsPerBatch || !bytes.fits() ||
                         waiting_.contains(attempt.report_uuid);  // receipts are found by UUID
    bytes_ = bytes;
    if (is_full) {
      if (const auto error = send_batch())
        return error;
      bytes_ = batch_bytes(attempt);
    }
    waiting_.emplace(attempt.report_uuid, receipts_.size());
    receipts_.push_back({attempt.report_uuid, ReceiptStatus::TryAgain, "no receipt in time"});
    batch_.attempts.push_back(std::move(attempt));
    return std::nullopt;
  }

  std::optional<Error> send_batch() {
    Receipts receipts;
    const auto error = hand_over(std::exchange(batch_, {}), timeout_, send_, receipts);
    for (const auto& [uuid, place] : std::exchange(waiting_, {}))
      if (const auto found = receipts.find(uuid); found != receipts.end())
        receipts_[place] = found->second;
    bytes_ = {};
    return error;
  }

  std::vector<Receipt> take_receipts() { return std::move(receipts_); }

 private:
  const std::chrono::milliseconds timeout_;
  const Send& send_;
  ReportRequest batch_;
  BatchBytes bytes_;
  std::map<Uuid, std::size_t> waiting_;  // place of a receipt of the batch
  std::vector<Receipt> receipts_;
};

}  // namespace

Result<std::vector<Receipt>> deliver(std::vector<Attempt> attempts,
                                     std::chrono::milliseconds timeout, const Send& send) {
  Delivery delivery(timeout, send);
  for (Attempt& attempt : attempts)
    if (const auto error = delivery.add(std::move(attempt)))
      return *error;
  if (const auto error = delivery.send_batch())
    return *error;
  return delivery.take_receipts();
}

}  // namespace kinship::link
