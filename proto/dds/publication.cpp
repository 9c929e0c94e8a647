#include "proto/dds/publication.hpp"

#include <array>
#include <atomic>
#include <map>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "proto/dds/client_writers.hpp"
#include "proto/dds/loan.hpp"
#include "proto/dds/role_topics.hpp"
#include "proto/dds/wire.hpp"

namespace kinship::dds {
namespace {

Entity make_topic(const Participant& participant, const PublicationTopic& topic) {
  return {dds_create_topic(participant.get(), &topic.type, topic.name.c_str(), nullptr, nullptr),
          "topic " + topic.name};
}

/// The newest announcement of each distribution. May be shared between threads.
class NewestAnnouncements {
 public:
  struct Kept {
    Announcement announcement;
    std::uint64_t number = 0;  ///< another one each time, from 1 on
  };

  void keep(const Announcement& announcement) {
    const std::lock_guard lock(mutex_);
    newest_.insert_or_assign(announcement.distribution_id, Kept{announcement, ++last_number_});
  }
  /// \return the last announcement.
  std::optional<Announcement> forget(const Digest& distribution_id) {
    const std::lock_guard lock(mutex_);
    const auto forgotten = newest_.extract(distribution_id);
    return forgotten ? std::optional(forgotten.mapped().announcement) : std::nullopt;
  }
  std::optional<Kept> find(const Digest& distribution_id) const {
    const std::lock_guard lock(mutex_);
    const auto found = newest_.find(distribution_id);
    return found == newest_.end() ? std::nullopt : std::optional(found->second);
  }
  std::uint64_t number(const Digest& distribution_id) const {  ///< 0: not announced
    const std::lock_guard lock(mutex_);
    const auto found = newest_.find(distribution_id);
    return found == newest_.end() ? 0 : found->second.number;
  }
  std::vector<Announcement> all() const {
    const std::lock_guard lock(mutex_);
    std::vector<Announcement> all;
    for (const auto& [id, kept] : newest_)
      all.push_back(kept.announcement);
    return all;
  }

 private:
  mutable std::mutex mutex_;  // guards what follows
  std::map<Digest, Kept> newest_;
  std::uint64_t last_number_ = 0;
};

kinship_wire_Announcement key_of(const Digest& distribution_id) {
  kinship_wire_Announcement key{};
  std::copy(distribution_id.bytes.begin(), distribution_id.bytes.end(),
            std::begin(key.distribution_id));
  return key;
}

/// Sends that an announcement is withdrawn, and forgets it.
void dispose(const Entity& writer, const Digest& distribution_id) {
  const kinship_wire_Announcement key = key_of(distribution_id);
  dds_dispose(writer.get(), &key);
  dds_unregister_instance(writer.get(), &key);
}

}  // namespace

template <typename Publication>
class Publisher<Publication>::Implementation {
  static constexpr bool kIsKept = std::same_as<Value, Announcement>;

 public:
  Implementation(const Participant& participant, WaitLoop& loop, MayHear may_hear)
      : directory_(participant.options().directory), may_hear_(std::move(may_hear)) {
    PublicationTopic topic = Wire<Publication>::topic();
    topic_.emplace(make_topic(participant, topic));
    if (!participant.credentials()) {
      writer_.emplace(dds_create_writer(participant.get(), topic_->get(), topic.qos.get(), nullptr),
                      "writer " + topic.name);
      return;
    }
    clients_.emplace(participant, loop, *topic_, topic.name, std::move(topic.qos));
    clients_->on_new([this](const std::string& name, const Entity& writer) {
      if constexpr (kIsKept)
        for (const Announcement& announcement : newest_.all())
          bring_up_to_date(name, writer, announcement);
    });
  }

  void publish(const Value& value) {
    if (writer_)
      return write(*writer_, value);
    if constexpr (kIsKept)
      newest_.keep(value);
    clients_->for_each([&](const std::string& name, const Entity& writer) {
      if constexpr (kIsKept)
        bring_up_to_date(name, writer, value);
      else if (hears(name, value))
        write(writer, value);
    });
  }

  /// Of announcements only.
  void withdraw(const Digest& distribution_id) {
    if (writer_)
      return dispose(*writer_, distribution_id);
    if constexpr (kIsKept)
      if (const auto gone = newest_.forget(distribution_id))
        clients_->for_each([&](const std::string& name, const Entity& writer) {
          bring_up_to_date(name, writer, *gone);
        });
  }

 private:
  bool hears(const std::string& name, const Value& value) const {
    const auto caller = directory_ ? directory_(name) : Result<Caller>(Error{});
    return caller && (!may_hear_ || may_hear_(*caller, value));
  }

  /// Brings a client up to date on a distribution. Other threads may do so at the same time: each
  /// checks after its write whether that is still the newest, and writes again if not. So no
  /// outdated value is written last, and no lock is held across a call of Cyclone DDS.
  /// \param announcement  of the distribution; the withdrawn one, if it is.
  template <typename Kept>
  void bring_up_to_date(const std::string& name, const Entity& writer, Kept announcement) const {
    const Digest id = announcement.distribution_id;
    std::uint64_t told = 0;
    do {
      const auto newest = newest_.find(id);
      told = newest ? newest->number : 0;
      if (newest)
        announcement = newest->announcement;
      if (!hears(name, announcement))
        continue;
      if (newest)
        write(writer, announcement);
      else
        dispose(writer, id);
    } while (newest_.number(id) != told);
  }

  static void write(const Entity& writer, const Value& value) {
    if (const auto message = codec::encode(value))
      dds_write(writer.get(), &message->wire);
  }

  Directory directory_;
  MayHear may_hear_;
  std::optional<Entity> topic_;
  std::optional<Entity> writer_;          // without security
  std::optional<ClientWriters> clients_;  // with security
  NewestAnnouncements newest_;            // for late clients; with security
};

template <typename Publication>
Publisher<Publication>::Publisher(const Participant& participant, WaitLoop& loop, MayHear may_hear)
    : implementation_(std::make_unique<Implementation>(participant, loop, std::move(may_hear))) {}

template <typename Publication>
Publisher<Publication>::~Publisher() = default;

template <typename Publication>
void Publisher<Publication>::publish(const Value& value) const noexcept {
  try {
    implementation_->publish(value);
  } catch (const std::exception&) {  // out of memory: subscribers miss this one
  }
}

template <typename Publication>
void Publisher<Publication>::withdraw(const Digest& distribution_id)
    const noexcept requires std::same_as<Publication, codec::AnnouncementPublication> {
  try {
    implementation_->withdraw(distribution_id);
  } catch (const std::exception&) {  // out of memory: late clients hear of it once more
  }
}

template <typename Publication>
class Subscriber<Publication>::Implementation {
 public:
  Implementation(const Participant& participant, Handlers handlers, const PublicationTopic& topic)
      : handlers_(std::move(handlers)),
        name_(topic.name),
        topic_(make_topic(participant, topic)),
        subscriber_(dds_create_subscriber(participant.get(),
                                          participant.credentials()
                                              ? partition_qos(client_partition(participant)).get()
                                              : nullptr,
                                          nullptr),
                    "subscriber"),
        reader_(dds_create_reader(subscriber_.get(), topic_.get(), topic.qos.get(), nullptr),
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
  Entity subscriber_;
  Entity reader_;
  Entity condition_;
  Entity stop_;
  Entity waitset_;
  std::atomic<bool> is_stopped_ = false;
  std::thread thread_;
};

template <typename Publication>
Subscriber<Publication>::Subscriber(const Participant& participant, Handlers handlers) {
  if constexpr (std::same_as<Publication, codec::EventPublication>)
    require_events(participant);
  implementation_ = std::make_unique<Implementation>(participant, std::move(handlers),
                                                     Wire<Publication>::topic());
}

template <typename Publication>
Subscriber<Publication>::~Subscriber() = default;

template class Publisher<codec::AnnouncementPublication>;
template class Publisher<codec::EventPublication>;
template class Subscriber<codec::AnnouncementPublication>;
template class Subscriber<codec::EventPublication>;

}  // namespace kinship::dds
