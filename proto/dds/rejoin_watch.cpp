#include "proto/dds/rejoin_watch.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <exception>
#include <optional>
#include <vector>

#include "proto/dds/endpoint.hpp"
#include "proto/dds/loan.hpp"
#include "proto/dds/participant.hpp"

namespace kinship::dds {
namespace {

using namespace std::chrono_literals;

// From hearing a server to being accepted takes a second, and 5 s where a hundred clients of a
// small machine start at once: who fell silent then would begin anew what is nearly done.
constexpr std::chrono::seconds kFirstPatience = 20s;
constexpr std::chrono::seconds kLongestPatience = 40s;
constexpr std::chrono::seconds kSilence = kLease + 2s;

dds_duration_t duration_of(std::chrono::nanoseconds time) {
  return std::max<dds_duration_t>(time.count(), 0);
}

Entity builtin_reader(Handle participant, Handle topic) {
  Entity reader(dds_create_reader(participant, topic, nullptr, nullptr),
                "reader of what is discovered");
  require(dds_set_status_mask(reader.get(), DDS_DATA_AVAILABLE_STATUS), "status mask");
  return reader;
}

/// Keeps what is there of what a reader of a built-in topic tells.
template <typename Data, typename Value, typename Read>
void take_all(const Entity& reader, std::map<std::uint64_t, Value>& there, const Read& read) {
  while (true) {
    const Loan discovered(reader, "what is discovered");
    for (std::size_t i = 0; i < discovered.size(); ++i)
      if (discovered[i] && discovered.is_alive(i))
        there.insert_or_assign(discovered.instance(i),
                               read(*static_cast<const Data*>(discovered[i])));
      else if (!discovered.is_alive(i))
        there.erase(discovered.instance(i));
    if (discovered.size() < Loan::kMaxSamples)
      return;
  }
}

std::vector<Handle> children_of(Handle entity) {
  std::array<Handle, 64> children{};
  const Handle count = dds_get_children(entity, children.data(), children.size());
  const auto known = std::clamp<std::ptrdiff_t>(count, 0, std::ssize(children));
  return {children.begin(), children.begin() + known};
}

std::string topic_of(Handle endpoint) {
  std::array<char, 256> name{};
  dds_get_name(dds_get_topic(endpoint), name.data(), name.size());
  return name.data();
}

}  // namespace

RejoinWatch::RejoinWatch(Handle participant)
    : participant_(participant),
      participants_(builtin_reader(participant, DDS_BUILTIN_TOPIC_DCPSPARTICIPANT)),
      readers_(builtin_reader(participant, DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION)),
      writers_(builtin_reader(participant, DDS_BUILTIN_TOPIC_DCPSPUBLICATION)),
      stop_(dds_create_guardcondition(participant), "guard condition"),
      waitset_(dds_create_waitset(participant), "waitset") {
  for (const Handle entity : {participants_.get(), readers_.get(), writers_.get(), stop_.get()})
    require(dds_waitset_attach(waitset_.get(), entity, 0), "waitset");
  thread_ = std::thread([this] { run(); });
}

RejoinWatch::~RejoinWatch() {
  is_stopped_ = true;
  dds_set_guardcondition(stop_.get(), true);
  thread_.join();
  if (Clock::now() < silent_until_)  // the participant's end is told
    dds_domain_set_deafmute(participant_, false, false, DDS_INFINITY);
}

/// An error, e.g. of memory, leaves the client as it is without a watch.
void RejoinWatch::run() noexcept try {
  std::optional<Clock::time_point> deadline;  // to match what does not yet
  std::chrono::seconds patience = kFirstPatience;
  while (!is_stopped_) {
    std::array<dds_attach_t, 4> ready{};
    require(dds_waitset_wait(waitset_.get(), ready.data(), ready.size(),
                             deadline ? duration_of(*deadline - Clock::now()) : DDS_INFINITY),
            "waitset");
    notice();
    const Clock::time_point now = Clock::now();
    if (deadline && now < *deadline)
      continue;
    if (!lacks_a_match()) {
      if (deadline && !is_remote_.empty())
        patience = kFirstPatience;
      deadline.reset();
    } else if (!deadline) {
      deadline = now + patience;
    } else {
      fall_silent();
      patience = std::min(2 * patience, kLongestPatience);
      deadline = now + kSilence + patience;
    }
  }
} catch (const std::exception&) {
}

void RejoinWatch::notice() {
  const auto read_endpoint = [](const dds_builtintopic_endpoint_t& endpoint) {
    return Discovered{endpoint.topic_name, endpoint.participant_instance_handle};
  };
  take_all<dds_builtintopic_participant_t>(
      participants_, is_remote_,
      [](const dds_builtintopic_participant_t& each) { return !is_in_this_process(each); });
  take_all<dds_builtintopic_endpoint_t>(readers_, readers_there_, read_endpoint);
  take_all<dds_builtintopic_endpoint_t>(writers_, writers_there_, read_endpoint);
}

/// Whether a participant elsewhere is heard, and none of its readers and writers, or a reader or
/// writer of ours matches none of its topic that is heard.
bool RejoinWatch::lacks_a_match() const {
  const auto is_remote = [this](Id participant) {
    const auto found = is_remote_.find(participant);
    return found != is_remote_.end() && found->second;
  };
  const auto is_any_heard = [&](const std::map<Id, Discovered>& endpoints, const auto& is_meant) {
    return std::ranges::any_of(endpoints, [&](const auto& each) {
      return is_remote(each.second.participant) && is_meant(each.second.topic);
    });
  };
  if (std::ranges::none_of(is_remote_, [](const auto& each) { return each.second; }))
    return false;
  const auto is_any = [](const std::string&) { return true; };
  if (!is_any_heard(readers_there_, is_any) && !is_any_heard(writers_there_, is_any))
    return true;
  for (const Handle group : children_of(participant_))
    for (const Handle endpoint : children_of(group)) {
      const bool is_unheard_writer = dds_get_matched_subscriptions(endpoint, nullptr, 0) == 0;
      const bool is_deaf_reader = dds_get_matched_publications(endpoint, nullptr, 0) == 0;
      if (!is_unheard_writer && !is_deaf_reader)
        continue;
      const std::string topic = topic_of(endpoint);
      if (is_any_heard(is_unheard_writer ? readers_there_ : writers_there_,
                       [&](const std::string& each) { return each == topic; }))
        return true;
    }
  return false;
}

void RejoinWatch::fall_silent() {
  silent_until_ = Clock::now() + kSilence;
  dds_domain_set_deafmute(participant_, true, true, duration_of(kSilence));
}

}  // namespace kinship::dds
