#pragma once

#include <functional>
#include <memory>

#include "proto/types/publications.hpp"

namespace kinship::dds {
class Participant;
}

namespace kinship::link {

/// Receives the server's events: reports, fetches, fits, refusals. A slow handler misses events;
/// nothing else depends on them.
class Watcher {
 public:
  /// Called on a thread of the watcher's own, one at a time. They must not throw and must not
  /// destroy the watcher.
  struct Handlers {
    std::function<void(const Event&)> on_event;
    std::function<void()> on_server = {};       ///< a server is there, at first or again
    std::function<void()> on_server_gone = {};  ///< it ended, or died some seconds ago
  };

  /// \param participant  shared by a client and its watchers, which may outlive it.
  Watcher(std::shared_ptr<const dds::Participant> participant, Handlers handlers);
  ~Watcher();  ///< waits for the handler that runs; none is called afterwards
  Watcher(const Watcher&) = delete;
  Watcher& operator=(const Watcher&) = delete;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::link
