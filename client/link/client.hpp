#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "client/link/follower.hpp"
#include "client/link/kept_reports.hpp"
#include "client/link/watcher.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"

namespace kinship::kinematics {
struct RobotModel;
}

namespace kinship::link {

struct ClientOptions {
  std::uint32_t domain = 0;
  std::string server = "127.0.0.1";  ///< host of kinshipd
  /// Folder of credentials (kinshipd secure add); empty: that of KINSHIP_SECURITY, or none.
  std::filesystem::path security = {};
  /// File with a copy of the server's token, for changes of a server that serves other hosts
  /// without security (kinshipd --token-file); empty: that of KINSHIP_TOKEN, or none.
  std::filesystem::path token = {};
  std::filesystem::path outbox;            ///< folder; empty: default_outbox_folder()
  bool has_outbox = true;                  ///< false: delivers nothing, report() is not allowed
  Resend resend = Resend::Unacknowledged;  ///< what a store that the outbox never saw is sent
  /// Of register (per message, see mesh_upload.hpp), deliver (per batch, without the pauses that
  /// the server asks for) and admin.
  std::chrono::milliseconds timeout{5000};
};

/// A fleet member's connection to kinshipd: registers a robot, reports attempts, fetches
/// distributions.
///
/// A report is on disk before report() returns and is sent in the background until the server's
/// receipt says that it is durable there; it survives a crash of either side. Processes may share
/// an outbox: one of them sends. May be shared between threads.
class Client {
 public:
  /// \throws Failure(InvalidInput) for invalid options or credentials, Failure(Storage) if the
  ///         outbox cannot be made, Failure(Unavailable) if DDS cannot start. Needs no server.
  explicit Client(const ClientOptions& options);
  ~Client();
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// A warning for people, if the credentials expire in less than 30 days.
  std::optional<std::string> expiry_warning() const;

  /// Registers the robot and keeps its description in the outbox, so that its reports also reach a
  /// server that does not know the robot yet or any more.
  /// \return the reply, or Unavailable if no server answered within the timeout.
  /// \throws Failure(Storage) if the outbox cannot be written.
  Result<RegisterReply> register_robot(const RobotDescription& description);
  Result<RegisterReply> register_robot(const kinematics::RobotModel& robot);  ///< read before

  /// Forgets meshes of a robot that registrations left in the outbox: they are not to be sent.
  void forget_meshes(const Digest& robot);

  /// Puts the attempt into the outbox (durable on return) and wakes the sender.
  /// \throws Failure(InvalidInput) if the server would refuse it anyway, as a path of more joints
  ///         than its robot has; Failure(NotFound) if no client registered its robot with this
  ///         outbox; Failure(Storage) if the outbox cannot be written; std::logic_error without
  ///         one.
  void report(const Attempt& attempt);

  struct OutboxState {
    std::size_t pending = 0;        ///< not yet acknowledged
    std::size_t accepted = 0;       ///< since this client started: stored, duplicate or recorded
    std::size_t refused = 0;        ///< since this client started; kept in the rejected folder
    std::string problem;            ///< why sending fails; empty: no known problem
    std::size_t set_aside = 0;      ///< since this client started; see 'kinship outbox'
    std::string last_refusal = {};  ///< why the last of the refused is; empty: none is
    std::vector<KeptReports> kept = {};  ///< of stores that the server had before; see describe()
  };
  OutboxState outbox() const;  ///< zeros without an outbox

  /// Waits until nothing is pending or the deadline has passed.
  OutboxState flush(std::chrono::milliseconds deadline);

  /// Waits until the reply is final or the request's deadline has passed (then: the last Pending or
  /// Busy reply, or Unavailable if no server answered). With a deadline of 0 the server answers at
  /// once with the distribution it has, and the client waits for the reply up to the timeout of
  /// register and admin. If requested, the reply holds the newest experience of the task that
  /// arrived meanwhile.
  Result<FetchReply> fetch(FetchRequest request);

  /// Starts a follower that holds the newest distribution for the request. It may outlive the
  /// client.
  /// \throws Failure(InvalidInput or TooLarge) if the request breaks a rule.
  std::unique_ptr<Follower> follow(const FetchRequest& request,
                                   const FollowOptions& options = {}) const;

  /// Subscribes to the server's events. The watcher may outlive the client.
  std::unique_ptr<Watcher> watch(Watcher::Handlers handlers) const;

  /// Sends attempts at once, past the outbox, batch after batch: a caller that kept them can send
  /// them again.
  /// \return one receipt per attempt, in order: Refused also for an invalid attempt, which is not
  ///         sent, TryAgain for one that the server could not store within the timeout (a busy
  ///         server may extend it by 10 minutes per batch). Unavailable if no server answered; some
  ///         attempts may have arrived then.
  Result<std::vector<Receipt>> deliver(std::vector<Attempt> attempts);

  /// Waits for the reply up to the timeout, for ShowJob longer by the request's deadline. A change
  /// shows the token, if there is one and the server wants it.
  /// \throws Failure if the token's file cannot be read.
  Result<AdminReply> admin(const AdminRequest& request);

  /// Ends every wait for a reply, from another thread; it and later ones return Unavailable.
  /// Reports are sent as before, and deliver() sends its remaining attempts once.
  void cancel();

  /// Whether this process was forked from the one that made the client: here the client does not
  /// work, and its destructor does nothing.
  bool is_forked() const;

  /// \throws Failure(InvalidInput) with advice if is_forked().
  void require_own_process() const;

 private:
  struct Line;
  Result<AdminReply> change(const AdminRequest& request);
  Result<std::string> challenge(bool is_kept);
  std::unique_ptr<Line> line_;
};

}  // namespace kinship::link
