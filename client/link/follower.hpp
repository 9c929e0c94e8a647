#pragma once

#include <Eigen/Geometry>
#include <chrono>
#include <memory>
#include <optional>
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
  NoServer,      ///< no server has answered, or answers any more; newest() keeps its value
  Pending,       ///< the distribution is being made; newest() keeps its value
  NoExperience,  ///< no experience to make it of, or none any more; newest() is null
  UnknownRobot,  ///< the robot is not registered; newest() keeps its value
  Refused,       ///< the server refuses the request, or fails; newest() keeps its value
  Failed,        ///< nothing could be transferred or fitted; newest() is null
};

/// Options of a follower.
struct FollowOptions {
  /// Longest pause after a reply without news; the first pause is a twentieth of this.
  std::chrono::milliseconds longest_pause{20'000};
  /// A request without placement is for where its robot stood when it last reported the task
  /// (reported_placement.hpp), as the server says before each fetch until it has, or a
  /// distribution is held; until then it is fetched for identity. A server that does not say it
  /// refuses the request.
  bool asks_placement = false;
};

/// Holds the newest distribution for one request; reading it never blocks.
///
/// Its thread fetches the distribution with a lease, renews the lease at a third of its time, and
/// fetches again when the server announces a change or has restarted, and with growing pauses while
/// there is none. May be shared between threads.
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
  ~Follower();  ///< immediate, also during a fetch; values of newest() stay valid
  Follower(const Follower&) = delete;
  Follower& operator=(const Follower&) = delete;

  /// The newest distribution, with a mixture, or null as long as there is none: state() says why.
  /// Copies a pointer under a lock that is never held longer than that.
  std::shared_ptr<const Distribution> newest() const;

  /// The latest experience of the task, if the request asks for it, also where newest() is null;
  /// null as long as there is none, or none any more. It is fetched again only if it changed.
  /// Copies a pointer like newest().
  std::shared_ptr<const TaskExperience> experience() const;

  /// The latest library of paths to recall, likewise; null as long as none came.
  std::shared_ptr<const RecallLibrary> recall() const;

  /// Of the request, or as the server said; missing: neither, so the base is at the origin.
  std::optional<Eigen::Isometry3d> T_task_base() const;

  State state() const;

  /// Waits until newest() is another revision, or of another store epoch, than `held`, or the
  /// deadline has passed.
  /// \param held  null: any distribution will do.
  /// \return newest() then; equal to `held`, or null, after the deadline.
  std::shared_ptr<const Distribution> wait_for_newer(
      const std::shared_ptr<const Distribution>& held,
      std::chrono::steady_clock::time_point deadline) const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace kinship::link
