#include "proto/dds/reply_channel.hpp"

#include <dds/dds.h>

#include <exception>

#include "proto/dds/qos.hpp"

namespace kinship::dds {

ReplyChannel::ReplyChannel(const Participant& participant, WaitLoop& loop, const Topics& topics)
    : name_(topics.name),
      request_topic_(dds_create_topic(participant.get(), &topics.request,
                                      topics.request_topic().c_str(), nullptr, nullptr),
                     "topic " + topics.request_topic()),
      reply_topic_(dds_create_topic(participant.get(), &topics.reply, topics.reply_topic().c_str(),
                                    nullptr, nullptr),
                   "topic " + topics.reply_topic()),
      subscriber_(
          dds_create_subscriber(
              participant.get(),
              participant.credentials() ? partition_qos(kAllClients).get() : nullptr, nullptr),
          "subscriber"),
      reader_(dds_create_reader(subscriber_.get(), request_topic_.get(),
                                request_reader_qos(topics.held_requests).get(), nullptr),
              "reader " + topics.request_topic()),
      matched_writers_(participant),
      matched_readers_(participant) {
  if (participant.credentials()) {
    client_writers_.emplace(participant, loop, reply_topic_, topics.reply_topic(), reply_qos(),
                            &matched_readers_);
    return;
  }
  for (unsigned number = 0; number < kReplyPartitions; ++number) {
    const Qos partition = partition_qos(reply_partition(number));
    publishers_.emplace_back(dds_create_publisher(participant.get(), partition.get(), nullptr),
                             "publisher " + reply_partition(number));
    writers_.push_back(matched_readers_.make_writer(publishers_.back(), reply_topic_.get(),
                                                    reply_qos().get(),
                                                    "writer " + topics.reply_topic()));
  }
}

Sender* ReplyChannel::sender(std::uint64_t writer) {
  if (const std::uint64_t departures = matched_readers_.departures(); departures != departures_) {
    departures_ = departures;
    matched_writers_.forget_heard();
  }
  return matched_writers_.find(reader_, writer);
}

const Entity& ReplyChannel::writer_of(const codec::Head& head) const {
  return writers_[reply_partition_of(head.client_id)];
}

bool ReplyChannel::reaches(const Sender& sender, const codec::Head& head) {
  if (!client_writers_)
    return matched_readers_.has(writer_of(head), sender.participant);
  const auto writer = client_writers_->find(sender.name);
  return writer && matched_readers_.has(*writer, sender.participant);
}

std::size_t ReplyChannel::clients() const {
  const dds_return_t matched = dds_get_matched_publications(reader_.get(), nullptr, 0);
  return matched > 0 ? static_cast<std::size_t>(matched) : 0;
}

bool ReplyChannel::is_being_answered(const Place& place) const {
  const std::lock_guard lock(mutex_);
  return being_answered_.contains(place);
}

bool ReplyChannel::begin(const Place& place) {
  const std::lock_guard lock(mutex_);
  return being_answered_.insert(place).second;
}

void ReplyChannel::end(const Place& place) {
  const std::lock_guard lock(mutex_);
  being_answered_.erase(place);
}

void ReplyChannel::send(const Place& place, const void* reply) noexcept {
  // Whatever keeps the reply from leaving, the client asks again.
  if (!client_writers_) {
    dds_write(writer_of(place.head).get(), reply);
    return;
  }
  try {
    if (const auto writer = client_writers_->of(place.name))
      dds_write(writer->get(), reply);
  } catch (const std::exception&) {  // no memory for a writer
  }
}

}  // namespace kinship::dds
