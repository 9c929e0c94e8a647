#include "server/service/ingest.hpp"

#include <algorithm>
#include <memory>
#include <set>
#include <string>
#include <utility>

#include "server/service/validate_attempt.hpp"

namespace kinship::service {
namespace {

/// Waiting reports are decided within milliseconds, unless the disk or the server is at its end.
constexpr RetryAfter kRetryAfter{1000};

/// A robot may be registered later, and a damaged one repaired: their reports are not refused for
/// good.
ReceiptStatus status_of(bool is_robot_there, const Error& error) {
  if (!is_robot_there && error.code == ErrorCode::NotFound)
    return ReceiptStatus::UnknownRobot;
  return error.code == ErrorCode::Storage ? ReceiptStatus::TryAgain : ReceiptStatus::Refused;
}

}  // namespace

/// A batch on its way. Shared by the callbacks of one submission, never used by two at a time.
struct Ingest::Batch {
  Batch() = default;
  Batch(const Batch&) = delete;
  Batch& operator=(const Batch&) = delete;
  /// Without an answer if there was no memory for one: draining must not wait for it.
  ~Batch() {
    if (counted_by == nullptr)
      return;
    counted_by->let_go_of_client(*this);
    counted_by->let_go(*this);
  }

  std::vector<Attempt> attempts;  // until they are handed to the store
  std::vector<catalog::AttemptCost> costs;
  std::vector<Receipt> receipts;
  std::vector<std::size_t> accepted;    // positions of the attempts given to the store
  std::vector<std::size_t> path_bytes;  // of each attempt
  std::size_t bytes = 0;
  RetryAfter retry_after{0};
  Ingest* counted_by = nullptr;  // among its load_
  bool is_counted_of_client = false;
  std::string client;
  Done done;
};

Ingest::Ingest(store::ReportStore& store, runtime::RobotRegistry& robots,
               runtime::WorkerPool& short_task_pool, Options options)
    : store_(store),
      robots_(robots),
      short_task_pool_(short_task_pool),
      options_(std::move(options)) {}

void Ingest::submit(std::vector<Attempt> attempts, Done done, const std::string& client) {
  const auto batch = std::make_shared<Batch>();
  batch->client = client;
  batch->done = std::move(done);
  for (const Attempt& attempt : attempts) {
    batch->receipts.push_back({attempt.report_uuid, ReceiptStatus::TryAgain, {}});
    batch->costs.push_back(catalog::cost_of(attempt));
    const BatchBytes bytes = batch_bytes(attempt);
    batch->path_bytes.push_back(bytes.waypoints);
    batch->bytes += bytes.waypoints + bytes.scenes + bytes.searches;
  }
  batch->attempts = std::move(attempts);
  received_ += batch->receipts.size();

  if (const std::string why = take_in(*batch); !why.empty())
    return answer_try_again(*batch, why);
  const bool in_memory =
      std::all_of(batch->attempts.begin(), batch->attempts.end(),
                  [&](const Attempt& attempt) { return is_in_memory(attempt, client); });
  if (in_memory)
    return check_and_commit(batch);
  const bool accepted = short_task_pool_.submit(
      runtime::WorkerPool::Priority::Interactive,
      {.run = [this, batch] { check_and_commit(batch); },
       .abandon = [this, batch] { answer_try_again(*batch, "the server is stopping"); },
       .client = client});
  if (!accepted)
    answer_try_again(*batch, "the server is busy");
}

/// Whether it can be checked without the store.
bool Ingest::is_in_memory(const Attempt& attempt, const std::string& client) const {
  return robots_.find_in_memory(attempt.robot) != nullptr &&
         (client.empty() || options_.is_known_task(attempt.task));
}

std::string Ingest::take_in(Batch& batch) {
  std::string over_quota;
  {
    const std::lock_guard lock(mutex_);
    const auto exceeds = [&batch](const Load& load, std::size_t attempts, std::size_t bytes) {
      return load.attempts + batch.receipts.size() > attempts || load.bytes + batch.bytes > bytes;
    };
    if (draining_ || exceeds(load_, options_.max_attempts, options_.max_bytes))
      return "the server is busy or stopping";
    const bool is_limited = options_.client_attempts > 0 && !batch.client.empty();
    const auto known = clients_.find(batch.client);
    const Load own = known == clients_.end() ? Load{} : known->second;
    if (is_limited && exceeds(own, options_.client_attempts, options_.client_bytes))
      over_quota = "this client has " + std::to_string(own.attempts) +
                   " attempts on their way already; one client may have " +
                   std::to_string(options_.client_attempts) + " of " +
                   std::to_string(options_.client_bytes >> 20U) + " MB together";
    if (over_quota.empty()) {
      for (Load* const load : {&load_, &clients_[batch.client]}) {
        load->attempts += batch.receipts.size();
        load->bytes += batch.bytes;
      }
      batch.counted_by = this;
      batch.is_counted_of_client = true;
      return {};
    }
  }
  options_.on_over_quota(batch.client, over_quota);
  return over_quota;
}

/// Before the answer: a client that has it may send the next ones at once.
void Ingest::let_go_of_client(Batch& batch) {
  const std::lock_guard lock(mutex_);
  if (!std::exchange(batch.is_counted_of_client, false))
    return;
  Load& own = clients_[batch.client];
  own.attempts -= batch.receipts.size();
  own.bytes -= batch.bytes;
  if (own.attempts == 0)
    clients_.erase(batch.client);
}

/// After the answer: draining ends when all have got one.
void Ingest::let_go(Batch& batch) {
  const std::lock_guard lock(mutex_);
  if (std::exchange(batch.counted_by, nullptr) == nullptr)
    return;
  load_.attempts -= batch.receipts.size();
  load_.bytes -= batch.bytes;
  answered_.notify_all();
}

void Ingest::check_and_commit(const BatchPointer& batch) {
  try {
    check(*batch);
    if (!batch->accepted.empty())
      return commit(batch);
  } catch (const std::exception& exception) {  // no memory, or the store is at its end
    return answer_try_again(*batch, exception.what());
  }
  answer(*batch);
}

void Ingest::commit(const BatchPointer& batch) {
  std::vector<Attempt> good;
  good.reserve(batch->accepted.size());
  for (const std::size_t i : batch->accepted)
    good.push_back(std::move(batch->attempts[i]));
  batch->attempts.clear();
  store_.commit_reports(std::move(good), [this, batch](const std::vector<Receipt>& receipts) {
    committed(*batch, receipts);
  });
}

void Ingest::check(Batch& batch) {
  for (std::size_t i = 0; i < batch.attempts.size(); ++i) {
    const Attempt& attempt = batch.attempts[i];
    const Result<runtime::RobotRegistry::RobotPointer> robot = robots_.find(attempt.robot);
    const std::optional<Error> error = robot ? validate(attempt, *robot.value()) : robot.error();
    if (error) {
      batch.receipts[i] = {attempt.report_uuid, status_of(robot.has_value(), *error),
                           error->message};
    } else if (const auto over = begins_too_many(batch, attempt)) {
      batch.receipts[i].message = over->message;
      batch.retry_after = std::max(batch.retry_after, over->retry_after);
    } else {
      batch.accepted.push_back(i);
    }
  }
}

/// The tasks that a batch begins at once are not counted yet: the last one may be beyond the quota.
std::optional<quotas::Refusal> Ingest::begins_too_many(const Batch& batch,
                                                       const Attempt& attempt) const {
  if (batch.client.empty() || options_.is_known_task(attempt.task))
    return std::nullopt;
  return options_.may_begin_task(batch.client, attempt.task);
}

void Ingest::committed(Batch& batch, const std::vector<Receipt>& receipts) {
  std::set<std::string_view> grown;
  for (std::size_t i = 0; i < batch.accepted.size() && i < receipts.size(); ++i) {
    const std::size_t position = batch.accepted[i];
    batch.receipts[position] = receipts[i];
    const bool is_stored = receipts[i].status == ReceiptStatus::Stored;
    if (is_stored)
      grown.insert(batch.costs[position].task);
    if (receipts[i].status == ReceiptStatus::UnknownRobot)
      robots_.forget(batch.costs[position].robot);  // its client registers it, and is to be heard
    if (is_stored || receipts[i].status == ReceiptStatus::Recorded)
      options_.on_kept(batch.client, batch.costs[position].task,
                       is_stored ? batch.path_bytes[position] : 0);
  }
  for (const std::string_view task : grown)
    options_.on_new_experience(task);
  answer(batch);
}

void Ingest::answer(Batch& batch) {
  refused_ += static_cast<std::uint64_t>(std::count_if(
      batch.receipts.begin(), batch.receipts.end(),
      [](const Receipt& receipt) { return receipt.status == ReceiptStatus::Refused; }));
  options_.on_answer(batch.costs, batch.receipts);
  let_go_of_client(batch);
  batch.done(batch.receipts, batch.retry_after);
  let_go(batch);
}

void Ingest::answer_try_again(Batch& batch, std::string_view message) {
  batch.retry_after = kRetryAfter;
  for (Receipt& receipt : batch.receipts) {
    receipt.status = ReceiptStatus::TryAgain;
    receipt.message = message;
  }
  answer(batch);
}

void Ingest::drain() {
  std::unique_lock lock(mutex_);
  draining_ = true;
  answered_.wait(lock, [this] { return load_.attempts == 0; });
}

std::size_t Ingest::queued() const {
  const std::lock_guard lock(mutex_);
  return load_.attempts;
}

std::map<std::string, std::size_t> Ingest::queued_of_clients() const {
  const std::lock_guard lock(mutex_);
  std::map<std::string, std::size_t> queued;
  for (const auto& [client, load] : clients_)
    queued.emplace(client, load.attempts);
  return queued;
}

}  // namespace kinship::service
