#include "proto/dds/reply_line.hpp"

#include <dds/dds.h>

#include <exception>

#include "proto/dds/qos.hpp"

namespace kinship::dds {

ReplyLine::ReplyLine(const Participant& participant, WaitLoop& loop, const Topics& topics)
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
      senders_(participant) {
  if (participant.credentials()) {
    client_writers_.emplace(participant, loop, reply_topic_, topics.reply_topic(), reply_qos());
    return;
  }
  for (unsigned number = 0; number < kReplyPartitions; ++number) {
    const Qos partition = partition_qos(reply_partition(number));
    publishers_.emplace_back(dds_create_publisher(participant.get(), partition.get(), nullptr),
                             "publisher " + reply_partition(number));
    writers_.emplace_back(
        dds_create_writer(publishers_.back().get(), reply_topic_.get(), reply_qos().get(), nullptr),
        "writer " + topics.reply_topic());
  }
}

std::size_t ReplyLine::clients() const {
  const dds_return_t matched = dds_get_matched_publications(reader_.get(), nullptr, 0);
  return matched > 0 ? static_cast<std::size_t>(matched) : 0;
}

bool ReplyLine::is_being_answered(const Place& place) const {
  const std::lock_guard lock(mutex_);
  return being_answered_.contains(place);
}

bool ReplyLine::begin(const Place& place) {
  const std::lock_guard lock(mutex_);
  return being_answered_.insert(place).second;
}

void ReplyLine::end(const Place& place) {
  const std::lock_guard lock(mutex_);
  being_answered_.erase(place);
}

void ReplyLine::send(const Place& place, const void* reply) noexcept {
  // Whatever keeps the reply from leaving, the client asks again.
  if (!client_writers_) {
    dds_write(writers_[reply_partition_of(place.head.client_id)].get(), reply);
    return;
  }
  try {
    if (const auto writer = client_writers_->of(place.name))
      dds_write(writer->get(), reply);
  } catch (const std::exception&) {  // no memory for a writer
  }
}

}  // namespace kinship::dds
