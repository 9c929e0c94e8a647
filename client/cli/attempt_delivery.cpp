#include "client/cli/attempt_delivery.hpp"

#include <ostream>
#include <utility>

#include "client/cli/cell_text.hpp"
#include "proto/json/format.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::cli {
namespace {

constexpr std::size_t kHeldBytes = 8 * kMaxBatchBytes;  // before they are handed over

}  // namespace

AttemptDelivery::AttemptDelivery(link::Client& server, std::ostream& err, bool progress)
    : server_(server), err_(err), progress_(err, progress) {}

void AttemptDelivery::hold(const std::string& place, Attempt attempt) {
  const BatchBytes size = batch_bytes(attempt);
  bytes_ += size.waypoints + size.scenes + size.searches;
  attempts_.push_back(std::move(attempt));
  places_.push_back(place);
  if (attempts_.size() == kMaxAttemptsPerBatch || bytes_ > kHeldBytes)
    deliver();
}

void AttemptDelivery::refuse(const std::string& place, const std::string& why) {
  tell(place, why);
  ++counts_.refused;
}

void AttemptDelivery::tell(const std::string& place, const std::string& what) {
  progress_.clear();
  err_ << kImportPaths << ": " << on_one_line(place + ": " + what) << '\n';
}

void AttemptDelivery::deliver() {
  if (attempts_.empty() || end_)
    return;
  const Result<std::vector<Receipt>> receipts = server_.deliver(std::exchange(attempts_, {}));
  const std::vector<std::string> places = std::exchange(places_, {});
  bytes_ = 0;
  if (!receipts) {
    end_ = Error{receipts.error().code,
                 receipts.error().message + "; from " + places.front() +
                     " on something may be missing: import it again, what is there is known"};
    return;
  }
  for (std::size_t i = 0; i < receipts->size(); ++i)
    count((*receipts)[i], places[i]);
  progress_.show(places.back());
}

int AttemptDelivery::finish(const std::string& what, bool json, std::ostream& out) {
  deliver();
  progress_.clear();
  if (json)
    out << R"({"format":")" << json::to_text(json::kPathImportFormat) << R"(","robots":)"
        << counts_.robots << R"(,"stored":)" << counts_.stored << R"(,"known":)" << counts_.known
        << R"(,"recorded":)" << counts_.recorded << R"(,"refused":)" << counts_.refused << "}\n";
  else
    out << count_text(counts_.stored, "path") << " stored, "
        << count_text(counts_.recorded, "unsolved attempt") << " recorded, " << counts_.known
        << " known already, " << count_text(counts_.refused, what) << " refused; "
        << count_text(counts_.robots, "robot") << '\n';
  if (end_)
    return cli::refuse(kImportPaths, *end_, err_);
  return counts_.refused > 0 ? kFailed : kDone;
}

void AttemptDelivery::count(const Receipt& receipt, const std::string& place) {
  switch (receipt.status) {
    case ReceiptStatus::Stored:
      ++counts_.stored;
      break;
    case ReceiptStatus::Duplicate:
      ++counts_.known;
      break;
    case ReceiptStatus::Recorded:
      ++counts_.recorded;
      break;
    case ReceiptStatus::TryAgain:
      refuse(place, "not stored: " + receipt.message + "; import it again later");
      break;
    default:
      refuse(place, receipt.message);
  }
}

}  // namespace kinship::cli
