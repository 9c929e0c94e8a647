#include "proto/dds/reply_line.hpp"

#include "proto/dds/qos.hpp"

namespace kinship::dds {

ReplyLine::ReplyLine(const Participant& participant, const Topics& topics)
    : name_(topics.name),
      request_topic_(dds_create_topic(participant.get(), &topics.request,
                                      topics.request_topic().c_str(), nullptr, nullptr),
                     "topic " + topics.request_topic()),
      reply_topic_(dds_create_topic(participant.get(), &topics.reply, topics.reply_topic().c_str(),
                                    nullptr, nullptr),
                   "topic " + topics.reply_topic()),
      reader_(dds_create_reader(participant.get(), request_topic_.get(),
                                request_reader_qos(topics.held_requests).get(), nullptr),
              "reader " + topics.request_topic()) {
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

bool ReplyLine::is_being_answered(const codec::Head& head) const {
  const std::lock_guard lock(mutex_);
  return being_answered_.contains(head);
}

bool ReplyLine::begin(const codec::Head& head) {
  const std::lock_guard lock(mutex_);
  return being_answered_.insert(head).second;
}

void ReplyLine::end(const codec::Head& head) {
  const std::lock_guard lock(mutex_);
  being_answered_.erase(head);
}

void ReplyLine::send(const codec::Head& head, const void* reply) const noexcept {
  // Whatever keeps the reply from leaving, the client asks again.
  dds_write(writers_[reply_partition_of(head.client_id)].get(), reply);
}

}  // namespace kinship::dds
