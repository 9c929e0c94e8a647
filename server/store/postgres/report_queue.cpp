#include "server/store/postgres/report_queue.hpp"

#include <chrono>
#include <utility>

namespace kinship::store::postgres {

namespace {

template <typename Reported>
void take(const Uuid& uuid, Reported reported, PutOffReports& put_off, QueuedItem& item) {
  const auto answer = [&](ReceiptStatus status, const std::string& why) {
    item.prepared.emplace_back(std::nullopt);
    item.receipts.push_back({uuid, status, why});
  };
  if (const std::optional<std::string> why = put_off.find(uuid))
    return answer(ReceiptStatus::TryAgain, *why);
  Result<PreparedAttempt> prepared = prepare(std::move(reported));
  if (!prepared)
    return answer(ReceiptStatus::Refused, prepared.error().message);
  item.bytes += sizeof(PreparedAttempt) + (prepared->path ? prepared->path->blob.bytes.size() : 0) +
                (prepared->scene ? prepared->scene->blob.bytes.size() : 0);
  item.prepared.emplace_back(std::move(prepared).value());
  item.receipts.push_back({uuid, ReceiptStatus::TryAgain, ""});
}

}  // namespace

QueuedItem prepare_item(std::vector<Attempt> attempts, Store::ReportsDone done,
                        PutOffReports& put_off) {
  QueuedItem item;
  item.done = std::move(done);
  for (Attempt& attempt : attempts) {
    const Uuid uuid = attempt.report_uuid;
    take(uuid, std::move(attempt), put_off, item);
  }
  return item;
}

QueuedItem prepare_item(std::vector<ReplicatedReport> reports, Store::ReportsDone done,
                        PutOffReports& put_off) {
  QueuedItem item;
  item.done = std::move(done);
  for (ReplicatedReport& report : reports) {
    const Uuid uuid = report.attempt.report_uuid;
    take(uuid, std::move(report), put_off, item);
  }
  return item;
}

QueuedItem declined_item(const std::vector<Uuid>& reports, Store::ReportsDone done,
                         const std::string& why) {
  QueuedItem item;
  item.done = std::move(done);
  for (const Uuid& report : reports) {
    item.prepared.emplace_back(std::nullopt);
    item.receipts.push_back({report, ReceiptStatus::TryAgain, why});
  }
  return item;
}

void ReportQueue::push(QueuedItem item) {
  const std::lock_guard lock(mutex_);
  weight_ += item.weight();
  bytes_ += item.bytes;
  items_.push_back(std::move(item));
  changed_.notify_one();
}

std::optional<std::vector<QueuedItem>> ReportQueue::take() {
  constexpr std::size_t kBatchCap = 256;  // weight of one transaction, unless one item exceeds it
  std::unique_lock lock(mutex_);
  changed_.wait_for(lock, std::chrono::seconds(1),
                    [this] { return is_closed_ || !items_.empty(); });
  if (is_closed_ && items_.empty())
    return std::nullopt;
  std::vector<QueuedItem> batch;
  std::size_t weight = 0;
  while (!items_.empty() && (batch.empty() || weight + items_.front().weight() <= kBatchCap)) {
    weight += items_.front().weight();
    weight_ -= items_.front().weight();
    bytes_ -= items_.front().bytes;
    batch.push_back(std::move(items_.front()));
    items_.pop_front();
  }
  return batch;
}

void ReportQueue::close() {
  const std::lock_guard lock(mutex_);
  is_closed_ = true;
  changed_.notify_all();
}

std::size_t ReportQueue::weight() const {
  const std::lock_guard lock(mutex_);
  return weight_;
}

std::size_t ReportQueue::bytes() const {
  const std::lock_guard lock(mutex_);
  return bytes_;
}

}  // namespace kinship::store::postgres
