#include "proto/dds/replier.hpp"

#include <atomic>
#include <exception>
#include <string>
#include <utility>

#include "proto/dds/fair_queue.hpp"
#include "proto/dds/loan.hpp"
#include "proto/dds/reply_line.hpp"

namespace kinship::dds {

/// One request under way.
template <typename Conversation>
class Answer<Conversation>::State {
 public:
  State(const std::shared_ptr<ReplyLine>& line, const codec::Head& head, Caller caller)
      : line_(line), head_(head), caller_(std::move(caller)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (is_sent_)
      return;
    if (const auto line = line_.lock())
      line->end(head_);
  }

  const codec::Head& head() const noexcept { return head_; }
  const Caller& caller() const noexcept { return caller_; }

  void send(const typename Conversation::Reply& reply) {
    if (is_sent_.exchange(true))
      return;
    const auto line = line_.lock();
    if (!line)
      return;
    auto message = codec::encode(head_, reply);
    if (!message)
      message = codec::encode(head_, Conversation::refuse(message.error()));
    if (message)
      line->send(head_, &message->wire);
    line->end(head_);
  }

 private:
  std::weak_ptr<ReplyLine> line_;
  codec::Head head_;
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
      : line_(std::make_shared<ReplyLine>(participant, Wire<Conversation>::topics())),
        handler_(std::move(handler)),
        gate_(std::move(gate)) {
    loop.attach(line_->reader(), [this] { return serve_some(); });
  }

  std::size_t clients() const { return line_->clients(); }

 private:
  using WireRequest = typename Wire<Conversation>::Request;
  using Decoded = Result<typename Conversation::Request>;

  /// \return whether more waits.
  bool serve_some() {
    constexpr int kInTurn = 4;  // then the other conversations
    for (int served = 0; served < kInTurn; ++served) {
      take_requests();
      auto next = waiting_.pop();
      if (!next)
        return false;
      serve(next->first, std::move(next->second));
    }
    return waiting_.size() > 0;
  }

  /// All that the reader holds, before each one that is served: it keeps the newest, whose ever
  /// they are, so that of many of one client the others' would be pushed out.
  void take_requests() {
    constexpr int kMaxLoans = 2 * kHeldShortRequests / static_cast<int>(Loan::kMaxSamples);
    for (int i = 0; i < kMaxLoans; ++i) {
      const Loan requests(line_->reader(), what_);
      for (std::size_t j = 0; j < requests.size(); ++j)
        if (requests[j])
          take(*static_cast<const WireRequest*>(requests[j]));
      if (requests.size() < Loan::kMaxSamples)
        return;
    }
  }

  void take(const WireRequest& wire) {
    const codec::Head head = codec::head_of(wire);
    // What is sent again costs its client nothing, and one that is refused pushes nobody out.
    if (line_->is_being_answered(head) || waiting_.has(head) || is_refused(head, wire))
      return;
    if (waiting_.admit(head))
      waiting_.push(head, decoded(wire));
  }

  static Caller caller_of(const codec::Head& head) { return {.client = head.client_id.text()}; }

  /// Whether the gate keeps a request out, which is answered then.
  bool is_refused(const codec::Head& head, const WireRequest& wire) const {
    if (!gate_)
      return false;
    const auto reply = gate_(caller_of(head), codec::size_of(wire));
    if (!reply)
      return false;
    if (const auto message = codec::encode(head, *reply))
      line_->send(head, &message->wire);
    return true;
  }

  /// What decoding throws (no memory) is that request's own.
  static Decoded decoded(const WireRequest& wire) {
    try {
      return codec::decode(wire);
    } catch (const std::exception& error) {
      return Error{ErrorCode::Internal, error.what()};
    }
  }

  void serve(const codec::Head& head, Decoded request) {
    if (!line_->begin(head))
      return;
    const Answer<Conversation> answer(
        std::make_shared<typename Answer<Conversation>::State>(line_, head, caller_of(head)));
    try {
      handler_(std::move(request).value_or_throw(), answer);
    } catch (const Failure& failure) {
      answer(Conversation::refuse(failure.error()));
    } catch (const std::exception& error) {
      answer(Conversation::refuse({ErrorCode::Internal, error.what()}));
    }
  }

  static constexpr std::size_t kWaitingRequests = 256;

  std::shared_ptr<ReplyLine> line_;  // shared for the moment in which an Answer sends
  const std::string what_ = "requests of " + line_->name();
  Handler handler_;
  Gate gate_;
  FairQueue<Decoded> waiting_{kWaitingRequests};
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
