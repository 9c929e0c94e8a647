#include "proto/dds/matched_readers.hpp"

#include <dds/dds.h>

#include <algorithm>
#include <array>
#include <exception>
#include <memory>

#include "proto/dds/endpoint.hpp"

namespace kinship::dds {

MatchedReaders::MatchedReaders(const Participant& participant)
    : guard_(dds_create_guardcondition(participant.get()), "guard condition") {}

Entity MatchedReaders::make_writer(const Entity& publisher, Handle topic, const dds_qos* qos,
                                   std::string_view what) {
  const std::unique_ptr<dds_listener_t, decltype(&dds_delete_listener)> listener(
      dds_create_listener(this), &dds_delete_listener);
  // Called one match after the other, on a thread of Cyclone DDS.
  dds_lset_publication_matched(
      listener.get(), [](dds_entity_t writer, dds_publication_matched_status_t status, void* self) {
        const Reader reader{writer, status.last_subscription_handle};
        if (status.current_count_change < 0)
          static_cast<MatchedReaders*>(self)->go(reader);
        else
          static_cast<MatchedReaders*>(self)->come(reader);
      });
  Entity writer(dds_create_writer(publisher.get(), topic, qos, listener.get()), what);
  // The listener may have missed readers that matched while the writer was made.
  std::array<std::uint64_t, 256> readers{};
  const dds_return_t count =
      dds_get_matched_subscriptions(writer.get(), readers.data(), readers.size());
  for (std::size_t i = 0;
       i < std::min(static_cast<std::size_t>(std::max(count, 0)), readers.size()); ++i)
    come({writer.get(), readers[i]});
  return writer;
}

bool MatchedReaders::has(const Entity& writer, std::uint64_t participant) const {
  const std::lock_guard lock(mutex_);
  return participants_.contains({writer.get(), participant});
}

void MatchedReaders::come(const Reader& reader) {
  const Endpoint endpoint(dds_get_matched_subscription_data(reader.first, reader.second));
  if (!endpoint)
    return;  // gone again
  const std::uint64_t participant = endpoint->participant_instance_handle;
  try {
    const std::lock_guard lock(mutex_);
    if (readers_.try_emplace(reader, participant).second)
      participants_.emplace(reader.first, participant);
  } catch (const std::exception&) {  // out of memory: replies are asked for again
    return;
  }
  dds_set_guardcondition(guard_.get(), true);
}

void MatchedReaders::go(const Reader& reader) {
  {
    const std::lock_guard lock(mutex_);
    const auto known = readers_.find(reader);
    if (known == readers_.end())
      return;
    if (const auto hearer = participants_.find({reader.first, known->second});
        hearer != participants_.end())
      participants_.erase(hearer);
    readers_.erase(known);
  }
  ++departures_;
}

}  // namespace kinship::dds
