#include "server/service/jobs.hpp"

#include <algorithm>
#include <map>
#include <utility>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::service {
namespace {

Error no_job(const std::string& id) { return {ErrorCode::NotFound, "no job '" + id + "'"}; }

std::string describe(JobState state) {
  switch (state) {
    case JobState::Queued:
      return "waits still";
    case JobState::Running:
      return "runs still";
    case JobState::Done:
      return "is done";
    case JobState::Failed:
      return "failed";
    case JobState::Cancelled:
      return "was cancelled";
  }
  return "is unknown";
}

}  // namespace

bool has_ended(JobState state) noexcept {
  return state != JobState::Queued && state != JobState::Running;
}

struct Jobs::Entry {
  Job job;
  Task task;  // its function goes when the job has ended
  std::stop_source stop;
  std::shared_ptr<JobRun> result;  // changed by the thread of the jobs alone until the end
  TimePoint forgotten_at{};        // once it has ended

  Job now() const {
    Job copy = job;
    if (job.state == JobState::Running)
      copy.progress = result->progress();
    return copy;
  }
};

Jobs::Jobs(const runtime::Clock& clock, Options options)
    : clock_(clock),
      options_(std::move(options)),
      worker_({.threads = 1, .queue_limit = 2, .niceness = options_.niceness}) {}

Result<Job> Jobs::begin(Task task) {
  const std::lock_guard lock(mutex_);
  forget_old(clock_.now());
  if (const EntryPointer same = find_begun(task.request_key))
    return same->now();
  if (auto refusal = find_refusal(task.owner))
    return *std::move(refusal);
  const auto entry = std::make_shared<Entry>();
  entry->job.id = new_id();
  entry->job.verb = task.verb;
  entry->job.argument = task.argument;
  entry->job.started_ms = clock_.unix_ms();
  entry->task = std::move(task);
  entries_.push_back(entry);
  if (!is_working_)
    is_working_ = worker_.submit(runtime::WorkerPool::Priority::Background,
                                 {.run = [this] { work(); }, .abandon = {}});
  return entry->job;
}

std::optional<Error> Jobs::refusal_of(const std::string& owner) const {
  const std::lock_guard lock(mutex_);
  return find_refusal(owner);
}

std::optional<Error> Jobs::find_refusal(const std::string& owner) const {
  const Limits& limits = options_.limits;
  if (is_stopping_)
    return Error{ErrorCode::Unavailable, "the server is stopping"};
  const auto of_owner = std::ranges::count_if(entries_, [&owner](const EntryPointer& entry) {
    return entry->task.owner == owner && !has_ended(entry->job.state);
  });
  if (!owner.empty() && limits.client_active > 0 &&
      static_cast<std::size_t>(of_owner) >= limits.client_active)
    return Error{ErrorCode::Unavailable, "busy: this client has " + std::to_string(of_owner) +
                                             " jobs that have not ended, as many as one may have; "
                                             "cancel one or ask again later"};
  if (count(JobState::Queued) >= limits.queued)
    return Error{ErrorCode::Unavailable,
                 "busy: " + std::to_string(limits.queued) +
                     " jobs wait already, the most there may be; cancel one or ask again later"};
  return std::nullopt;
}

void Jobs::work() {
  while (const EntryPointer entry = next())
    run(entry);
}

Jobs::EntryPointer Jobs::next() {
  const std::lock_guard lock(mutex_);
  const auto found = std::find_if(entries_.begin(), entries_.end(), [](const auto& entry) {
    return entry->job.state == JobState::Queued;
  });
  is_working_ = found != entries_.end();
  if (!is_working_)
    return nullptr;
  Entry& entry = **found;
  entry.result = std::make_shared<JobRun>(entry.stop.get_token(), options_.limits.row_bytes);
  entry.job.state = JobState::Running;
  return *found;
}

void Jobs::run(const EntryPointer& entry) {
  JobRun& result = *entry->result;
  Job ended = entry->job;  // which this thread alone changes while it runs
  ended.state = JobState::Failed;
  try {
    ended.state = entry->task.run(result) ? JobState::Done : JobState::Cancelled;
    ended.message =
        ended.state == JobState::Done || !result.message.empty() ? result.message : "cancelled";
  } catch (const std::exception& exception) {
    ended.message = exception.what();
  }
  // First: a caller that then finds the job ended, in any way, finds its consequences, too.
  std::exchange(entry->task.on_end, [](const Job&) {})(ended);
  Calls calls;
  {
    const std::lock_guard lock(mutex_);
    end(*entry, ended.state, ended.message, calls);
  }
  make(calls);
}

void Jobs::end(Entry& entry, JobState state, const std::string& message, Calls& calls) {
  entry.task.run = nullptr;
  entry.job.state = state;
  entry.job.message = cut_text(message, kMaxMessageBytes);
  entry.job.ended_ms = clock_.unix_ms();
  if (entry.result)
    entry.job.progress = entry.result->progress();
  if (state == JobState::Done) {
    entry.job.progress = 1;
    entry.job.rows = entry.result->rows.size();
  } else {
    entry.result.reset();
  }
  const TimePoint now = clock_.now();
  entry.forgotten_at = now + options_.limits.kept_for;
  const auto its_own =
      std::stable_partition(waiters_.begin(), waiters_.end(),
                            [&entry](const Waiter& waiter) { return waiter.id != entry.job.id; });
  for (auto waiter = its_own; waiter != waiters_.end(); ++waiter)
    calls.answers.emplace_back(std::move(waiter->done), entry.job);
  waiters_.erase(its_own, waiters_.end());
  calls.ended.emplace_back(std::exchange(entry.task.on_end, [](const Job&) {}), entry.job);
  forget_old(now);
}

void Jobs::make(const Calls& calls) const {
  for (const auto& [on_end, job] : calls.ended) {
    on_end(job);
    options_.on_end(job);
  }
  for (const auto& [done, job] : calls.answers)
    done(job);
}

std::optional<Job> Jobs::begun_by(const std::string& request_key) const {
  const std::lock_guard lock(mutex_);
  const EntryPointer entry = find_begun(request_key);
  return entry ? std::optional<Job>(entry->now()) : std::nullopt;
}

store::Page<Job> Jobs::list(const std::string& cursor, std::size_t limit) const {
  const std::lock_guard lock(mutex_);
  auto next = entries_.rbegin();
  if (!cursor.empty()) {
    next = std::find_if(next, entries_.rend(),
                        [&](const EntryPointer& entry) { return entry->job.id == cursor; });
    if (next != entries_.rend())
      ++next;
  }
  store::Page<Job> page;
  for (; next != entries_.rend() && page.rows.size() < limit; ++next)
    page.rows.push_back((*next)->now());
  if (next != entries_.rend())
    page.next_cursor = page.rows.back().id;
  return page;
}

Result<Job> Jobs::find(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const EntryPointer entry = find_entry(id);
  if (!entry)
    return no_job(id);
  return entry->now();
}

std::optional<std::string> Jobs::owner_of(const std::string& id) const {
  const std::lock_guard lock(mutex_);
  const EntryPointer entry = find_entry(id);
  return entry ? std::optional<std::string>(entry->task.owner) : std::nullopt;
}

std::size_t Jobs::active() const {
  const std::lock_guard lock(mutex_);
  return count(JobState::Queued) + count(JobState::Running);
}

Result<Job> Jobs::cancel(const std::string& id) {
  Calls calls;
  Job job;
  {
    const std::lock_guard lock(mutex_);
    const EntryPointer entry = find_entry(id);
    if (!entry)
      return no_job(id);
    entry->stop.request_stop();
    if (entry->job.state == JobState::Queued)
      end(*entry, JobState::Cancelled, "cancelled before it began", calls);
    job = entry->now();
  }
  make(calls);
  return job;
}

Result<Jobs::RowPage> Jobs::rows(const std::string& id, std::size_t first, std::size_t limit,
                                 std::size_t max_bytes) const {
  std::shared_ptr<const JobRun> result;
  {
    const std::lock_guard lock(mutex_);
    const EntryPointer entry = find_entry(id);
    if (!entry)
      return no_job(id);
    const Job& job = entry->job;
    if (job.state != JobState::Done)
      return Error{ErrorCode::InvalidInput,
                   "job '" + id + "' " + describe(job.state) +
                       (has_ended(job.state) ? ": it has no rows" : ": it has no rows yet") +
                       (job.message.empty() ? "" : " (" + job.message + ")")};
    result = entry->result;
  }
  RowPage page;
  page.rows = result->rows.page(first, limit, max_bytes);
  page.next = first + page.rows.size() < result->rows.size() ? first + page.rows.size() : 0;
  return page;
}

void Jobs::wait(const std::string& id, TimePoint deadline, Done done) {
  Result<Job> job = no_job(id);
  {
    const std::lock_guard lock(mutex_);
    if (const EntryPointer entry = find_entry(id)) {
      job = entry->now();
      const bool waits = !has_ended(entry->job.state) && deadline > clock_.now() &&
                         waiters_.size() < options_.limits.waiters;
      if (waits) {
        waiters_.push_back({id, deadline, std::move(done)});
        return;
      }
    }
  }
  done(job);
}

std::optional<Jobs::TimePoint> Jobs::next_deadline() const {
  const std::lock_guard lock(mutex_);
  std::optional<TimePoint> next;
  const auto consider = [&next](TimePoint time) {
    if (!next || time < *next)
      next = time;
  };
  for (const Waiter& waiter : waiters_)
    consider(waiter.deadline);
  for (const EntryPointer& entry : entries_)
    if (has_ended(entry->job.state))
      consider(entry->forgotten_at);
  return next;
}

void Jobs::expire(TimePoint now) {
  Calls calls;
  {
    const std::lock_guard lock(mutex_);
    const auto due =
        std::stable_partition(waiters_.begin(), waiters_.end(),
                              [now](const Waiter& waiter) { return waiter.deadline > now; });
    for (auto waiter = due; waiter != waiters_.end(); ++waiter)
      calls.answers.emplace_back(std::move(waiter->done), find_entry(waiter->id)->now());
    waiters_.erase(due, waiters_.end());
    forget_old(now);
  }
  make(calls);
}

void Jobs::stop() {
  Calls calls;
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    const std::deque<EntryPointer> all = entries_;  // end() may forget some
    for (const EntryPointer& entry : all) {
      entry->stop.request_stop();
      if (entry->job.state == JobState::Queued)
        end(*entry, JobState::Cancelled, "the server is stopping", calls);
    }
  }
  make(calls);
  worker_.stop(runtime::WorkerPool::Leftovers::Abandon);
}

Jobs::EntryPointer Jobs::find_entry(const std::string& id) const {
  const auto found = std::find_if(entries_.begin(), entries_.end(),
                                  [&id](const auto& entry) { return entry->job.id == id; });
  return found == entries_.end() ? nullptr : *found;
}

Jobs::EntryPointer Jobs::find_begun(const std::string& request_key) const {
  const auto found =
      std::find_if(entries_.begin(), entries_.end(), [&request_key](const auto& entry) {
        return !request_key.empty() && entry->task.request_key == request_key;
      });
  return found == entries_.end() ? nullptr : *found;
}

std::string Jobs::new_id() const {
  std::string id;
  do {
    id = Uuid::random().text().substr(0, 8);
  } while (find_entry(id));
  return id;
}

std::size_t Jobs::count(JobState state) const {
  return static_cast<std::size_t>(
      std::count_if(entries_.begin(), entries_.end(),
                    [state](const auto& entry) { return entry->job.state == state; }));
}

void Jobs::forget_old(TimePoint now) {
  std::size_t kept = 0, bytes = 0;
  std::map<std::string, std::size_t> kept_of;
  std::deque<EntryPointer> remaining;
  // From the newest to the oldest, so that the old ones exceed the limits.
  for (auto entry = entries_.rbegin(); entry != entries_.rend(); ++entry) {
    if (has_ended((*entry)->job.state)) {
      const std::string& owner = (*entry)->task.owner;
      if (!owner.empty() && ++kept_of[owner] > options_.limits.client_kept)
        continue;
      const std::size_t rows = (*entry)->result ? (*entry)->result->rows.bytes() : 0;
      ++kept;
      bytes += rows;
      const bool is_too_much = kept > 1 && bytes > options_.limits.kept_bytes;
      if ((*entry)->forgotten_at <= now || kept > options_.limits.kept || is_too_much)
        continue;
    }
    remaining.push_front(*entry);
  }
  entries_ = std::move(remaining);
}

}  // namespace kinship::service
