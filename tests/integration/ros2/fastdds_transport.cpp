#include <fastdds/dds/core/condition/WaitSet.hpp>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>

#include <cstdlib>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>

#include "tests/integration/ros2/fastdds_bytes_type.hpp"
#include "tests/integration/ros2/transport.hpp"

namespace kinship::test {
namespace {

using namespace eprosima::fastdds;       // NOLINT: what the whole file is about
using namespace eprosima::fastdds::dds;  // NOLINT
namespace rtps = fast_rtps;

template <typename Pointer>
Pointer checked(Pointer pointer, const char* what) {
  if (!pointer)
    throw std::runtime_error(what);
  return pointer;
}

/// As rmw_fastrtps has it by default.
class FastTransport final : public Transport {
 public:
  explicit FastTransport(std::uint32_t domain) {
    DomainParticipantQos qos;
    if (const char* const local = std::getenv("ROS_LOCALHOST_ONLY");
        local == nullptr || local != std::string("0"))
      stay_on_loopback(qos);
    participant_ = checked(
        DomainParticipantFactory::get_instance()->create_participant(domain, qos), "participant");
    publisher_ = checked(participant_->create_publisher(PUBLISHER_QOS_DEFAULT), "publisher");
    subscriber_ = checked(participant_->create_subscriber(SUBSCRIBER_QOS_DEFAULT), "subscriber");
  }
  ~FastTransport() override {
    participant_->delete_contained_entities();
    DomainParticipantFactory::get_instance()->delete_participant(participant_);
  }

  int open_writer(const std::string& topic, const TopicType& type) override {
    DataWriterQos qos;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.history().depth = 10;
    qos.durability().kind = VOLATILE_DURABILITY_QOS;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    writers_.push_back(
        checked(publisher_->create_datawriter(make_topic(topic, type), qos), "writer"));
    return static_cast<int>(writers_.size()) - 1;
  }

  void close_writer(int writer) override {
    publisher_->delete_datawriter(writers_.at(static_cast<std::size_t>(writer)));
  }

  int open_reader(const std::string& topic, const TopicType& type, bool is_late) override {
    DataReaderQos qos;
    qos.reliability().kind = RELIABLE_RELIABILITY_QOS;
    qos.history().depth = 10;
    qos.durability().kind = is_late ? TRANSIENT_LOCAL_DURABILITY_QOS : VOLATILE_DURABILITY_QOS;
    qos.endpoint().history_memory_policy = rtps::PREALLOCATED_WITH_REALLOC_MEMORY_MODE;
    readers_.push_back(
        checked(subscriber_->create_datareader(make_topic(topic, type), qos), "reader"));
    return static_cast<int>(readers_.size()) - 1;
  }

  bool wait_for_writer_match(int writer, Deadline deadline) override {
    DataWriter& entity = *writers_.at(static_cast<std::size_t>(writer));
    return wait(entity, StatusMask::publication_matched(), deadline, [&] {
      PublicationMatchedStatus status;
      entity.get_publication_matched_status(status);
      return status.current_count > 0;
    });
  }

  bool wait_for_reader_match(int reader, Deadline deadline) override {
    DataReader& entity = *readers_.at(static_cast<std::size_t>(reader));
    return wait(entity, StatusMask::subscription_matched(), deadline, [&] {
      SubscriptionMatchedStatus status;
      entity.get_subscription_matched_status(status);
      return status.current_count > 0;
    });
  }

  void write(int writer, const Outgoing& message) override {
    Bytes bytes = message.cdr;
    if (!succeeded(writers_.at(static_cast<std::size_t>(writer))->write(&bytes)))
      throw std::runtime_error("write");
  }

  std::optional<Bytes> take(int reader, Deadline deadline) override {
    DataReader& entity = *readers_.at(static_cast<std::size_t>(reader));
    std::optional<Bytes> taken;
    wait(entity, StatusMask::data_available(), deadline, [&] {
      Bytes bytes;
      SampleInfo info;
      while (!taken && succeeded(entity.take_next_sample(&bytes, &info)))
        if (info.valid_data)
          taken = bytes;
      return taken.has_value();
    });
    return taken;
  }

 private:
  static void stay_on_loopback(DomainParticipantQos& qos) {
    qos.transport().use_builtin_transports = false;
    const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
    udp->interfaceWhiteList.emplace_back("127.0.0.1");
    udp->sendBufferSize = udp->receiveBufferSize = 4 << 20;
    qos.transport().user_transports.push_back(udp);
    rtps::Locator_t peer;
    rtps::IPLocator::setIPv4(peer, "127.0.0.1");
    qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  }

  Topic* make_topic(const std::string& topic, const TopicType& type) {
    if (types_.try_emplace(type.name, new BytesType(type.name)).second)
      types_.at(type.name).register_type(participant_);
    return checked(participant_->create_topic(topic, type.name, TOPIC_QOS_DEFAULT), "topic");
  }

  static bool wait(Entity& entity, const StatusMask& mask, Deadline deadline,
                   const std::function<bool()>& holds) {
    StatusCondition& condition = entity.get_statuscondition();
    condition.set_enabled_statuses(mask);
    WaitSet waitset;
    waitset.attach_condition(condition);
    bool does_hold = holds();
    while (!does_hold && std::chrono::steady_clock::now() < deadline) {
      const std::chrono::nanoseconds left = deadline - std::chrono::steady_clock::now();
      ConditionSeq active;
      waitset.wait(active, FastDuration(static_cast<long double>(left.count()) / 1e9L));
      does_hold = holds();
    }
    waitset.detach_condition(condition);
    return does_hold;
  }

  DomainParticipant* participant_ = nullptr;
  Publisher* publisher_ = nullptr;
  Subscriber* subscriber_ = nullptr;
  std::map<std::string, TypeSupport> types_;
  std::vector<DataWriter*> writers_;
  std::vector<DataReader*> readers_;
};

}  // namespace

std::unique_ptr<Transport> join(std::uint32_t domain) {
  return std::make_unique<FastTransport>(domain);
}

}  // namespace kinship::test
