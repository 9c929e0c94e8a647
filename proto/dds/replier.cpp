#include "proto/dds/replier.hpp"

#include <atomic>
#include <chrono>
#include <exception>
#include <string>
#include <utility>

#include "proto/dds/fair_queue.hpp"
#include "proto/dds/loan.hpp"
#include "proto/dds/reply_channel.hpp"
#include "proto/dds/reply_rate_limit.hpp"

namespace kinship::dds {

/// One request under way.
template <typename Conversation>
class Answer<Conversation>::State {
 public:
  State(const std::shared_ptr<ReplyChannel>& line, ReplyChannel::Place place, Caller caller)
      : line_(line), place_(std::move(place)), caller_(std::move(caller)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (is_sent_)
      return;
    if (const auto line = line_.lock())
      line->end(place_);
  }

  const codec::Head& head() const noexcept { return place_.head; }
  const Caller& caller() const noexcept { return caller_; }

  void send(const typename Conversation::Reply& reply) {
    if (is_sent_.exchange(true))
      return;
    const auto line = line_.lock();
    if (!line)
      return;
    auto message = codec::encode(place_.head, reply);
    if (!message)
      message = codec::encode(place_.head, Conversation::refuse(message.error()));
    if (message)
      line->send(place_, &message->wire);
    line->end(place_);
  }

 private:
  std::weak_ptr<ReplyChannel> line_;
  ReplyChannel::Place place_;
  Caller caller_;
  std::atomic<bool> is_sent_ = false;
};

template <typename Conversation>
void Answer<Conversation>::operator()(const typename Conversation::Reply& reply) const noexcept {
  try {
    state_->send(reply);
  } catch (const std::exception&) {  // out of memory: the client asks again
  }
}

template <typename Conversation>
const codec::Head& Answer<Conversation>::head() const noexcept {
  return state_->head();
}

template <typename Conversation>
const Caller& Answer<Conversation>::caller() const noexcept {
  return state_->caller();
}

template <typename Conversation>
class Replier<Conversation>::Implementation {
 public:
  Implementation(const Participant& participant, WaitLoop& loop, Handler handler, Gate gate)
      : line_(std::make_shared<ReplyChannel>(participant, loop, Wire<Conversation>::topics())),
        has_security_(participant.credentials().has_value()),
        directory_(participant.options().directory),
        handler_(std::move(handler)),
        gate_(std::move(gate)) {
    loop.attach(
        line_->reader(), [this] { return serve_some(); }, &line_->hearer_came());
  }

  std::size_t clients() const { return line_->clients(); }

 private:
  using WireRequest = typename Wire<Conversation>::Request;
  using Decoded = Result<typename Conversation::Request>;
  struct Waiting {
    Sender sender;
    Decoded request;
  };

  using Queue = FairQueue<Waiting>;

  /// \return when the next waiting request may be served.
  typename Queue::Time serve_some() {
    constexpr int kInTurn = 4;  // then the other conversations
    if (waiting_.holds_some())
      waiting_.release_if([this](const codec::Head& head, const Waiting& each) {
        return line_->reaches(each.sender, head);
      });
    for (int served = 0; served < kInTurn; ++served) {
      take_requests();
      auto next = waiting_.pop(waiting_.holds_some() ? WaitLoop::Clock::now() : Queue::kNever);
      if (!next)
        break;
      serve(next->first, std::move(next->second));
    }
    return waiting_.next();
  }

  /// All requests of the reader, before each one that is served: it keeps the newest of all
  /// clients, so that many of one client would push out the others'.
  void take_requests() {
    constexpr int kMaxLoans = 2 * kHeldShortRequests / static_cast<int>(Loan::kMaxSamples);
    for (int i = 0; i < kMaxLoans; ++i) {
      const Loan requests(line_->reader(), what_);
      for (std::size_t j = 0; j < requests.size(); ++j)
        if (requests[j])
          take(*static_cast<const WireRequest*>(requests[j]), requests.writer(j));
      if (requests.size() < Loan::kMaxSamples)
        return;
    }
  }

  void take(const WireRequest& wire, std::uint64_t writer) {
    const codec::Head head = codec::head_of(wire);
    Sender unknown{.client = {}, .hearing = Hearing::Awaited};
    Sender* sender = line_->sender(writer);
    if (!sender && has_security_)
      return;  // gone, and its name is lost
    if (!sender) {
      unknown.client = head.client_id.text();
      sender = &unknown;
    }
    const auto opening = waiting_.opening_for(sender->client, head);
    if (!opening)
      return waiting_.release(sender->client, head);
    // A request sent again costs its client nothing, and a refused one pushes no other out. A
    // client that may not ask at all is refused in its turn, and its request is not decoded.
    const ReplyChannel::Place place{sender->name, head};
    if (line_->is_being_answered(place))
      return;
    const Result<Caller> caller = caller_of(*sender);
    if (caller ? is_refused(place, *caller, wire)
               : !refusals_.take(sender->client, ReplyRateLimit::Clock::now()))
      return;
    const auto held_until = hold(*sender, head);
    waiting_.push(*opening, {*sender, caller ? decoded(wire) : Decoded(caller.error())},
                  held_until);
  }

  /// A reply to a client without a known reader would be lost. A client whose reader is no part of
  /// its own participant is held up once, not with each request.
  typename Queue::Time hold(Sender& sender, const codec::Head& head) const {
    if (sender.hearing != Hearing::Unknown)
      return Queue::kNow;
    const bool is_heard = line_->reaches(sender, head);
    sender.hearing = is_heard ? Hearing::Heard : Hearing::Awaited;
    return is_heard ? Queue::kNow : WaitLoop::Clock::now() + kMaxHold;
  }

  /// \return why the sender is refused if it is.
  Result<Caller> caller_of(const Sender& sender) const {
    if (!has_security_)
      return Caller{.client = sender.client,
                    .role = AccessRole::Admin,
                    .is_local = sender.is_local,
                    .address = sender.address,
                    .host = sender.host,
                    .program = sender.program};
    if (!directory_)
      return Error{ErrorCode::Internal, "the server knows no clients"};
    Result<Caller> caller = directory_(sender.name);
    if (!caller)
      return caller;
    Caller known = *std::move(caller);
    known.is_local = sender.is_local;
    known.address = sender.address;
    return known;
  }

  /// Whether the gate keeps a request out, which is answered then.
  bool is_refused(const ReplyChannel::Place& place, const Caller& caller,
                  const WireRequest& wire) const {
    if (!gate_)
      return false;
    const auto reply = gate_(caller, codec::size_of(wire));
    if (!reply)
      return false;
    if (const auto message = codec::encode(place.head, *reply))
      line_->send(place, &message->wire);
    return true;
  }

  /// An exception of decoding (no memory) concerns that request alone.
  static Decoded decoded(const WireRequest& wire) {
    try {
      return codec::decode(wire);
    } catch (const std::exception& error) {
      return Error{ErrorCode::Internal, error.what()};
    }
  }

  void serve(const codec::Head& head, Waiting waiting) {
    const ReplyChannel::Place place{waiting.sender.name, head};
    if (!line_->begin(place))
      return;
    const Result<Caller> caller = caller_of(waiting.sender);
    const Answer<Conversation> answer(std::make_shared<typename Answer<Conversation>::State>(
        line_, place, caller ? *caller : Caller{.client = waiting.sender.client}));
    try {
      if (!caller)
        return answer(Conversation::refuse(caller.error()));
      handler_(std::move(waiting.request).value_or_throw(), answer);
    } catch (const Failure& failure) {
      answer(Conversation::refuse(failure.error()));
    } catch (const std::exception& error) {
      answer(Conversation::refuse({ErrorCode::Internal, error.what()}));
    }
  }

  static constexpr std::size_t kWaitingRequests = 256;
  static constexpr std::chrono::milliseconds kMaxHold{100};  // then it is sent again

  std::shared_ptr<ReplyChannel> line_;  // shared for the moment in which an Answer sends
  const std::string what_ = "requests of " + line_->name();
  const bool has_security_;
  const Directory directory_;
  Handler handler_;
  Gate gate_;
  Queue waiting_{kWaitingRequests};
  /// A client with an old certificate cannot cause unlimited work.
  ReplyRateLimit refusals_{10};
};

template <typename Conversation>
Replier<Conversation>::Replier(const Participant& participant, WaitLoop& loop, Handler handler,
                               Gate gate)
    : implementation_(std::make_unique<Implementation>(participant, loop, std::move(handler),
                                                       std::move(gate))) {}

template <typename Conversation>
Replier<Conversation>::~Replier() = default;

template <typename Conversation>
std::size_t Replier<Conversation>::clients() const {
  return implementation_->clients();
}

template class Answer<codec::RegisterConversation>;
template class Answer<codec::ReportConversation>;
template class Answer<codec::FetchConversation>;
template class Answer<codec::AdminConversation>;
template class Replier<codec::RegisterConversation>;
template class Replier<codec::ReportConversation>;
template class Replier<codec::FetchConversation>;
template class Replier<codec::AdminConversation>;

}  // namespace kinship::dds
