#include "proto/dds/replier.hpp"

#include <atomic>
#include <exception>
#include <utility>

#include "proto/dds/loan.hpp"
#include "proto/dds/reply_line.hpp"

namespace kinship::dds {

/// One request under way.
template <typename Conversation>
class Answer<Conversation>::State {
 public:
  State(const std::shared_ptr<ReplyLine>& line, const codec::Head& head)
      : line_(line), head_(head) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (is_sent_)
      return;
    if (const auto line = line_.lock())
      line->end(head_);
  }

  const codec::Head& head() const noexcept { return head_; }

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
class Replier<Conversation>::Implementation {
 public:
  Implementation(const Participant& participant, WaitLoop& loop, Handler handler)
      : line_(std::make_shared<ReplyLine>(participant, Wire<Conversation>::topics())),
        handler_(std::move(handler)) {
    loop.attach(line_->reader(), [this] { take_requests(); });
  }

 private:
  using WireRequest = typename Wire<Conversation>::Request;

  void take_requests() {
    const Loan requests(line_->reader(), "requests of " + line_->name());
    for (std::size_t i = 0; i < requests.size(); ++i)
      if (requests[i])
        serve(*static_cast<const WireRequest*>(requests[i]));
  }

  void serve(const WireRequest& wire) {
    const codec::Head head = codec::head_of(wire);
    if (!line_->begin(head))
      return;
    const Answer<Conversation> answer(
        std::make_shared<typename Answer<Conversation>::State>(line_, head));
    try {
      handler_(codec::decode(wire).value_or_throw(), answer);
    } catch (const Failure& failure) {
      answer(Conversation::refuse(failure.error()));
    } catch (const std::exception& error) {
      answer(Conversation::refuse({ErrorCode::Internal, error.what()}));
    }
  }

  std::shared_ptr<ReplyLine> line_;  // shared for the moment in which an Answer sends
  Handler handler_;
};

template <typename Conversation>
Replier<Conversation>::Replier(const Participant& participant, WaitLoop& loop, Handler handler)
    : implementation_(std::make_unique<Implementation>(participant, loop, std::move(handler))) {}

template <typename Conversation>
Replier<Conversation>::~Replier() = default;

template class Answer<codec::RegisterConversation>;
template class Answer<codec::ReportConversation>;
template class Answer<codec::FetchConversation>;
template class Answer<codec::AdminConversation>;
template class Replier<codec::RegisterConversation>;
template class Replier<codec::ReportConversation>;
template class Replier<codec::FetchConversation>;
template class Replier<codec::AdminConversation>;

}  // namespace kinship::dds
