#pragma once

#include <memory>
#include <vector>

#include "proto/dds/participant.hpp"
#include "proto/dds/wait_loop.hpp"
#include "proto/types/publications.hpp"
#include "server/service/service.hpp"

namespace kinship::ros2 {

/// The channels of a node: each question is read, counted against the quotas of its node, and
/// handed to the service; each answer goes back by the topic or service it came from.
class QuestionsServed {
 public:
  /// \param participant, loop, service  outlive the object.
  QuestionsServed(const dds::Participant& participant, dds::WaitLoop& loop,
                  service::Service& service);
  ~QuestionsServed();
  QuestionsServed(const QuestionsServed&) = delete;
  QuestionsServed& operator=(const QuestionsServed&) = delete;

  /// Fetches and publishes for the nodes that follow. On the loop's thread.
  void announce(const Announcement& announcement);

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::ros2
