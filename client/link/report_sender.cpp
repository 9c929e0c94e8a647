#include "client/link/report_sender.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "client/link/outbox_files.hpp"
#include "proto/files/lock_file.hpp"
#include "proto/types/limits.hpp"

namespace kinship::link {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::milliseconds kShortestRetry = 100ms;
constexpr std::chrono::milliseconds kRetry = 1s;      // after "try again" or without an answer
constexpr std::chrono::milliseconds kIdle = 2s;       // another process may have added reports
constexpr std::chrono::milliseconds kLockRetry = 1s;  // another process sends
constexpr std::chrono::milliseconds kStorageRetry = 5s;
constexpr std::chrono::hours kAgeing{1};
constexpr std::chrono::minutes kBetweenProbes{10};
constexpr std::chrono::minutes kPassBy{1};           // a file that cannot be read
constexpr std::chrono::minutes kBetweenContents{1};  // that a server did not get
constexpr std::chrono::milliseconds kPoll = 50ms;    // for reports that another process sends

bool is_taken(ReceiptStatus status) {
  return status == ReceiptStatus::Stored || status == ReceiptStatus::Duplicate ||
         status == ReceiptStatus::Recorded;
}

}  // namespace

ReportSender::ReportSender(Outbox& outbox, Send send, Register register_robot, Now now,
                           CountServers count_servers, SetAsideRule set_aside)
    : outbox_(outbox),
      send_(std::move(send)),
      register_robot_(std::move(register_robot)),
      now_(std::move(now)),
      count_servers_(std::move(count_servers)),
      tries_(outbox.folder(), std::move(set_aside)),
      thread_([this] { run(); }) {}

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

void ReportSender::retry() {
  {
    const std::lock_guard lock(mutex_);
    is_retry_due_ = true;
  }
  changed_.notify_all();
}

ReportSender::Counts ReportSender::counts() const {
  const std::lock_guard lock(mutex_);
  Counts counts = counts_;
  counts.passed_by = passed_by_.size();
  if (counts.problem.empty() && counts.passed_by > 0)
    counts.problem = std::to_string(counts.passed_by) +
                     " reports are passed by ('kinship outbox list'), e.g. " + last_passed_by_;
  if (counts.problem.empty() && counts.set_aside > 0)
    counts.problem = std::to_string(counts.set_aside) +
                     " reports are set aside until 'kinship outbox resend', e.g. " +
                     last_set_aside_;
  return counts;
}

bool ReportSender::is_stopped() const {
  const std::lock_guard lock(mutex_);
  return is_stopped_;
}

void ReportSender::wait_until_empty(std::chrono::steady_clock::time_point deadline) {
  while (is_anything_to_send()) {
    std::unique_lock lock(mutex_);
    const auto now = std::chrono::steady_clock::now();
    if (is_stopped_ || now >= deadline)
      return;
    changed_.wait_until(lock, std::min(deadline, now + kPoll));
  }
}

void ReportSender::run() {
  std::optional<files::LockFile> lock;
  while (!is_stopped()) {
    {
      const std::lock_guard guard(mutex_);
      is_woken_ = false;
      is_retry_due_ = false;
    }
    std::chrono::milliseconds pause = kStorageRetry;
    try {
      pause = work(lock);
    } catch (const Failure& failure) {  // of the disk: nothing is lost, it is tried again
      report_problem(failure.what());
    }
    changed_.notify_all();
    std::unique_lock guard(mutex_);
    changed_.wait_for(guard, pause, [&] {
      return is_stopped_ || is_retry_due_ || (is_woken_ && pause == kIdle);
    });
  }
  if (lock) {
    age_now_and_then(true);
    tries_.save();
  }
}

/// One round. \return how long to pause.
std::chrono::milliseconds ReportSender::work(std::optional<files::LockFile>& lock) {
  if (!lock) {
    lock = try_to_become_sender(outbox_.folder());
    if (!lock)
      return kLockRetry;
    tries_.load();
  }
  age_now_and_then(false);
  is_resending_ = false;
  retry_after_ = 0ms;
  const bool gets_on = notes_store_first() && send_all_pending() && probe_epoch();
  if (gets_on)
    send_contents();
  if (!gets_on)  // a server that is busy says when it will not be
    return retry_after_ > 0ms ? std::max<std::chrono::milliseconds>(retry_after_, kShortestRetry)
                              : kRetry;
  return is_resending_ ? 0ms : kIdle;
}

/// Every hour, so that a process that is killed takes no more than that with it, and at the end.
void ReportSender::age_now_and_then(bool is_end) {
  const std::chrono::steady_clock::time_point now = now_();
  if (aged_ && !is_end && now - *aged_ < kAgeing)
    return;
  try {
    outbox_.age(std::chrono::duration_cast<std::chrono::milliseconds>(now - aged_.value_or(now)));
  } catch (const Failure& failure) {  // of the disk: sent reports are kept longer
    report_problem(failure.what());
  }
  aged_ = now;
  tries_.save();
}

/// The pending reports: those that the server put off behind the others, in the order of their last
/// tries, so that each has its turn although a batch with one of them ends a round.
std::vector<Uuid> ReportSender::in_turn() {
  std::vector<Uuid> pending = outbox_.pending();
  const std::set<Uuid> there(pending.begin(), pending.end());
  std::erase_if(put_off_, [&](const auto& each) { return !there.contains(each.first); });
  const auto last_try = [this](const Uuid& uuid) {
    const auto found = put_off_.find(uuid);
    return found == put_off_.end() ? 0 : found->second;
  };
  std::ranges::stable_sort(pending, {}, last_try);
  ++round_;
  const std::lock_guard lock(mutex_);
  std::erase_if(passed_by_, [&](const auto& each) { return !there.contains(each.first); });
  return pending;
}

/// \return false if something is left that should be tried again.
bool ReportSender::send_all_pending() {
  ReportRequest batch;
  BatchBytes bytes;
  unknown_.clear();
  refused_.clear();
  for (const Uuid& uuid : in_turn()) {
    if (is_stopped())
      return false;
    if (is_passed_by(uuid))
      continue;
    Result<Attempt> attempt = outbox_.read(uuid);
    if (!attempt && attempt.error().code == ErrorCode::Storage)
      pass_by(uuid, attempt.error().message);
    else if (!attempt && attempt.error().code != ErrorCode::NotFound)
      apply({uuid, ReceiptStatus::Refused, attempt.error().message});
    if (!attempt || unknown_.contains(attempt->robot))
      continue;
    if (const auto refused = refused_.find(attempt->robot); refused != refused_.end()) {
      apply({uuid, ReceiptStatus::Refused, refused->second});
      continue;
    }
    read_on(uuid);
    const BatchBytes size = batch_bytes(*attempt);
    if (batch.attempts.size() == kMaxAttemptsPerBatch || !(bytes + size).fits()) {
      if (!deliver(batch))
        return false;
      bytes = {};
    }
    bytes = bytes + size;
    batch.attempts.push_back(std::move(attempt).value());
  }
  return deliver(batch) && unknown_.empty();
}

/// Where a store that is new to the outbox shall not get what waits there.
/// \return false if it should be tried again.
bool ReportSender::notes_store_first() {
  if (probed_ || !outbox_.holds_back())
    return true;
  ReportRequest probe;
  const Result<ReportReply> reply = exchange(probe);
  std::string problem;
  if (!reply)
    problem = reply.error().message;
  else if (!probed_)
    problem =
        reply->message.empty() ? "the server does not say which store it has" : reply->message;
  report_problem(problem);
  return problem.empty();
}

/// Tells a server that came, and every server now and then, how far its store is known here, for
/// the case that it was rolled back: a client without reports would never hear of it.
/// \return false if it should be tried again.
bool ReportSender::probe_epoch() {
  const std::uint64_t servers = count_servers_ ? count_servers_() : 0;
  const bool is_known = servers == servers_probed_ && probed_ && now_() - *probed_ < kBetweenProbes;
  if (servers == 0 || is_known || !outbox_.has_receipts())
    return true;
  ReportRequest probe;
  return exchange(probe).has_value();
}

/// Registers the robots with contents of meshes in the outbox again: an earlier
/// registration ended before the server had them.
void ReportSender::send_contents() {
  const std::uint64_t servers = count_servers_ ? count_servers_() : 0;
  const bool is_due = servers != servers_with_contents_ ||
                      (contents_left_ && now_() - *contents_left_ >= kBetweenContents);
  if (!is_due || !register_robot_)
    return;
  servers_with_contents_ = servers;
  contents_left_.reset();
  for (const Digest& robot : outbox_.robots_with_contents()) {
    const Result<RobotDescription> description = outbox_.robot(robot);
    if (!description)
      continue;
    const Result<RegisterReply> reply = register_robot_(*description);
    if (!reply || !reply->wanted.empty())
      contents_left_ = now_();
  }
}

/// Sends a batch with the known token of the store, and notes the epoch and token in the reply.
Result<ReportReply> ReportSender::exchange(ReportRequest& batch) {
  const std::uint64_t servers = count_servers_ ? count_servers_() : 0;
  batch.known_token = outbox_.known_token();
  Result<ReportReply> reply = send_(batch);
  if (reply)
    retry_after_ = std::max(retry_after_, reply->retry_after);
  if (!reply || reply->store_epoch == Uuid{})  // the server could not even read the batch
    return reply;
  if (outbox_.note_store(reply->store_epoch, reply->consistency_token))
    is_resending_ = true;
  servers_probed_ = servers;
  probed_ = now_();
  return reply;
}

/// Sends a batch, if need be once more after registering robots, and empties it. Reports of robots
/// that stay unknown do not hold up others; those of robots that are refused for good are rejected.
/// \return false if nothing more should be sent in this round.
bool ReportSender::deliver(ReportRequest& batch) {
  bool gets_on = send_batch(batch);
  if (gets_on && register_robots(batch))
    gets_on = send_batch(batch);
  for (const Attempt& attempt : batch.attempts)
    if (const auto refused = refused_.find(attempt.robot); refused != refused_.end())
      apply({attempt.report_uuid, ReceiptStatus::Refused, refused->second});
    else
      unknown_.insert(attempt.robot);
  batch.attempts.clear();
  return gets_on;
}

/// Leaves the attempts in the batch whose robots the server does not know.
/// \return false if another attempt of the batch should be tried again.
bool ReportSender::send_batch(ReportRequest& batch) {
  if (batch.attempts.empty())
    return true;
  const Result<ReportReply> reply = exchange(batch);
  if (!reply) {
    report_problem(reply.error().message);
    return false;
  }
  std::string problem;
  const std::map<Uuid, Receipt> receipts = final_receipts(*reply, problem);
  const auto open = std::count_if(
      batch.attempts.begin(), batch.attempts.end(),
      [&](const Attempt& attempt) { return !receipts.contains(attempt.report_uuid); });
  if (open > 0 && problem.empty())
    problem = reply->message;
  if (open > 0 && problem.empty())
    problem = "the server gave no receipt for " + std::to_string(open) + " reports";
  if (!problem.empty() || unknown_.empty())
    report_problem(problem);  // before the last report leaves the outbox, which people wait for

  std::vector<Attempt> of_unknown_robots;
  for (Attempt& attempt : batch.attempts) {
    const auto found = receipts.find(attempt.report_uuid);
    if (found == receipts.end())
      continue;
    if (found->second.status == ReceiptStatus::UnknownRobot)
      of_unknown_robots.push_back(std::move(attempt));
    else
      apply(found->second);
  }
  batch.attempts = std::move(of_unknown_robots);
  return open == 0;
}

/// A "try again" counts against a report only if others of its batch were taken and the server does
/// not say when to come again: else the server is busy, stopping or out of a quota.
/// \param problem  gets the reason of the last report that is not taken.
/// \return the receipts after which a report is not sent again as it is: a "try again" only if the
///         report is to be set aside, with the reason.
std::map<Uuid, Receipt> ReportSender::final_receipts(const ReportReply& reply,
                                                     std::string& problem) {
  std::map<Uuid, Receipt> receipts;
  const bool are_others_taken =
      reply.retry_after == 0ms && std::ranges::any_of(reply.receipts, is_taken, &Receipt::status);
  for (const Receipt& receipt : reply.receipts) {
    if (receipt.status != ReceiptStatus::TryAgain) {
      receipts.emplace(receipt.report_uuid, receipt);
      if (receipt.status == ReceiptStatus::UnknownRobot)
        problem = receipt.message;
      continue;
    }
    put_off_[receipt.report_uuid] = round_;
    const std::string why =
        are_others_taken ? tries_.put_off(receipt.report_uuid, receipt.message) : std::string();
    if (why.empty())
      problem = receipt.message;
    else
      receipts.emplace(receipt.report_uuid,
                       Receipt{receipt.report_uuid, ReceiptStatus::TryAgain, why});
  }
  return receipts;
}

/// Registers the robots of a batch as the outbox describes them. A refusal without a time to ask
/// again is final.
/// \return true if the server knows one now.
bool ReportSender::register_robots(const ReportRequest& batch) {
  std::set<Digest> robots;
  for (const Attempt& attempt : batch.attempts)
    robots.insert(attempt.robot);
  if (!register_robot_)
    return false;
  bool is_registered = false;
  for (const Digest& robot : robots) {
    const Result<RobotDescription> description = outbox_.robot(robot);
    if (!description) {
      report_problem(description.error().message);
      continue;
    }
    const Result<RegisterReply> reply = register_robot_(*description);
    if (reply && reply->status != RegisterStatus::Refused) {
      is_registered = true;
      continue;
    }
    const std::string problem =
        "robot '" + description->label + "' (" + robot.short_hex() +
        ") not registered: " + (reply ? reply->message : reply.error().message);
    report_problem(problem);
    if (reply && reply->retry_after == 0ms)
      refused_[robot] = problem;
  }
  return is_registered;
}

/// Moves a report where its receipt says. What is in the way of one holds up no other.
void ReportSender::apply(const Receipt& receipt) {
  const Uuid& uuid = receipt.report_uuid;
  const bool is_refused = receipt.status == ReceiptStatus::Refused;
  const bool is_set_aside = receipt.status == ReceiptStatus::TryAgain;
  try {
    if (is_refused)
      outbox_.reject(uuid, receipt.message);
    else if (is_set_aside)
      outbox_.set_aside(uuid, receipt.message);
    else
      outbox_.mark_sent(uuid);
  } catch (const Failure& failure) {
    return pass_by(uuid, failure.what());
  }
  tries_.forget(uuid);
  const std::lock_guard lock(mutex_);
  ++(is_refused ? counts_.refused : is_set_aside ? counts_.set_aside : counts_.accepted);
  if (is_refused)
    counts_.last_refusal = receipt.message;
  if (is_set_aside)
    last_set_aside_ = uuid.text() + ": " + receipt.message;
}

/// Looks at a report again after a while.
void ReportSender::pass_by(const Uuid& report_uuid, const std::string& why) {
  const auto until = now_() + kPassBy;
  const std::lock_guard lock(mutex_);
  passed_by_[report_uuid] = until;
  last_passed_by_ = why;
}

bool ReportSender::is_passed_by(const Uuid& report_uuid) const {
  const auto now = now_();
  const std::lock_guard lock(mutex_);
  const auto found = passed_by_.find(report_uuid);
  return found != passed_by_.end() && now < found->second;
}

void ReportSender::read_on(const Uuid& report_uuid) {
  const std::lock_guard lock(mutex_);
  passed_by_.erase(report_uuid);
}

bool ReportSender::is_anything_to_send() const {
  std::set<Uuid> passed_by;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [uuid, until] : passed_by_)
      passed_by.insert(uuid);
  }
  return outbox_.pending_count(passed_by) > 0;
}

void ReportSender::report_problem(const std::string& problem) {
  const std::lock_guard lock(mutex_);
  counts_.problem = problem;
}

}  // namespace kinship::link
