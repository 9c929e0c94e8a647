#pragma once

#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <thread>
#include <utility>

#include "proto/dds/publication.hpp"
#include "proto/dds/replier.hpp"
#include "proto/types/conversations.hpp"

namespace kinship::link {

/// A server in this process that gives every fetch the same reply until it is told another, and
/// announces what it is told to.
class FollowServer {
 public:
  using AnswerAdmin = std::function<AdminReply(const AdminRequest&)>;

  FollowServer(std::uint32_t domain, FetchReply reply, AnswerAdmin administer = {})
      : reply_(std::move(reply)),
        participant_({.domain = domain, .role = dds::Role::Server}),
        loop_(participant_),
        fetch_(participant_, loop_,
               [this](const FetchRequest& wanted, const auto& answer) { answer(take(wanted)); }),
        admin_(
            participant_, loop_,
            [administer = std::move(administer)](const AdminRequest& request, const auto& answer) {
              answer(administer ? administer(request) : AdminReply());
            }),
        announcements_(participant_, loop_),
        thread_(
            [this] { loop_.run([] { return std::chrono::steady_clock::time_point::max(); }); }) {}
  FollowServer(const FollowServer&) = delete;
  FollowServer& operator=(const FollowServer&) = delete;
  ~FollowServer() {
    loop_.stop();
    thread_.join();
  }

  void set_reply(FetchReply reply) {
    const std::lock_guard lock(mutex_);
    reply_ = std::move(reply);
  }

  /// What the server announces of a distribution that it has now.
  void announce(const Distribution& distribution) {
    announcements_.publish({distribution.id, distribution.task, distribution.robot,
                            distribution.revision, distribution.store_epoch});
  }

  int fetches() const {
    const std::lock_guard lock(mutex_);
    return fetches_;
  }
  FetchRequest first_request() const {
    const std::lock_guard lock(mutex_);
    return first_request_;
  }
  FetchRequest last_request() const {
    const std::lock_guard lock(mutex_);
    return last_request_;
  }

  /// \return whether there were so many in time.
  bool wait_for_fetches(int count, std::chrono::seconds time) {
    std::unique_lock lock(mutex_);
    return fetched_.wait_for(lock, time, [&] { return fetches_ >= count; });
  }

 private:
  FetchReply take(const FetchRequest& wanted) {
    const std::lock_guard lock(mutex_);
    if (++fetches_ == 1)
      first_request_ = wanted;
    last_request_ = wanted;
    fetched_.notify_all();
    return reply_;
  }

  mutable std::mutex mutex_;  // guards what follows up to the participant
  std::condition_variable fetched_;
  FetchReply reply_;
  FetchRequest first_request_, last_request_;
  int fetches_ = 0;
  dds::Participant participant_;
  dds::WaitLoop loop_;
  dds::Replier<codec::FetchConversation> fetch_;
  dds::Replier<codec::AdminConversation> admin_;
  dds::Publisher<codec::AnnouncementPublication> announcements_;
  std::thread thread_;
};

}  // namespace kinship::link
