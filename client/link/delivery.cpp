#include "client/link/delivery.hpp"

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>

#include "proto/types/limits.hpp"

namespace kinship::link {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using Send = std::function<Result<ReportReply>(const ReportRequest&, Clock::time_point)>;
using Receipts = std::map<Uuid, Receipt>;

constexpr std::chrono::milliseconds kPause = 200ms;        // after "try again"
constexpr std::chrono::milliseconds kLongestWait = 10min;  // of one batch, as the server asks

/// Sends a batch, and again the attempts without a final receipt, until the timeout. Pauses that
/// the server asks for do not count.
/// \return the error if there was no reply at all.
std::optional<Error> hand_over(ReportRequest batch, std::chrono::milliseconds timeout,
                               InterruptibleSleep& sleep, const Send& send, Receipts& receipts) {
  Clock::time_point deadline = Clock::now() + timeout;
  const Clock::time_point last = deadline + kLongestWait;
  std::chrono::milliseconds asked{0};
  for (bool is_answered = false; !batch.attempts.empty(); is_answered = true) {
    if (is_answered) {
      deadline = std::min(deadline + asked, last);
      const auto pause = std::max(kPause, asked);
      if (Clock::now() + pause >= deadline)
        break;
      if (!sleep.sleep(pause))
        break;
    }
    const Result<ReportReply> reply = send(batch, deadline);
    if (!reply)  // earlier answers of the server stand
      return is_answered ? std::nullopt : std::optional(reply.error());
    asked = reply->retry_after;
    for (const Receipt& receipt : reply->receipts)
      receipts.insert_or_assign(receipt.report_uuid, receipt);
    std::erase_if(batch.attempts, [&](const Attempt& attempt) {
      const auto found = receipts.find(attempt.report_uuid);
      return found != receipts.end() && found->second.status != ReceiptStatus::TryAgain;
    });
  }
  return std::nullopt;
}

}  // namespace

Result<std::vector<Receipt>> deliver(std::vector<Attempt> attempts,
                                     std::chrono::milliseconds timeout, InterruptibleSleep& sleep,
                                     const Send& send) {
  std::vector<Receipt> receipts;
  for (const Attempt& attempt : attempts) {
    const auto error = validate(attempt);
    receipts.push_back(
        error ? Receipt{attempt.report_uuid, ReceiptStatus::Refused, error->message}
              : Receipt{attempt.report_uuid, ReceiptStatus::TryAgain, "no receipt in time"});
  }
  for (std::size_t next = 0; next < attempts.size();) {
    ReportRequest batch;
    BatchBytes bytes;
    std::map<Uuid, std::size_t> places;  // of its receipts, which are found by UUID
    for (; next < attempts.size(); ++next) {
      Attempt& attempt = attempts[next];
      if (receipts[next].status == ReceiptStatus::Refused)
        continue;
      bytes = bytes + batch_bytes(attempt);
      const bool is_full = batch.attempts.size() == kMaxAttemptsPerBatch || !bytes.fits();
      if ((is_full && !batch.attempts.empty()) || !places.emplace(attempt.report_uuid, next).second)
        break;
      batch.attempts.push_back(std::move(attempt));
    }
    Receipts answered;
    if (const auto error = hand_over(std::move(batch), timeout, sleep, send, answered))
      return *error;
    for (const auto& [uuid, place] : places)
      if (const auto found = answered.find(uuid); found != answered.end())
        receipts[place] = found->second;
  }
  return receipts;
}

}  // namespace kinship::link
