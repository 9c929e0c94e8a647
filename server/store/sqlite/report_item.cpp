#include "server/store/sqlite/report_item.hpp"

#include <utility>

#include "server/store/sqlite/database/sqlite_error.hpp"
#include "server/store/sqlite/database/transaction.hpp"
#include "server/store/sqlite/rows/report_writing.hpp"

namespace kinship::store {
namespace {

std::string describe(const Uuid& report_uuid, const std::string& what) {
  return "report " + report_uuid.text() + " cannot be stored, the store is damaged there: " + what +
         "; 'kinship status' tells what to do";
}

/// \param is_only_one  nothing else is written by its item.
Receipt insert_alone(Batch& batch, const PreparedAttempt& prepared, PutOffReports& put_off,
                     std::uint64_t max_paths, bool is_only_one) {
  const Uuid& uuid = prepared.attempt.report_uuid;
  if (const std::optional<std::string> why = put_off.find(uuid))
    return {uuid, ReceiptStatus::TryAgain, *why};  // in a second try of its batch
  if (batch.is_undone_whole() && is_only_one)
    return write_report(batch, prepared, max_paths);
  Savepoint savepoint(batch.database());
  try {
    Receipt receipt = write_report(batch, prepared, max_paths);
    savepoint.keep();
    return receipt;
  } catch (const SqliteError& error) {
    if (!error.is_damage() && !error.concerns_one_row())
      throw;
    const std::string why = error.is_damage() ? describe(uuid, error.what()) : error.what();
    put_off.note(uuid, why);
    // A trigger may have undone the whole transaction, damage often does.
    if ((error.is_damage() && !error.is_of_row()) || !batch.database().in_transaction())
      throw;
    return {uuid, ReceiptStatus::TryAgain, why};
  }
}

}  // namespace

ReportItem::ReportItem(History& history, PutOffReports& put_off, std::vector<Attempt> attempts,
                       Store::ReportsDone done, std::uint64_t max_paths)
    : history_(history), put_off_(put_off), max_paths_(max_paths), done_(std::move(done)) {
  for (Attempt& attempt : attempts) {
    const Uuid uuid = attempt.report_uuid;
    take(uuid, std::move(attempt));
  }
}

ReportItem::ReportItem(History& history, PutOffReports& put_off,
                       std::vector<ReplicatedReport> reports, Store::ReportsDone done,
                       std::uint64_t max_paths)
    : history_(history), put_off_(put_off), max_paths_(max_paths), done_(std::move(done)) {
  for (ReplicatedReport& report : reports) {
    const Uuid uuid = report.attempt.report_uuid;
    take(uuid, std::move(report));
  }
}

template <typename Reported>
void ReportItem::take(const Uuid& report_uuid, Reported reported) {
  if (const std::optional<std::string> why = put_off_.find(report_uuid)) {
    prepared_.emplace_back(std::nullopt);
    receipts_.push_back({report_uuid, ReceiptStatus::TryAgain, *why});
    return;
  }
  Result<PreparedAttempt> prepared = prepare(std::move(reported));
  if (!prepared) {
    prepared_.emplace_back(std::nullopt);
    receipts_.push_back({report_uuid, ReceiptStatus::Refused, prepared.error().message});
    return;
  }
  bytes_ += sizeof(PreparedAttempt) + (prepared->path ? prepared->path->blob.bytes.size() : 0) +
            (prepared->scene ? prepared->scene->blob.bytes.size() : 0);
  prepared_.emplace_back(std::move(prepared).value());
  receipts_.push_back({report_uuid, ReceiptStatus::TryAgain, ""});
}

std::unique_ptr<ReportItem> ReportItem::declined(History& history, PutOffReports& put_off,
                                                 const std::vector<Uuid>& reports,
                                                 Store::ReportsDone done, const std::string& why) {
  auto item =
      std::make_unique<ReportItem>(history, put_off, std::vector<Attempt>(), std::move(done));
  for (const Uuid& report : reports) {
    item->prepared_.emplace_back(std::nullopt);
    item->receipts_.push_back({report, ReceiptStatus::TryAgain, why});
  }
  return item;
}

void ReportItem::apply(Batch& batch) {
  for (std::size_t i = 0; i < prepared_.size(); ++i)
    if (prepared_[i])
      receipts_[i] =
          insert_alone(batch, *prepared_[i], put_off_, max_paths_, prepared_.size() == 1);
  history_.write_run(batch.database());
  position_ = position_of(batch.database());
}

void ReportItem::finish(const Error* error) {
  if (error != nullptr)
    for (std::size_t i = 0; i < prepared_.size(); ++i)
      if (prepared_[i])
        receipts_[i] = {receipts_[i].report_uuid, ReceiptStatus::TryAgain, error->message};
  if (error == nullptr)
    history_.committed(position_);
  done_(receipts_);
}

}  // namespace kinship::store
