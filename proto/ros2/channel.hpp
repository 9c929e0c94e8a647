#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <new>
#include <optional>
#include <set>
#include <string>
#include <utility>

#include "proto/dds/participant.hpp"
#include "proto/dds/wait_loop.hpp"
#include "proto/ros2/answers.hpp"
#include "proto/ros2/wire.hpp"
#include "proto/types/caller.hpp"

struct dds_topic_descriptor;

namespace kinship::ros2 {

/// The two topics of a question and its answer: of messages by UUID, or of a service.
struct ChannelTopics {
  std::string question;  ///< as DDS names it, e.g. "rt/kinship/report"
  const dds_topic_descriptor& question_type;
  std::string answer;
  const dds_topic_descriptor& answer_type;
  bool is_asked_again = true;  ///< by nodes that did not get their answer; a service's call is not
};

/// One question of a ROS node, and the way back. Copyable; may be used from any thread, also after
/// the channel is gone. Answered once: later answers are not sent. Never answered: the node's next
/// sending of the question is handled anew.
class Question {
 public:
  class State;
  explicit Question(std::shared_ptr<State> state) : state_(std::move(state)) {}

  /// Sends the answer, a message of the channel's type, with the question's key at its beginning.
  /// Without memory it is not sent. One that has the node ask again is sent at once or not at all.
  template <typename Wire>
  void answer(Message<Wire> message) const noexcept try {
    const auto kept = std::make_shared<Message<Wire>>(std::move(message));
    constexpr std::size_t kFirstBlock = 1024;  // of an arena, whose further ones grow by halves
    send({kept, &kept->wire}, kFirstBlock + sizeof(Wire) + 2 * kept->arena->bytes(),
         !asks_again(kept->wire));
  } catch (const std::bad_alloc&) {  // the node asks again
  }

  const Caller& caller() const noexcept;
  std::string key() const;  ///< as text, after the caller's client and a space (catalog::client_of)

 private:
  void send(std::shared_ptr<void> sample, std::size_t bytes, bool may_wait) const;

  std::shared_ptr<State> state_;  // shared by the copies; the last one frees the place
};

/// The server's side of a topic or service of ROS: nodes in turn, so that one that asks much delays
/// only itself. A question waits until its node can hear the answer, 100 ms at most. One that is
/// sent again while it is being answered is dropped. Every node hears every answer, and may lose
/// its own among many of another: where it is asked again a node is sent 100 answers a second at
/// most.
class Channel {
 public:
  using Answering = std::function<void()>;
  /// Reads a sample of a question as it arrives; what it returns is done in the node's turn (empty:
  /// nothing, it is answered). Both on the loop's thread.
  using Reading = std::function<Answering(const void* sample, const Question&)>;

  /// \param loop  of the same participant.
  /// \throws Failure(Internal) if an entity cannot be made.
  Channel(const dds::Participant& participant, dds::WaitLoop& loop, const ChannelTopics& topics,
          Reading reading);
  ~Channel();
  Channel(const Channel&) = delete;
  Channel& operator=(const Channel&) = delete;

  /// The nodes that can ask now (Caller::client); nothing if that cannot be known. On the loop's
  /// thread.
  std::optional<std::set<std::string>> nodes() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::ros2
