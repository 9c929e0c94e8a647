#include "server/rehearsal/rehearsal_scheduler.hpp"

#include <algorithm>
#include <exception>
#include <string>

#include "proto/types/duration_text.hpp"
#include "proto/types/enum_text.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/stopped.hpp"
#include "robots/planning/planning_budget.hpp"
#include "server/fitting/selected_experience.hpp"
#include "server/rehearsal/recall_queries.hpp"
#include "server/rehearsal/subject.hpp"

namespace kinship::rehearsal {
namespace {

constexpr int kNiceness = 10;  // about a tenth of a processor where others want all of it
constexpr std::size_t kMaxQueued = 1024;

/// Another number once a path of the task was retired.
std::uint64_t count_retirements(const store::ExperienceStore& store, std::string_view task) {
  std::uint64_t sum = 0;
  for (const store::ExperienceSummary& robot : store.experience(task))
    sum += robot.retired_generation;
  return sum;
}

/// Equal for keys that differ in the placement alone.
Digest kind_of(const RehearsalKey& key) {
  fitting::DistributionKey kind = key.distribution;
  kind.T_task_base.reset();
  return identify(kind);
}

}  // namespace

RehearsalScheduler::RehearsalScheduler(const Parts& parts, RehearsalSchedulerOptions options)
    : parts_(parts),
      options_(std::move(options)),
      pool_({.threads = 1, .queue_limit = kMaxQueued, .niceness = kNiceness}) {
  if (parts_.rehearsals == nullptr || options_.processor_fraction == 0)
    return;
  try {
    load();
  } catch (const std::exception& exception) {
    options_.log("rehearsals of the store: " + std::string(exception.what()));
  }
}

/// Without those that have a path which is retired by now. The first request compares their paths
/// with the experience.
void RehearsalScheduler::load() {
  std::vector<store::StoredRehearsal> stored =
      parts_.rehearsals->read_rehearsals(options_.max_rehearsals);
  std::ranges::reverse(stored);  // the oldest first
  for (store::StoredRehearsal& each : stored) {
    if (each.retired != count_retirements(parts_.store, each.task))
      continue;
    Entry& entry = entries_[each.id];
    entry.id = each.id;
    entry.key.distribution.task = std::move(each.task);  // a request brings the rest
    entry.key.distribution.T_task_base = each.T_task_base;
    entry.kind = each.kind;
    entry.known = std::make_shared<const Rehearsal>(std::move(each.rehearsal));
    if (each.library)
      entry.library = std::make_shared<const RecallLibrary>(*std::move(each.library));
    entry.made_of.all = each.paths;
    entry.last_used = ++uses_;
  }
}

SharedRehearsal RehearsalScheduler::ask(const RehearsalKey& key) {
  const std::lock_guard lock(mutex_);
  if (is_stopping_ || options_.processor_fraction == 0)
    return nullptr;
  const SharedRehearsal known = known_to(use(key));
  make_room();
  return known;
}

/// Its own complete rehearsal, or that of the nearest placement, or its own so far. One in which
/// nothing could be planned tells nothing where another one tells something.
SharedRehearsal RehearsalScheduler::known_to(const Entry& entry) const {
  const bool is_complete = entry.known && entry.known->is_complete;
  if (is_complete && entry.known->queries > 0)
    return entry.known;
  const Entry* const near = nearest(entry.key, Worth::Any);
  const bool is_better = near != nullptr && (!is_complete || near->known->queries > 0);
  return is_better ? near->known : entry.known;
}

/// The entry of an equal key at the nearest other placement that has been rehearsed.
/// \param worth  Enough: not one in which nothing could be planned, nor one without a library where
///               the experience has changed since: one may be made by now.
const RehearsalScheduler::Entry* RehearsalScheduler::nearest(const RehearsalKey& key,
                                                             Worth worth) const {
  constexpr double kNear_m = 1.5;  // a radian counts as 0.3 m
  const auto place = [](const RehearsalKey& of) {
    return of.distribution.T_task_base.value_or(Eigen::Isometry3d::Identity());
  };
  const Digest kind = kind_of(key), own = identify(key.distribution);
  const Entry* found = nullptr;
  std::pair<bool, double> least{true, kNear_m};  // nothing could be planned there; distance
  for (const auto& [id, entry] : entries_) {
    if (!entry.known || !entry.known->is_complete || entry.lost || entry.kind != kind || id == own)
      continue;
    const bool is_empty = entry.known->queries == 0;
    if (worth == Worth::Enough && (is_empty || (!entry.library && !is_compared(entry))))
      continue;
    const double distance = planning::pose_distance_m(place(entry.key), place(key));
    const std::pair here(is_empty, distance);
    if (distance <= kNear_m && here <= least) {
      least = here;
      found = &entry;
    }
  }
  return found;
}

SharedLibrary RehearsalScheduler::library(const RehearsalKey& key) const {
  const std::lock_guard lock(mutex_);
  const auto own = entries_.find(identify(key.distribution));
  if (own != entries_.end() && own->second.library && !own->second.lost)
    return own->second.library;
  const Entry* const near = nearest(key);
  return near != nullptr ? near->library : nullptr;
}

void RehearsalScheduler::wait(const RehearsalKey& key, TimePoint deadline, const Done& done) {
  SharedRehearsal known;
  bool waits = false;
  {
    const std::lock_guard lock(mutex_);
    if (!is_stopping_ && options_.processor_fraction > 0) {
      Entry& entry = use(key);
      known = known_to(entry);
      const bool is_complete = entry.known && entry.known->is_complete;
      const bool is_served = !is_complete && nearest(key) != nullptr;
      waits = entry.is_working && !is_served && waiters_ < options_.max_waiters;
      if (waits) {
        entry.waiters.push_back({deadline, done});
        ++waiters_;
      }
      make_room();
    }
  }
  if (!waits)
    return done(known);
  urgent_.notify_all();
  options_.wake();
}

RehearsalScheduler::Entry& RehearsalScheduler::use(const RehearsalKey& key) {
  const Digest id = identify(key.distribution);
  Entry& entry = entries_[id];
  entry.id = id;
  entry.key = key;
  entry.kind = kind_of(key);
  entry.last_used = ++uses_;
  ++entry.asked;
  const Entry* const near = entry.known ? nullptr : nearest(key);
  if (near != nullptr)
    near->last_used = ++uses_;  // it serves, too
  if (entry.asked > 1 || near == nullptr) {
    begin(id, entry);
  } else {
    const Digest near_id = near->id;
    Entry& serving = entries_[near_id];
    const std::optional<Eigen::Isometry3d> T_task_base = serving.key.distribution.T_task_base;
    serving.key = key;  // of one from before a restart the placement alone is known
    serving.key.distribution.T_task_base = T_task_base;
    begin(near_id, serving);
  }
  return entry;
}

/// Whether it was compared with the task's experience as that is now.
bool RehearsalScheduler::is_compared(const Entry& entry) const {
  return entry.looked_at == versions_.of(entry.key.distribution.task).changes;
}

/// Compares it with the experience, which may rehearse it, unless that was done or is under way.
void RehearsalScheduler::begin(const Digest& id, Entry& entry) {
  if (!entry.is_working && !(entry.known && !entry.lost && is_compared(entry)))
    entry.is_working = pool_.submit(runtime::WorkerPool::Priority::Background,
                                    {.run = [this, id] { work(id); }, .abandon = {}});
}

std::optional<RehearsalScheduler::TimePoint> RehearsalScheduler::next_deadline() const {
  const std::lock_guard lock(mutex_);
  std::optional<TimePoint> next;
  for (const auto& [id, entry] : entries_)
    for (const Waiter& waiter : entry.waiters)
      next = next ? std::min(*next, waiter.deadline) : waiter.deadline;
  return next;
}

void RehearsalScheduler::expire(TimePoint now) {
  WaiterAnswers answers;
  {
    const std::lock_guard lock(mutex_);
    for (auto& [id, entry] : entries_) {
      const auto late =
          std::stable_partition(entry.waiters.begin(), entry.waiters.end(),
                                [&](const Waiter& waiter) { return waiter.deadline > now; });
      for (auto waiter = late; waiter != entry.waiters.end(); ++waiter)
        answers.emplace_back(std::move(waiter->done), known_to(entry));
      waiters_ -= static_cast<std::size_t>(entry.waiters.end() - late);
      entry.waiters.erase(late, entry.waiters.end());
    }
  }
  for (const auto& [done, known] : answers)
    done(known);
}

void RehearsalScheduler::new_experience(std::string_view task) {
  const std::lock_guard lock(mutex_);
  versions_.grew(task);
}

void RehearsalScheduler::forget(std::string_view task, Loss loss) {
  const std::lock_guard lock(mutex_);
  versions_.lost(task);
  for (auto& [id, entry] : entries_) {
    if (entry.key.distribution.task != task)
      continue;
    entry.lost = std::max(entry.lost.value_or(loss), loss);
    entry.library.reset();
    if (loss == Loss::Task)
      entry.known.reset();
  }
}

SharedRehearsal RehearsalScheduler::find(const Digest& distribution) const {
  const std::lock_guard lock(mutex_);
  const auto found = entries_.find(distribution);
  return found == entries_.end() ? nullptr : found->second.known;
}

RehearsalTotals RehearsalScheduler::totals() const {
  const std::lock_guard lock(mutex_);
  RehearsalTotals totals = totals_;
  totals.queued = static_cast<std::uint64_t>(
      std::ranges::count_if(entries_, [](const auto& each) { return each.second.is_working; }));
  return totals;
}

void RehearsalScheduler::work(const Digest& id) {
  Entry before;
  std::uint64_t changes = 0;
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[id];
    before.key = entry.key;
    before.known = entry.known;
    before.library = entry.library;
    before.made_of = entry.made_of;
    before.lost = entry.lost;
    entry.lost.reset();
    changes = versions_.of(entry.key.distribution.task).changes;
  }
  try {
    if (is_out_of_date(before.key, before))
      rehearse(id, before.key);
  } catch (const Stopped&) {  // all waiters were answered
  } catch (
      const std::exception& exception) {  // the store cannot be read: the next request tries again
    options_.log("rehearsal " + id.short_hex() + ": " + exception.what());
  }
  WaiterAnswers answers;
  {
    const std::lock_guard lock(mutex_);
    Entry& entry = entries_[id];
    entry.looked_at = changes;
    entry.is_working = false;
    let_go(entry, answers);
    make_room();
  }
  for (const auto& [done, known] : answers)
    done(known);
}

RehearsalScheduler::Counts RehearsalScheduler::count_selected(
    const fitting::DistributionKey& key) const {
  const std::vector<store::ExperienceSummary> selected =
      fitting::selected_experience(key, parts_.store.experience(key.task));
  Counts counts{fitting::count_paths(selected), 0};
  for (const store::ExperienceSummary& source : selected)
    if (source.robot == key.robot)
      *counts.own += source.paths;
  return counts;
}

bool RehearsalScheduler::is_out_of_date(const RehearsalKey& key, const Entry& entry) const {
  if (!entry.known || entry.lost)
    return true;
  const Counts now = count_selected(key.distribution);
  const Counts& then = entry.made_of;
  const std::uint64_t growth =
      entry.library ? std::max<std::uint64_t>(10, then.all / 5)
                    : std::max<std::uint64_t>(1, then.all / 20);  // one may be made of it
  // The first own ones tell more than many of another robot's.
  const bool is_doubled = then.own && *now.own >= std::max<std::uint64_t>(1, 2 * *then.own);
  return now.all >= then.all + growth || is_doubled;
}

void RehearsalScheduler::rehearse(const Digest& id, const RehearsalKey& key) {
  const double begin_s = planning::thread_time_s();
  const std::uint64_t retired = count_retirements(parts_.store, key.distribution.task);
  const Counts paths = count_selected(key.distribution);
  Rehearsal result;
  result.is_complete = true;
  Result<Subject> subject =
      read_subject(key, parts_, options_.max_queries, stop_source_.get_token());
  const bool is_rehearsed = subject.has_value();
  if (is_rehearsed) {
    result = try_guides(id, *std::move(subject), paths);
    if (stop_source_.stop_requested())
      return;
  } else {
    result.message = "not rehearsed: " + subject.error().message;
  }
  result.processor_time_s = planning::thread_time_s() - begin_s;
  options_.log("rehearsal " + id.short_hex() + " of task '" + key.distribution.task +
               "': " + std::to_string(result.queries) + " queries, guide " +
               std::string(to_text(result.guide)) + ", " + duration_text(result.processor_time_s) +
               " of processor time" + described(result.costs) +
               (result.message.empty() ? "" : ": " + result.message));
  keep(id, std::move(result), paths);
  if (is_rehearsed && parts_.rehearsals != nullptr)
    save(id, retired);
}

/// Rests after each part, until there is none or the scheduler stops.
void RehearsalScheduler::do_in_parts(const Digest& id, const std::function<bool()>& part) {
  double rested_s = planning::thread_time_s();
  while (!stop_source_.stop_requested() && part()) {
    const double now_s = planning::thread_time_s();
    rest(id, now_s - rested_s);
    rested_s = now_s;
  }
}

/// A first result, before the long work: each guide on a few queries.
void RehearsalScheduler::try_a_few(const Digest& id, const Subject& subject, RehearsalOptions plan,
                                   const Counts& paths) {
  constexpr std::size_t kFew = 10;
  Subject few = subject;
  std::vector<RecordedQuery>& queries = few.recorded.queries;
  if (queries.size() < 2 * kFew)
    return;
  for (std::size_t i = 0; i < kFew; ++i)
    queries[i] = queries[i * queries.size() / kFew];
  queries.resize(kFew);
  plan.rounds = 1;
  Rehearsing rehearsing(std::move(few), plan);
  do_in_parts(id, [&] { return rehearsing.step(); });
  Rehearsal result = rehearsing.result();
  result.is_complete = false;
  keep(id, std::move(result), paths);
}

/// Makes the library, then plans every query with every guide.
Rehearsal RehearsalScheduler::try_guides(const Digest& id, Subject subject, const Counts& paths) {
  const double begin_s = planning::thread_time_s();
  const runtime::Robot& robot = *subject.robot;
  // A longer way round than the robot needs, or a shorter one.
  const std::string shapes =
      robot.grade == GeometryGrade::Exact
          ? std::string()
          : "with the shapes that the server knows: " + subject.robot->geometry;
  RehearsalOptions plan = options_.plan;
  plan.stop = stop_source_.get_token();
  if (!find(id))
    try_a_few(id, subject, plan, paths);
  if (const SharedLibrary library = make_library(id, subject))
    subject.recall = std::make_shared<recall::RecallGuide>(robot.chain, *library);
  Rehearsing rehearsing(std::move(subject), plan);
  std::size_t kept_rounds = 0;
  do_in_parts(id, [&] {
    const bool is_done = !rehearsing.step();
    if (rehearsing.rounds() > kept_rounds) {
      kept_rounds = rehearsing.rounds();
      Rehearsal result = rehearsing.result();
      result.processor_time_s = planning::thread_time_s() - begin_s;
      if (!result.is_complete)
        keep(id, std::move(result), paths);
    }
    return !is_done;
  });
  Rehearsal result = rehearsing.result();
  if (result.message.empty())
    result.message = shapes;
  return result;
}

/// \return null: none can be made.
SharedLibrary RehearsalScheduler::make_library(const Digest& id, const Subject& subject) {
  recall::LibraryMakerOptions options;
  options.step = subject.recorded.steps.step;
  options.before = [stop = stop_source_.get_token()] { throw_if_stopped(stop); };
  recall::LibraryMaker maker(
      subject.robot->chain, {subject.robot->chain, subject.robot->shapes},
      recall_queries(*subject.robot, subject.T_task_base, subject.recorded.queries, subject.starts),
      options);
  do_in_parts(id, [&] { return maker.step(); });
  std::optional<RecallLibrary> made = maker.take();
  SharedLibrary library = made ? std::make_shared<const RecallLibrary>(*std::move(made)) : nullptr;
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[id];
  if (!entry.lost)  // else it was made of paths that were retired meanwhile
    entry.library = library;
  return entry.library;
}

void RehearsalScheduler::keep(const Digest& id, Rehearsal rehearsal, const Counts& paths) {
  auto known = std::make_shared<const Rehearsal>(std::move(rehearsal));
  const std::lock_guard lock(mutex_);
  Entry& entry = entries_[id];
  if (entry.lost == Loss::Task)
    return;
  entry.made_of = paths;
  if (known->is_complete) {
    totals_.processor_time_s += known->processor_time_s;
    ++totals_.done;
  }
  entry.known = std::move(known);
}

/// Writes what was kept into the store, unless paths that it may be made of were retired meanwhile.
/// \param retired  of the task before its paths were read.
void RehearsalScheduler::save(const Digest& id, std::uint64_t retired) {
  std::unique_lock lock(mutex_);
  const Entry& entry = entries_[id];
  if (entry.lost)
    return;
  const fitting::DistributionKey& key = entry.key.distribution;
  store::StoredRehearsal stored{.id = id,
                                .robot = key.robot,
                                .task = key.task,
                                .made_ms = parts_.clock.unix_ms(),
                                .kind = entry.kind,
                                .paths = entry.made_of.all,
                                .retired = retired,
                                .T_task_base = key.T_task_base,
                                .rehearsal = *entry.known};
  if (entry.library)
    stored.library = *entry.library;
  lock.unlock();
  parts_.rehearsals->put_rehearsal(stored);
}

/// Leaves the processor to others in proportion to its use, unless a request waits.
void RehearsalScheduler::rest(const Digest& id, double worked_s) {
  const double rest_s = worked_s * (1 / options_.processor_fraction - 1);
  std::unique_lock lock(mutex_);
  urgent_.wait_for(lock, std::chrono::duration<double>(rest_s),
                   [&] { return is_stopping_ || !entries_[id].waiters.empty(); });
}

void RehearsalScheduler::let_go(Entry& entry, WaiterAnswers& answers) {
  for (Waiter& waiter : entry.waiters)
    answers.emplace_back(std::move(waiter.done), entry.known);
  waiters_ -= entry.waiters.size();
  entry.waiters.clear();
}

/// Forgets the least recently used ones.
void RehearsalScheduler::make_room() {
  while (entries_.size() > options_.max_rehearsals) {
    auto oldest = entries_.end();
    for (auto entry = entries_.begin(); entry != entries_.end(); ++entry)
      if (!entry->second.is_working &&
          (oldest == entries_.end() || entry->second.last_used < oldest->second.last_used))
        oldest = entry;
    if (oldest == entries_.end())
      return;
    entries_.erase(oldest);
  }
}

void RehearsalScheduler::stop() {
  WaiterAnswers waiting;
  {
    const std::lock_guard lock(mutex_);
    is_stopping_ = true;
    for (auto& [id, entry] : entries_)
      let_go(entry, waiting);
  }
  stop_source_.request_stop();
  urgent_.notify_all();
  for (const auto& [done, known] : waiting)
    done(known);
  pool_.stop(runtime::WorkerPool::Leftovers::Abandon);
}

}  // namespace kinship::rehearsal
