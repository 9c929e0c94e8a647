#include "client/link/follower.hpp"

#include <algorithm>
#include <condition_variable>
#include <exception>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "client/link/reported_placement.hpp"
#include "proto/codec/admin_codec.hpp"
#include "proto/codec/fetch_codec.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/publication.hpp"
#include "proto/dds/requester.hpp"

namespace kinship::link {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;
using DistributionPointer = std::shared_ptr<const Distribution>;
using ExperiencePointer = std::shared_ptr<const TaskExperience>;
using LibraryPointer = std::shared_ptr<const RecallLibrary>;

constexpr std::chrono::seconds kLease = 60s;
constexpr milliseconds kServerTime = 10s;  // for the server to make it; then it says "pending"
constexpr milliseconds kSlack = 2s;        // for its answer to come
constexpr int kPauseSteps = 20;            // first pause : longest pause

FetchRequest completed(FetchRequest request) {
  if (request.follow == 0s)
    request.follow = kLease;
  request.deadline = kServerTime;
  if (const auto error = codec::validate(request))
    throw Failure(*error);
  return request;
}

bool is_same(const DistributionPointer& a, const DistributionPointer& b) {
  if (!a || !b)
    return a == b;
  return a->revision == b->revision && a->store_epoch == b->store_epoch && a->id == b->id;
}

FollowStatus status_of(FetchStatus status) {
  switch (status) {
    case FetchStatus::Ready:
      return FollowStatus::Ready;
    case FetchStatus::Pending:
    case FetchStatus::Busy:
      return FollowStatus::Pending;
    case FetchStatus::NoExperience:
      return FollowStatus::NoExperience;
    case FetchStatus::UnknownRobot:
      return FollowStatus::UnknownRobot;
    case FetchStatus::Failed:
      return FollowStatus::Failed;
    default:
      return FollowStatus::Refused;
  }
}

/// A follower's step after an exchange with the server.
struct Step {
  Follower::State state;
  std::optional<DistributionPointer> newest;  ///< missing: the held one stays
  milliseconds pause{0};                      ///< until the next exchange, unless something happens
};

}  // namespace

class Follower::Implementation {
 public:
  Implementation(std::shared_ptr<const dds::Participant> participant, FetchRequest request,
                 const FollowOptions& options)
      : participant_(std::move(participant)),
        request_(completed(std::move(request))),
        options_(options),
        state_{FollowStatus::NoServer, "no server has answered yet (domain " +
                                           std::to_string(participant_->options().domain) + ", " +
                                           participant_->options().server + ")"},
        fetch_(*participant_, Uuid::random()),
        announcements_(*participant_,
                       {.on_sample = [this](const Announcement& news) { notice(news); },
                        .on_server = [this] { notice_server(); }}),
        placing_(options.asks_placement && !request_.T_task_base
                     ? std::make_shared<Placing>(*participant_, Uuid::random())
                     : nullptr),
        thread_([this] { run(); }) {}
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  bool is_forked() const { return process_.is_forked(); }

  ~Implementation() {
    {
      const std::lock_guard lock(mutex_);
      is_stopped_ = true;
    }
    changed_.notify_all();
    fetch_.cancel();
    if (const std::shared_ptr<Placing> placing = this->placing())
      placing->cancel();
    thread_.join();
  }

  DistributionPointer newest() const {
    const std::lock_guard lock(newest_mutex_);
    return newest_;
  }

  ExperiencePointer experience() const {
    const std::lock_guard lock(newest_mutex_);
    return experience_;
  }

  LibraryPointer recall() const {
    const std::lock_guard lock(newest_mutex_);
    return recall_;
  }

  std::optional<Eigen::Isometry3d> T_task_base() const {
    const std::lock_guard lock(newest_mutex_);
    return request_.T_task_base;
  }

  State state() const {
    const std::lock_guard lock(mutex_);
    return state_;
  }

  DistributionPointer wait_for_newer(const DistributionPointer& held,
                                     Clock::time_point deadline) const {
    std::unique_lock lock(mutex_);
    changed_.wait_until(lock, deadline, [&] {
      const DistributionPointer now = newest();
      return is_stopped_ || (now && !is_same(now, held));
    });
    return newest();
  }

 private:
  using Placing = dds::Requester<codec::AdminConversation>;

  /// On the thread of the subscriber. As long as nothing is held its id is not known: any
  /// distribution of this task and robot may be the one.
  void notice(const Announcement& news) {
    if (news.robot != request_.robot || news.task != request_.task)
      return;
    {
      const std::lock_guard lock(mutex_);
      news_.insert_or_assign(news.distribution_id, news);
    }
    changed_.notify_all();
  }

  /// On the thread of the subscriber. A fetch under way is sent to that server anyway.
  void notice_server() {
    {
      const std::lock_guard lock(mutex_);
      is_server_new_ = !is_asking_;
    }
    changed_.notify_all();
  }

  /// Whether an announcement is newer than the distribution held. Under mutex_.
  bool has_news() const {
    const DistributionPointer held = newest();
    if (!held)
      return !news_.empty();
    const auto found = news_.find(held->id);
    return found != news_.end() && (found->second.store_epoch != held->store_epoch ||
                                    found->second.revision > held->revision);
  }

  void run() {
    while (true) {
      {
        const std::lock_guard lock(mutex_);
        if (is_stopped_)
          return;
        if (is_server_new_)
          pause_ = 0ms;
        is_server_new_ = false;
        news_.clear();
        is_asking_ = true;
      }
      const Result<FetchReply> reply = ask();
      if (reply && reply->experience)
        hold(*reply->experience);
      if (reply && reply->recall)
        hold(*reply->recall);
      Step step = judge(reply);
      std::unique_lock lock(mutex_);
      is_asking_ = false;
      state_ = std::move(step.state);
      if (step.newest) {
        const std::lock_guard newest_lock(newest_mutex_);
        newest_.swap(*step.newest);  // the earlier one is freed outside of the lock
      }
      step.newest.reset();
      changed_.notify_all();
      changed_.wait_for(lock, step.pause,
                        [this] { return is_stopped_ || is_server_new_ || has_news(); });
    }
  }

  std::shared_ptr<Placing> placing() const {
    const std::lock_guard lock(mutex_);
    return placing_;
  }

  /// Asks until the robot has reported the task: its reports may still be on their way. What is
  /// held keeps its placement.
  /// \return why the server does not say it.
  std::optional<Error> find_placement() {
    const std::shared_ptr<Placing> placing = this->placing();
    if (!placing || newest())
      return std::nullopt;
    const auto reported = reported_placement(
        [&](const AdminRequest& request) {
          return placing->call(request, Clock::now() + kServerTime + kSlack);
        },
        request_.task, request_.robot.hex());
    if (!reported)
      return Error{reported.error().code,
                   "no T_task_base is given, and where the robot last reported the task is not "
                   "told: " +
                       reported.error().message};
    if (!reported->is_known)
      return std::nullopt;
    const std::scoped_lock lock(mutex_, newest_mutex_);
    request_.T_task_base = reported->T_task_base;
    request_.known_experience = request_.known_recall = 0;  // of another placement
    placing_.reset();
    return std::nullopt;
  }

  Result<FetchReply> ask() {
    try {
      if (auto error = find_placement())
        return *std::move(error);
      return fetch_.call(request_, Clock::now() + kServerTime + kSlack);
    } catch (const std::exception& error) {  // of Cyclone DDS: tried again
      return Error{ErrorCode::Internal, error.what()};
    }
  }

  void hold(const TaskExperience& experience) {
    request_.known_experience = experience.revision;
    ExperiencePointer held =
        experience.paths.empty() ? nullptr : std::make_shared<const TaskExperience>(experience);
    const std::lock_guard lock(newest_mutex_);
    experience_.swap(held);  // the earlier one is freed outside of the lock
  }

  void hold(const RecallLibrary& library) {
    request_.known_recall = library.revision;
    LibraryPointer held =
        library.paths.empty() ? nullptr : std::make_shared<const RecallLibrary>(library);
    const std::lock_guard lock(newest_mutex_);
    recall_.swap(held);  // the earlier one is freed outside of the lock
  }

  Step judge(const Result<FetchReply>& reply) {
    if (!reply) {
      const bool nobody = reply.error().code == ErrorCode::Unavailable;
      return {{nobody ? FollowStatus::NoServer : FollowStatus::Refused, reply.error().message},
              std::nullopt,
              nobody ? 0ms : longer_pause()};
    }
    Step step;
    step.state = {status_of(reply->status), reply->message};
    switch (reply->status) {
      case FetchStatus::Ready:
        pause_ = 0ms;
        step.state.reason = reply->distribution->reason;
        step.newest = std::make_shared<const Distribution>(*reply->distribution);
        step.pause = renewal();
        break;
      case FetchStatus::Pending:
        step.pause = kPendingPause;  // the server has waited already
        break;
      case FetchStatus::Busy:
        step.pause = std::clamp<milliseconds>(reply->retry_after, kPendingPause, renewal());
        break;
      case FetchStatus::NoExperience:
      case FetchStatus::Failed:
        if (reply->distribution)
          step.state.reason = reply->distribution->reason;
        step.newest = nullptr;
        step.pause = longer_pause();
        break;
      default:
        step.pause = longer_pause();
    }
    return step;
  }

  milliseconds renewal() const { return milliseconds(request_.follow) / 3; }

  /// Grows by half each time, so that a fleet without experience does not keep a server busy.
  milliseconds longer_pause() {
    const milliseconds shortest = options_.longest_pause / kPauseSteps;
    pause_ = std::clamp(pause_ * 3 / 2, shortest, std::max(shortest, options_.longest_pause));
    return std::min(pause_, renewal());
  }

  static constexpr milliseconds kPendingPause = 100ms;

  const dds::OwningProcess process_;
  const std::shared_ptr<const dds::Participant> participant_;
  FetchRequest request_;  // its placement changes under newest_mutex_; its knowledge of experience
                          // and library is of the thread alone
  const FollowOptions options_;
  milliseconds pause_{0};            // of the thread alone
  mutable std::mutex newest_mutex_;  // guards the three; taken last, held to copy one
  DistributionPointer newest_;       // shared with all callers
  ExperiencePointer experience_;     // the same
  LibraryPointer recall_;            // the same
  mutable std::mutex mutex_;         // guards what follows
  mutable std::condition_variable changed_;
  State state_;
  std::map<Digest, Announcement> news_;  // since the fetch before
  bool is_asking_ = false;
  bool is_server_new_ = false;
  bool is_stopped_ = false;
  dds::Requester<codec::FetchConversation> fetch_;
  dds::Subscriber<codec::AnnouncementPublication> announcements_;
  std::shared_ptr<Placing> placing_;  // under mutex_; shared with a call; null: not to be asked
  std::thread thread_;                // last: uses the others
};

Follower::Follower(std::shared_ptr<const dds::Participant> participant, FetchRequest request,
                   const FollowOptions& options)
    : implementation_(
          std::make_unique<Implementation>(std::move(participant), std::move(request), options)) {}

Follower::~Follower() {
  if (implementation_->is_forked())
    static_cast<void>(implementation_.release());  // its threads are not here
}

std::shared_ptr<const Distribution> Follower::newest() const { return implementation_->newest(); }

std::shared_ptr<const TaskExperience> Follower::experience() const {
  return implementation_->experience();
}

std::shared_ptr<const RecallLibrary> Follower::recall() const { return implementation_->recall(); }

std::optional<Eigen::Isometry3d> Follower::T_task_base() const {
  return implementation_->T_task_base();
}

Follower::State Follower::state() const { return implementation_->state(); }

std::shared_ptr<const Distribution> Follower::wait_for_newer(
    const std::shared_ptr<const Distribution>& held,
    std::chrono::steady_clock::time_point deadline) const {
  return implementation_->wait_for_newer(held, deadline);
}

}  // namespace kinship::link
