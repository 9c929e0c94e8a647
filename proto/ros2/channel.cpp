#include "proto/ros2/channel.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cstring>
#include <exception>
#include <set>
#include <utility>

#include "proto/dds/fair_queue.hpp"
#include "proto/dds/loan.hpp"
#include "proto/dds/matched_readers.hpp"
#include "proto/dds/matched_writers.hpp"
#include "proto/ros2/answer_turns.hpp"
#include "proto/ros2/outlet.hpp"

namespace kinship::ros2 {
namespace {

constexpr int kHeldQuestions = 256;  ///< by the reader, until they are taken
constexpr int kKeptAnswers = 256;    ///< for a reader that is slow
constexpr std::size_t kWaitingQuestions = 256;
constexpr std::chrono::milliseconds kBetweenAnswers{10};  ///< at the rate of a node
constexpr std::chrono::milliseconds kMaxHold{100};        ///< then its node sends it again

/// Of a sample, as the head that queues know.
codec::Head head_of(const void* sample) {
  codec::Head head;
  static_assert(sizeof head.client_id.bytes == wire::kKeyBytes);
  std::memcpy(head.client_id.bytes.data(), sample, wire::kKeyBytes);
  return head;
}

using Place = AnswerTurns::Place;
using Answer = AnswerTurns::Answer;

/// Answers leave here, from any thread.
class AnswerLine {
 public:
  using Clock = dds::WaitLoop::Clock;

  AnswerLine(const dds::Participant& participant, const ChannelTopics& topics)
      : topic_(make_topic(participant, topics.answer_type, topics.answer)),
        publisher_(dds_create_publisher(participant.get(), nullptr, nullptr), "publisher"),
        readers_(participant),
        is_asked_again_(topics.is_asked_again),
        writer_(readers_.make_writer(publisher_, topic_.get(),
                                     node_qos(Durability::Volatile, kKeptAnswers).get(),
                                     "writer " + topics.answer)) {}

  const dds::MatchedReaders& readers() const noexcept { return readers_; }
  bool reaches(std::uint64_t participant) const { return readers_.has(writer_, participant); }
  bool begin(const Place& place) { return turns_.begin(place); }
  void end(const Place& place) { turns_.end(place); }

  /// \throws std::bad_alloc  the question has ended.
  void send(const Place& place, Answer answer) {
    switch (take_turn(place, answer)) {
      case AnswerTurns::Turn::Now:
        dds_write(writer_.get(), answer.sample.get());
        return;
      case AnswerTurns::Turn::Later:
        dds_set_guardcondition(readers_.guard().get(), true);  // has send_held() called
        return;
      case AnswerTurns::Turn::Never:
        return;
    }
  }

  /// On the loop's thread.
  /// \return when to call it again.
  Clock::time_point send_held() {
    if (const std::uint64_t departures = readers_.departures(); departures != departures_) {
      departures_ = departures;
      turns_.drop_if([this](std::uint64_t participant) { return !reaches(participant); });
    }
    const auto now = Clock::now();
    for (const auto& sample : turns_.due(now))
      dds_write(writer_.get(), sample.get());
    return turns_.holds_some() ? now + kBetweenAnswers : dds::WaitLoop::kWithSamples;
  }

 private:
  AnswerTurns::Turn take_turn(const Place& place, Answer& answer) {
    if (is_asked_again_) {
      answer.may_wait = answer.may_wait && reaches(answer.participant);
      return turns_.take(place, answer, Clock::now());
    }
    turns_.end(place);
    return AnswerTurns::Turn::Now;
  }

  dds::Entity topic_;
  dds::Entity publisher_;
  dds::MatchedReaders readers_;
  const bool is_asked_again_;
  dds::Entity writer_;
  AnswerTurns turns_;
  std::uint64_t departures_ = 0;  // known to turns_
};

}  // namespace

class Question::State {
 public:
  State(const std::shared_ptr<AnswerLine>& line, Place place, std::uint64_t participant,
        Caller caller)
      : line_(line),
        place_(std::move(place)),
        participant_(participant),
        caller_(std::move(caller)) {}
  State(const State&) = delete;
  State& operator=(const State&) = delete;
  ~State() {
    if (is_sent_)
      return;
    if (const auto line = line_.lock())
      line->end(place_);
  }

  const Caller& caller() const noexcept { return caller_; }
  std::string key() const { return caller_.client + ' ' + place_.second.client_id.text(); }

  void send(std::shared_ptr<void> sample, std::size_t bytes, bool may_wait) {
    if (is_sent_.exchange(true))
      return;
    std::memcpy(sample.get(), place_.second.client_id.bytes.data(), wire::kKeyBytes);
    if (const auto line = line_.lock())
      line->send(place_, {std::move(sample), bytes, participant_, may_wait});
  }

 private:
  std::weak_ptr<AnswerLine> line_;
  Place place_;
  std::uint64_t participant_;
  Caller caller_;
  std::atomic<bool> is_sent_ = false;
};

const Caller& Question::caller() const noexcept { return state_->caller(); }
std::string Question::key() const { return state_->key(); }
void Question::send(std::shared_ptr<void> sample, std::size_t bytes, bool may_wait) const {
  state_->send(std::move(sample), bytes, may_wait);
}

class Channel::Implementation {
 public:
  Implementation(const dds::Participant& participant, dds::WaitLoop& loop,
                 const ChannelTopics& topics, Reading reading)
      : what_("questions of " + topics.question),
        topic_(make_topic(participant, topics.question_type, topics.question)),
        reader_(dds_create_reader(participant.get(), topic_.get(),
                                  node_qos(Durability::Volatile, kHeldQuestions).get(), nullptr),
                "reader " + topics.question),
        senders_(participant),
        line_(std::make_shared<AnswerLine>(participant, topics)),
        reading_(std::move(reading)) {
    loop.attach(
        reader_, [this] { return serve_some(); }, &line_->readers().guard());
  }

  std::optional<std::set<std::string>> nodes() { return senders_.clients(reader_); }

 private:
  struct Waiting {
    dds::Sender sender;
    Answering answering;
  };
  using Queue = dds::FairQueue<Waiting>;

  /// \return when the next waiting question may be served, or the next held answer sent.
  Queue::Time serve_some() {
    constexpr int kInTurn = 4;  // then the other channels
    if (waiting_.holds_some())
      waiting_.release_if([this](const codec::Head& /*head*/, const Waiting& each) {
        return line_->reaches(each.sender.participant);
      });
    for (int served = 0; served < kInTurn; ++served) {
      take_questions();
      auto next = waiting_.pop(waiting_.holds_some() ? dds::WaitLoop::Clock::now() : Queue::kNever);
      if (!next)
        break;
      serve(next->second.answering);
    }
    return std::min(waiting_.next(), line_->send_held());
  }

  /// All that the reader holds, before each one that is served: it keeps the newest of all nodes.
  void take_questions() {
    constexpr int kMaxLoans = 2 * kHeldQuestions / static_cast<int>(dds::Loan::kMaxSamples);
    for (int i = 0; i < kMaxLoans; ++i) {
      const dds::Loan questions(reader_, what_);
      for (std::size_t j = 0; j < questions.size(); ++j)
        if (questions[j])
          take(questions[j], questions.writer(j));
      if (questions.size() < dds::Loan::kMaxSamples)
        return;
    }
  }

  void take(const void* sample, std::uint64_t writer) {
    if (const std::uint64_t departures = line_->readers().departures(); departures != departures_) {
      departures_ = departures;
      senders_.forget_heard();
    }
    dds::Sender* const known = senders_.find(reader_, writer);
    if (!known)
      return;  // its node is gone
    const codec::Head head = head_of(sample);
    const auto opening = waiting_.opening_for(known->client, head);
    if (!opening)
      return waiting_.release(known->client, head);
    const Place place{known->client, head};
    if (!line_->begin(place))
      return;
    const Question question(std::make_shared<Question::State>(line_, place, known->participant,
                                                              Caller{.client = known->client,
                                                                     .role = AccessRole::Admin,
                                                                     .is_local = known->is_local,
                                                                     .address = known->address}));
    Answering answering = read(sample, question);
    if (!answering)
      return;
    const auto held_until = hold(*known);
    waiting_.push(*opening, {*known, std::move(answering)}, held_until);
  }

  /// An exception of reading (no memory) concerns that question alone: it is sent again.
  Answering read(const void* sample, const Question& question) const {
    try {
      return reading_(sample, question);
    } catch (const std::exception&) {
      return {};
    }
  }

  static void serve(const Answering& answering) {
    try {
      answering();
    } catch (const std::exception&) {  // as above
    }
  }

  Queue::Time hold(dds::Sender& sender) const {
    if (sender.hearing != dds::Hearing::Unknown)
      return Queue::kNow;
    const bool is_heard = line_->reaches(sender.participant);
    sender.hearing = is_heard ? dds::Hearing::Heard : dds::Hearing::Awaited;
    return is_heard ? Queue::kNow : dds::WaitLoop::Clock::now() + kMaxHold;
  }

  const std::string what_;
  dds::Entity topic_;
  dds::Entity reader_;
  dds::MatchedWriters senders_;
  std::uint64_t departures_ = 0;      // known to senders_
  std::shared_ptr<AnswerLine> line_;  // shared for the moment in which an answer is sent
  Reading reading_;
  Queue waiting_{kWaitingQuestions};
};

Channel::Channel(const dds::Participant& participant, dds::WaitLoop& loop,
                 const ChannelTopics& topics, Reading reading)
    : implementation_(
          std::make_unique<Implementation>(participant, loop, topics, std::move(reading))) {}

Channel::~Channel() = default;

std::optional<std::set<std::string>> Channel::nodes() const { return implementation_->nodes(); }

}  // namespace kinship::ros2
