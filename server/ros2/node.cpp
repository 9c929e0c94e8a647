#include "server/ros2/node.hpp"

#include <deque>
#include <exception>
#include <mutex>
#include <optional>
#include <thread>
#include <utility>

#include "proto/dds/participant.hpp"
#include "proto/dds/wait_loop.hpp"
#include "server/ros2/questions_served.hpp"

namespace kinship::ros2 {

class Node::Implementation {
 public:
  explicit Implementation(const NodeOptions& options)
      : participant_({.domain = options.domain,
                      .role = dds::Role::RosNode,
                      .network_interface = options.network_interface,
                      .security = options.enclave}),
        loop_(participant_) {}

  void announce(const Announcement& announcement) {
    {
      const std::lock_guard lock(mutex_);
      if (announced_.size() >= kMaxAnnounced)
        announced_.pop_front();
      announced_.push_back(announcement);
    }
    loop_.wake();
  }

  void serve(service::Service& service) {
    questions_.emplace(participant_, loop_, service);
    thread_ = std::thread([this] {
      loop_.run([this] {
        while (const auto announcement = next_announced())
          questions_->announce(*announcement);
        return dds::WaitLoop::Clock::time_point::max();
      });
    });
  }

  void stop() {
    loop_.stop();
    if (thread_.joinable())
      thread_.join();
  }

 private:
  static constexpr std::size_t kMaxAnnounced = 1024;

  std::optional<Announcement> next_announced() {
    const std::lock_guard lock(mutex_);
    if (announced_.empty())
      return std::nullopt;
    std::optional<Announcement> next = std::move(announced_.front());
    announced_.pop_front();
    return next;
  }

  dds::Participant participant_;
  dds::WaitLoop loop_;
  std::mutex mutex_;  // guards announced_
  std::deque<Announcement> announced_;
  std::optional<QuestionsServed> questions_;
  std::thread thread_;  // last: uses the others
};

Node::Node(const NodeOptions& options)
    : implementation_(std::make_unique<Implementation>(options)) {}

Node::~Node() = default;

void Node::announce(const Announcement& announcement) { implementation_->announce(announcement); }

Node::Serving::Serving(Node& node, service::Service& service) : node_(*node.implementation_) {
  node_.serve(service);
}

Node::Serving::~Serving() { node_.stop(); }

}  // namespace kinship::ros2
