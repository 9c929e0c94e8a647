#pragma once

#include <chrono>
#include <memory>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"

namespace kinship::dds {
class Participant;
}

namespace kinship::link {

/// How the last exchange of a follower with the server ended.
enum class FollowStatus {
  Ready,         ///< newest() is the server's newest
  NoServer,      ///< nobody has answered, or answers any more; newest() stays what it was
  Pending,       ///< it is being made; newest() stays what it was
  NoExperience,  ///< there is nothing, or nothing any more, to make it of; newest() is null
  UnknownRobot,  ///< the robot is not registered; newest() stays what it was
  Refused,       ///< the server refuses the request, or errs; newest() stays what it was
  Failed,        ///< nothing could be transferred or fitted; newest() is null
};

/// How a follower keeps up.
struct FollowOptions {
  /// Longest pause after an answer that brought nothing; it starts at a twentieth of this.
  std::chrono::milliseconds longest_pause{20'000};
};

/// Always holds the newest distribution for one request, without ever blocking who asks for it.
///
/// A thread of its own fetches it with a lease on its interest, renews that at a third of its time,
/// and fetches anew what the server announces, after a restart of the server, and with growing
/// pauses where there is nothing yet. May be shared between threads.
class Follower {
 public:
  struct State {
    FollowStatus status = FollowStatus::NoServer;
    std::string reason;  ///< why not Ready; a warning of the server otherwise, mostly empty
  };

  /// \param participant  shared by a client and its followers, which may outlive it.
  /// \param request      its `follow` is the lease, 60 s if it is 0; its deadline is not used.
  /// \throws Failure(InvalidInput or TooLarge) if the request breaks a rule.
  Follower(std::shared_ptr<const dds::Participant> participant, FetchRequest request,
           const FollowOptions& options = {});
  ~Follower();  ///< at once, whatever is under way; what newest() returned stays valid
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  /// The newest distribution, with a mixture, or null as long as there is none: state() says why.
  /// Copies a pointer under a lock that is never held longer than that.
  std::shared_ptr<const Distribution> newest() const;

  /// The experience of the task that came last, if the request asks for it: with newest(), whatever
  /// became of that; null as long as there is none, or none any more. It is fetched anew only if it
  /// changed. Copies a pointer like newest().
  std::shared_ptr<const TaskExperience> experience() const;

  State state() const;

  /// Waits until newest() is another revision, or of another store epoch, than `held`, or the time
  /// has come.
  /// \param held  null: any distribution will do.
  /// \return newest() then; equal to `held`, or null, after the time has come.
  std::shared_ptr<const Distribution> wait_for_newer(
      const std::shared_ptr<const Distribution>& held,
      std::chrono::steady_clock::time_point deadline) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::link
