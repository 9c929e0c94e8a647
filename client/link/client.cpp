#include "client/link/client.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>
#include <thread>
#include <utility>

#include "client/link/delivery.hpp"
#include "client/link/outbox.hpp"
#include "client/link/report_sender.hpp"
#include "proto/dds/requester.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::link {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kReceiptTime = 5s;       // for a batch to be stored, and a robot
constexpr milliseconds kShortestPause = 100ms;  // between two requests of one fetch

/// What the server is given of the time that is left, so that its "pending" still arrives in time.
milliseconds server_share(milliseconds left) {
  return left - std::min<milliseconds>(200ms, left / 4);
}

}  // namespace

class Client::Implementation {
 public:
  explicit Implementation(const ClientOptions& options)
      : timeout_(options.timeout),
        participant_(std::make_shared<const dds::Participant>(
            dds::ParticipantOptions{.domain = options.domain, .server = options.server})),
        register_(*participant_, client_id_),
        report_(*participant_, client_id_),
        fetch_(*participant_, client_id_),
        admin_(*participant_, client_id_) {
    if (!options.has_outbox)
      return;
    outbox_.emplace(options.outbox.empty() ? default_outbox_folder(options.domain, options.server)
                                           : options.outbox);
    sender_.emplace(
        *outbox_,
        [this](const ReportRequest& batch) {
          return report_.call(batch, Clock::now() + kReceiptTime);
        },
        [this](const RobotDescription& description) {
          return register_.call(description, Clock::now() + kReceiptTime);
        });
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;

  ~Implementation() {
    cancel();
    report_.cancel();
  }

  void cancel() {
    register_.cancel();
    fetch_.cancel();
    admin_.cancel();
  }

  Result<RegisterReply> register_robot(const RobotDescription& description) {
    keep(description);
    Result<RegisterReply> reply = register_.call(description, Clock::now() + timeout_);
    if (sender_ && reply && reply->status != RegisterStatus::Refused)
      sender_->retry();
    return reply;
  }

  void report(const Attempt& attempt) {
    if (!outbox_)
      throw std::logic_error("Client: report() without an outbox");
    if (const auto error = find_fault(attempt))
      throw Failure(*error);
    outbox_->add(attempt);
    sender_->wake();
  }

  OutboxState outbox() const {
    if (!outbox_)
      return {};
    ReportSender::Counts counts = sender_->counts();
    return {outbox_->pending_count(), counts.accepted, counts.refused, std::move(counts.problem)};
  }

  OutboxState flush(milliseconds deadline) {
    if (sender_) {
      sender_->wake();
      sender_->wait_until_empty(Clock::now() + deadline);
    }
    return outbox();
  }

  Result<FetchReply> fetch(FetchRequest request) {
    if (request.deadline <= 0ms)
      return fetch_.call(request, Clock::now() + timeout_);
    const Clock::time_point deadline = Clock::now() + request.deadline;
    std::optional<Result<FetchReply>> last;
    while (true) {
      const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now());
      request.deadline = server_share(std::max(left, milliseconds(1)));
      Result<FetchReply> reply = fetch_.call(request, deadline);
      // No answer this time does not undo the answer of last time.
      const bool is_worse = !reply && reply.error().code == ErrorCode::Unavailable && last;
      if (!is_worse)
        last.emplace(std::move(reply));
      const std::optional<milliseconds> pause = is_worse ? std::nullopt : pause_after(*last);
      if (!pause || Clock::now() + *pause >= deadline)
        return *std::move(last);
      std::this_thread::sleep_for(*pause);
    }
  }

  Result<AdminReply> admin(const AdminRequest& request) {
    return admin_.call(request, Clock::now() + timeout_ + request.deadline);
  }

  std::unique_ptr<Follower> follow(const FetchRequest& request,
                                   const FollowOptions& options) const {
    return std::make_unique<Follower>(participant_, request, options);
  }

  std::unique_ptr<Watcher> watch(Watcher::Handlers handlers) const {
    return std::make_unique<Watcher>(participant_, std::move(handlers));
  }

  Result<std::vector<Receipt>> deliver(std::vector<Attempt> attempts) {
    return link::deliver(std::move(attempts), timeout_,
                         [this](const ReportRequest& batch, Clock::time_point deadline) {
                           return report_.call(batch, deadline);
                         });
  }

 private:
  void keep(const RobotDescription& description) {
    if (!outbox_)
      return;
    // One that cannot be read has no reports; the server says what is wrong with it.
    if (const auto chain = kinematics::read_chain(description))
      outbox_->keep_robot(chain->digest(), description);
  }

  /// How long to wait before asking again; empty: the reply is final.
  static std::optional<milliseconds> pause_after(const Result<FetchReply>& reply) {
    if (!reply)
      return std::nullopt;
    if (reply->status == FetchStatus::Busy)
      return std::max(reply->retry_after, kShortestPause);
    if (reply->status == FetchStatus::Pending)
      return kShortestPause;
    return std::nullopt;
  }

  milliseconds timeout_;
  Uuid client_id_ = Uuid::random();
  std::optional<Outbox> outbox_;
  const std::shared_ptr<const dds::Participant> participant_;  // with followers and watchers
  dds::Requester<codec::RegisterConversation> register_;
  dds::Requester<codec::ReportConversation> report_;
  dds::Requester<codec::FetchConversation> fetch_;
  dds::Requester<codec::AdminConversation> admin_;
  std::optional<ReportSender> sender_;  // last: uses the outbox and requesters
};

Client::Client(const ClientOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

Client::~Client() = default;

Result<RegisterReply> Client::register_robot(const RobotDescription& description) {
  return implementation_->register_robot(description);
}

void Client::report(const Attempt& attempt) { implementation_->report(attempt); }

Client::OutboxState Client::outbox() const { return implementation_->outbox(); }

Client::OutboxState Client::flush(std::chrono::milliseconds deadline) {
  return implementation_->flush(deadline);
}

Result<FetchReply> Client::fetch(const FetchRequest& request) {
  return implementation_->fetch(request);
}

std::unique_ptr<Follower> Client::follow(const FetchRequest& request,
                                         const FollowOptions& options) const {
  return implementation_->follow(request, options);
}

std::unique_ptr<Watcher> Client::watch(Watcher::Handlers handlers) const {
  return implementation_->watch(std::move(handlers));
}

Result<std::vector<Receipt>> Client::deliver(std::vector<Attempt> attempts) {
  return implementation_->deliver(std::move(attempts));
}

Result<AdminReply> Client::admin(const AdminRequest& request) {
  return implementation_->admin(request);
}

void Client::cancel() { implementation_->cancel(); }

}  // namespace kinship::link
