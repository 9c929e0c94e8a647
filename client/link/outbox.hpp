#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/link/sent_reports.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/outbox_entry.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::link {

/// Reports of a client on disk, one file each, named by report UUID: `pending/` until the server's
/// receipt, then `sent/` (sent_reports.hpp) or `rejected/` for good. `set_aside/`: those that the
/// server neither takes nor refuses, until resend(). Beside them `robots/`: the descriptions that
/// register their robots; `meshes/`: contents of their meshes, by digest, until a server has them.
///
/// Processes may share one: each may add, only the holder of the sender lock (ReportSender) moves.
/// Methods throw Failure(Storage) naming the file. May be shared between threads.
class Outbox {
 public:
  /// Makes the folders if they are missing, durably; `set_aside/` only once it is needed.
  explicit Outbox(std::filesystem::path folder);

  const std::filesystem::path& folder() const noexcept { return folder_; }

  void add(const Attempt& attempt);  ///< into pending; durable on return

  /// Regular files that have the name of a report, but these.
  std::size_t pending_count(const std::set<Uuid>& without = {}) const;
  std::vector<Uuid> pending() const;  ///< oldest first; also what only has the name of a report

  /// Never waits, whatever has the name of the report.
  /// \return a pending attempt; NotFound if it is gone, InvalidInput or TooLarge if its file is
  ///         damaged, Storage if it cannot be read: a folder, a FIFO, a file of somebody else, ...
  Result<Attempt> read(const Uuid& report_uuid) const;

  void mark_sent(const Uuid& report_uuid);
  void reject(const Uuid& report_uuid, std::string_view reason);     ///< reason: <uuid>.reason.txt
  void set_aside(const Uuid& report_uuid, std::string_view reason);  ///< the same

  std::vector<Uuid> reports_set_aside() const;
  std::vector<Uuid> reports_rejected() const;
  /// Makes a report that is set aside or rejected pending again. \return false if it is neither.
  bool resend(const Uuid& report_uuid);
  /// Deletes a report that is set aside or rejected, for good. \return false if it is neither.
  bool drop(const Uuid& report_uuid);

  /// Reports that wait or are kept apart, by folder and file. Reads all pending ones.
  std::vector<OutboxEntry> entries() const;

  /// Durably, with the contents of its meshes that come with it.
  void keep_robot(const Digest& robot, const RobotDescription& description);

  /// Nothing also if its file is damaged.
  std::optional<MeshContent> content(const Digest& content) const;
  /// Drops the contents of a robot's meshes: a server has them.
  void drop_contents(const RobotDescription& description);
  /// Robots that name contents which are kept.
  std::vector<Digest> robots_with_contents() const;

  /// \return the description that keep_robot() kept last; NotFound if there is none, InvalidInput,
  ///         TooLarge or Storage if its file is damaged or cannot be read.
  Result<RobotDescription> robot(const Digest& robot) const;

  /// Takes the state of the server's store from a reply; to be called before its receipts are
  /// applied. If the epoch differs from the one remembered, the store was restored, replaced or
  /// rolled back, and the sent reports are pending again.
  /// \param token  empty: the reply has none, the one remembered stays.
  /// \return whether reports are pending again.
  bool note_store(const Uuid& epoch, const ConsistencyToken& token);

  bool has_receipts() const;             ///< whether an epoch was ever noted
  ConsistencyToken known_token() const;  ///< the newest; empty if there is none

  /// Adds `sending` to the age of the sent reports and deletes old ones (sent_reports.hpp), as well
  /// as temporary files written more than a day ago.
  void age(std::chrono::milliseconds sending);

 private:
  std::filesystem::path file(std::string_view part, const Uuid& report_uuid) const;
  std::filesystem::path reason_file(std::string_view part, const Uuid& report_uuid) const;
  void put_away(std::string_view part, const Uuid& report_uuid, std::string_view reason);
  std::vector<Uuid> reports_in(std::string_view part) const;

  std::filesystem::path folder_;
  SentReports sent_;
};

/// The outbox for one server: $XDG_STATE_HOME/kinship/outbox/domain-<domain>@<server>, by default
/// below ~/.local/state. Characters that a file name cannot have become `_`.
/// \throws Failure(InvalidInput) if neither XDG_STATE_HOME nor HOME is an absolute path.
std::filesystem::path default_outbox_folder(std::uint32_t domain, std::string_view server);

}  // namespace kinship::link
