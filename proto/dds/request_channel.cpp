#include "proto/dds/request_channel.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "proto/dds/loan.hpp"
#include "proto/dds/qos.hpp"

namespace kinship::dds {
namespace {

/// Times between sends: 100 ms, 300 ms, then every second.
std::chrono::milliseconds delay_after(int sends) {
  using std::chrono::milliseconds;
  return sends == 1 ? milliseconds(100) : sends == 2 ? milliseconds(300) : milliseconds(1000);
}

}  // namespace

RequestChannel::Waiter::Waiter(const RequestChannel& line)
    : guard(dds_create_guardcondition(line.participant_), "guard condition"),
      waitset(dds_create_waitset(line.participant_), "waitset") {
  for (const Handle entity :
       {guard.get(), line.condition_.get(), line.writer_.get(), line.reader_.get()})
    require(dds_waitset_attach(waitset.get(), entity, 0), "waitset");
}

RequestChannel::RequestChannel(const Participant& participant, const Uuid& client_id,
                               const Topics& topics)
    : participant_(participant.get()),
      waits_for_replies_(participant.credentials().has_value()),
      client_id_(client_id),
      name_(topics.name),
      request_topic_(dds_create_topic(participant_, &topics.request, topics.request_topic().c_str(),
                                      nullptr, nullptr),
                     "topic " + topics.request_topic()),
      reply_topic_(dds_create_topic(participant_, &topics.reply, topics.reply_topic().c_str(),
                                    nullptr, nullptr),
                   "topic " + topics.reply_topic()),
      subscriber_(
          dds_create_subscriber(participant_,
                                partition_qos(participant.credentials()
                                                  ? client_partition(participant)
                                                  : reply_partition(reply_partition_of(client_id)))
                                    .get(),
                                nullptr),
          "subscriber"),
      reader_(dds_create_reader(subscriber_.get(), reply_topic_.get(), reply_qos().get(), nullptr),
              "reader " + topics.reply_topic()),
      condition_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "read condition"),
      publisher_(dds_create_publisher(participant_,
                                      participant.credentials()
                                          ? partition_qos(client_partition(participant)).get()
                                          : nullptr,
                                      nullptr),
                 "publisher"),
      writer_(
          dds_create_writer(publisher_.get(), request_topic_.get(), request_qos().get(), nullptr),
          "writer " + topics.request_topic()) {
  require(dds_set_status_mask(writer_.get(), DDS_PUBLICATION_MATCHED_STATUS), "status mask");
  require(dds_set_status_mask(reader_.get(), DDS_SUBSCRIPTION_MATCHED_STATUS), "status mask");
}

RequestChannel::Outcome RequestChannel::call(const codec::Head& head, const void* request,
                                             Clock::time_point deadline,
                                             const std::function<void(const void*)>& on_reply) {
  std::unique_ptr<Waiter> waiter = acquire_waiter();
  Call call{on_reply, *waiter};
  {
    const std::lock_guard lock(mutex_);
    calls_.emplace(head.sequence_number, &call);
  }
  const auto leave = [&] {
    const std::lock_guard lock(mutex_);
    calls_.erase(head.sequence_number);
  };
  try {
    const Outcome outcome = wait_for_reply(call, request, deadline);
    leave();
    release_waiter(std::move(waiter));
    return outcome;
  } catch (...) {
    leave();
    throw;
  }
}

RequestChannel::Outcome RequestChannel::wait_for_reply(const Call& call, const void* request,
                                                       Clock::time_point deadline) {
  int sends = 0;
  bool has_waited = false;  // anything there before that ends the first wait
  std::uint64_t servers_seen = servers_seen_;
  Clock::time_point next_send = Clock::now();
  while (true) {
    const bool has_server = notice_servers();
    if (has_waited)
      hand_out_replies(call);
    {
      const std::lock_guard lock(mutex_);
      if (call.is_answered)
        return Outcome::Answered;
    }
    if (is_cancelled_)
      return Outcome::Cancelled;
    const Clock::time_point now = Clock::now();
    if (now >= deadline)
      return Outcome::TimedOut;
    if (const std::uint64_t seen = servers_seen_; seen != servers_seen) {
      servers_seen = seen;
      sends = 0;
      next_send = now;
    }
    if (now >= next_send) {
      // Without a server the sample would be lost; its appearance ends the wait below. A time-out
      // of the writer means that the sample was not sent: it is, next time.
      if (has_server && dds_write(writer_.get(), request) == DDS_RETCODE_OK)
        sends++;
      next_send = Clock::now() + delay_after(std::max(sends, 1));
    }
    wait(call.waiter, std::min(deadline, next_send));
    has_waited = true;
  }
}

void RequestChannel::wait(const Waiter& waiter, Clock::time_point until) const {
  std::array<dds_attach_t, 4> ready{};
  const auto time = std::chrono::nanoseconds(until - Clock::now());
  require(dds_waitset_wait(waiter.waitset.get(), ready.data(), ready.size(),
                           std::max<dds_duration_t>(time.count(), 0)),
          "waitset");
  bool ignored = false;
  require(dds_take_guardcondition(waiter.guard.get(), &ignored), "guard condition");
}

void RequestChannel::hand_out_replies(const Call& own) {
  std::vector<Handle> others;
  while (true) {
    const Loan replies(reader_, "replies of " + name_);
    if (replies.size() == 0)
      break;
    const std::lock_guard lock(mutex_);
    for (std::size_t i = 0; i < replies.size(); ++i) {
      if (!replies[i])
        continue;
      const codec::Head head = head_of(replies[i]);
      if (head.client_id != client_id_)
        continue;  // of the same partition
      const auto call = calls_.find(head.sequence_number);
      if (call == calls_.end() || call->second->is_answered)
        continue;
      call->second->on_reply(replies[i]);
      call->second->is_answered = true;
      if (call->second != &own)
        others.push_back(call->second->waiter.guard.get());
    }
    if (replies.size() < Loan::kMaxSamples)
      break;
  }
  for (const Handle guard : others)
    dds_set_guardcondition(guard, true);
}

bool RequestChannel::notice_servers() {
  dds_publication_matched_status_t status{};
  require(dds_get_publication_matched_status(writer_.get(), &status), "writer " + name_);
  if (status.current_count_change != 0 || status.total_count_change != 0) {
    if (status.total_count_change > 0) {
      ++servers_seen_;
      // Sends a heartbeat. Cyclone DDS drops samples of a writer of which it had none, and asks for
      // them again, in vain if that comes before their write has returned.
      dds_assert_liveliness(writer_.get());
    }
    wake_all();  // reading the status took it from the other callers
  }
  dds_subscription_matched_status_t replies{};
  require(dds_get_subscription_matched_status(reader_.get(), &replies), "reader " + name_);
  if (replies.current_count_change != 0 || replies.total_count_change != 0)
    wake_all();
  // With security a writer of replies comes some time after the reader of requests.
  return status.current_count > 0 && (!waits_for_replies_ || replies.current_count > 0);
}

std::uint64_t RequestChannel::count_servers() {
  notice_servers();
  return servers_seen_;
}

bool RequestChannel::has_server() const {
  return dds_get_matched_subscriptions(writer_.get(), nullptr, 0) > 0;
}

void RequestChannel::wake_all() {
  std::vector<Handle> guards;
  {
    const std::lock_guard lock(mutex_);
    for (const auto& [sequence_number, call] : calls_)
      guards.push_back(call->waiter.guard.get());
  }
  for (const Handle guard : guards)
    dds_set_guardcondition(guard, true);
}

void RequestChannel::cancel() {
  is_cancelled_ = true;
  wake_all();
}

std::unique_ptr<RequestChannel::Waiter> RequestChannel::acquire_waiter() {
  {
    const std::lock_guard lock(mutex_);
    if (!idle_waiters_.empty()) {
      auto waiter = std::move(idle_waiters_.back());
      idle_waiters_.pop_back();
      return waiter;
    }
  }
  return std::make_unique<Waiter>(*this);
}

void RequestChannel::release_waiter(std::unique_ptr<Waiter> waiter) {
  const std::lock_guard lock(mutex_);
  idle_waiters_.push_back(std::move(waiter));
}

}  // namespace kinship::dds
