#include "client/link/watcher.hpp"

#include <utility>

#include "proto/dds/publication.hpp"

namespace kinship::link {

class Watcher::Implementation {
 public:
  Implementation(std::shared_ptr<const dds::Participant> participant, Handlers handlers)
      : participant_(std::move(participant)),
        events_(*participant_, {.on_sample = std::move(handlers.on_event),
                                .on_server = std::move(handlers.on_server),
                                .on_server_gone = std::move(handlers.on_server_gone)}) {}

 private:
  const std::shared_ptr<const dds::Participant> participant_;
  dds::Subscriber<codec::EventPublication> events_;
};

Watcher::Watcher(std::shared_ptr<const dds::Participant> participant, Handlers handlers)
    : implementation_(
          std::make_unique<Implementation>(std::move(participant), std::move(handlers))) {}

Watcher::~Watcher() = default;

}  // namespace kinship::link
