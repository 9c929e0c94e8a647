#include "client/link/watcher.hpp"

#include <utility>

#include "proto/dds/participant.hpp"
#include "proto/dds/publication.hpp"

namespace kinship::link {

class Watcher::Implementation {
 public:
  Implementation(std::shared_ptr<const dds::Participant> participant, Handlers handlers)
      : participant_(std::move(participant)),
        events_(*participant_, {.on_sample = std::move(handlers.on_event),
                                .on_server = std::move(handlers.on_server),
                                .on_server_gone = std::move(handlers.on_server_gone)}) {}

  bool is_forked() const { return process_.is_forked(); }

 private:
  const dds::OwningProcess process_;
  const std::shared_ptr<const dds::Participant> participant_;
  dds::Subscriber<codec::EventPublication> events_;
};

Watcher::Watcher(std::shared_ptr<const dds::Participant> participant, Handlers handlers)
    : implementation_(
          std::make_unique<Implementation>(std::move(participant), std::move(handlers))) {}

Watcher::~Watcher() {
  if (implementation_->is_forked())
    static_cast<void>(implementation_.release());  // its threads are not here
}

}  // namespace kinship::link
