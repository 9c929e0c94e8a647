#include "proto/dds/publication.hpp"

#include <array>
#include <atomic>
#include <thread>
#include <utility>

#include "proto/dds/loan.hpp"
#include "proto/dds/wire.hpp"

namespace kinship::dds {
namespace {

Entity make_topic(const Participant& participant, const PublicationTopic& topic) {
  return {dds_create_topic(participant.get(), &topic.type, topic.name.c_str(), nullptr, nullptr),
          "topic " + topic.name};
}

}  // namespace

template <typename Publication>
class Publisher<Publication>::Implementation {
 public:
  Implementation(const Participant& participant, const PublicationTopic& topic)
      : topic_(make_topic(participant, topic)),
        writer_(dds_create_writer(participant.get(), topic_.get(), topic.qos.get(), nullptr),
                "writer " + topic.name) {}

  Handle writer() const noexcept { return writer_.get(); }

 private:
  Entity topic_;
  Entity writer_;
};

template <typename Publication>
Publisher<Publication>::Publisher(const Participant& participant)
    : implementation_(std::make_unique<Implementation>(participant, Wire<Publication>::topic())) {}

template <typename Publication>
Publisher<Publication>::~Publisher() = default;

template <typename Publication>
void Publisher<Publication>::publish(const typename Publication::Value& value) const noexcept {
  try {
    if (const auto message = codec::encode(value))
      dds_write(implementation_->writer(), &message->wire);
  } catch (const std::exception&) {  // out of memory: subscribers miss this one
  }
}

template <typename Publication>
void Publisher<Publication>::withdraw(const Digest& distribution_id)
    const noexcept requires std::same_as<Publication, codec::AnnouncementPublication> {
  kinship_wire_Announcement key{};
  std::copy(distribution_id.bytes.begin(), distribution_id.bytes.end(),
            std::begin(key.distribution_id));
  dds_dispose(implementation_->writer(), &key);
  dds_unregister_instance(implementation_->writer(), &key);
}

template <typename Publication>
class Subscriber<Publication>::Implementation {
 public:
  Implementation(const Participant& participant, Handlers handlers, const PublicationTopic& topic)
      : handlers_(std::move(handlers)),
        name_(topic.name),
        topic_(make_topic(participant, topic)),
        reader_(dds_create_reader(participant.get(), topic_.get(), topic.qos.get(), nullptr),
                "reader " + topic.name),
        condition_(dds_create_readcondition(reader_.get(), DDS_ANY_STATE), "read condition"),
        stop_(dds_create_guardcondition(participant.get()), "guard condition"),
        waitset_(dds_create_waitset(participant.get()), "waitset") {
    require(dds_set_status_mask(reader_.get(), DDS_SUBSCRIPTION_MATCHED_STATUS), "status mask");
    for (const Handle entity : {stop_.get(), condition_.get(), reader_.get()})
      require(dds_waitset_attach(waitset_.get(), entity, 0), "waitset");
    thread_ = std::thread([this] { run(); });
  }
  Implementation(const Implementation&) = delete;
  Implementation& operator=(const Implementation&) = delete;
  ~Implementation() {
    is_stopped_ = true;
    dds_set_guardcondition(stop_.get(), true);
    thread_.join();
  }

 private:
  using Sample = typename Wire<Publication>::Sample;

  void run() {
    while (!is_stopped_) {
      std::array<dds_attach_t, 3> ready{};
      require(dds_waitset_wait(waitset_.get(), ready.data(), ready.size(), DDS_INFINITY),
              "waitset");
      notice_servers();
      while (!is_stopped_ && hand_out_samples()) {
      }
    }
  }

  void notice_servers() const {
    dds_subscription_matched_status_t status{};
    require(dds_get_subscription_matched_status(reader_.get(), &status), "reader " + name_);
    const bool has_one_gone = status.current_count_change < status.total_count_change;
    const bool has_one_come = status.total_count_change > 0;
    const bool is_one_there = status.current_count > 0;  // otherwise going was the last
    if (has_one_gone && is_one_there)
      call(handlers_.on_server_gone);
    if (has_one_come)
      call(handlers_.on_server);
    if (has_one_gone && !is_one_there)
      call(handlers_.on_server_gone);
  }

  void call(const std::function<void()>& handler) const {
    if (handler && !is_stopped_)
      handler();
  }

  /// \return whether there may be more.
  bool hand_out_samples() const {
    const Loan samples(reader_, "samples of " + name_);
    for (std::size_t i = 0; i < samples.size() && !is_stopped_; ++i) {
      if (!samples[i])
        continue;
      if (const auto value = codec::decode(*static_cast<const Sample*>(samples[i])))
        handlers_.on_sample(*value);
    }
    return samples.size() > 0;
  }

  Handlers handlers_;
  std::string name_;
  Entity topic_;
  Entity reader_;
  Entity condition_;
  Entity stop_;
  Entity waitset_;
  std::atomic<bool> is_stopped_ = false;
  std::thread thread_;
};

template <typename Publication>
Subscriber<Publication>::Subscriber(const Participant& participant, Handlers handlers)
    : implementation_(std::make_unique<Implementation>(participant, std::move(handlers),
                                                       Wire<Publication>::topic())) {}

template <typename Publication>
Subscriber<Publication>::~Subscriber() = default;

template class Publisher<codec::AnnouncementPublication>;
template class Publisher<codec::EventPublication>;
template class Subscriber<codec::AnnouncementPublication>;
template class Subscriber<codec::EventPublication>;

}  // namespace kinship::dds
