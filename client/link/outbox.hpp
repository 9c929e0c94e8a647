#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "client/link/kept_reports.hpp"
#include "client/link/other_stores.hpp"
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
/// server neither takes nor refuses, until resend(). `other_stores/`: what stores acknowledged that
/// the server had before (other_stores.hpp). Beside them `robots/`: the descriptions that
/// register their robots; `meshes/`: contents of their meshes, by digest, until a server has them.
///
/// Processes may share one: each may add, only the holder of the sender lock (ReportSender) moves.
/// Methods throw Failure(Storage) naming the file. May be shared between threads.
class Outbox {
 public:
  /// Makes the folders if they are missing, durably; `set_aside/` only once it is needed.
  explicit Outbox(std::filesystem::path folder, Resend resend = Resend::Unacknowledged);

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

  /// Makes all acknowledged reports that are kept pending again, those of older stores and those of
  /// the store that is there.
  /// \return how many.
  std::size_t resend_acknowledged();
  std::vector<KeptReports> kept_of_older_stores() const { return others_.kept(); }
  /// What would be kept of older stores if the server had the store of an epoch.
  std::vector<KeptReports> kept_beside(const Uuid& epoch) const;
  /// Deletes, for good, what is kept of some stores, as kept_of_older_stores() lists them. Takes
  /// the sender lock. \return how many. \throws Failure(Unavailable) if a process sends.
  std::size_t drop_of_older_stores(const std::vector<KeptReports>& stores);

  /// Durably, with the contents of its meshes that come with it. Without meshes those that are
  /// known stay.
  void keep_robot(const Digest& robot, const RobotDescription& description);
  /// Forgets the meshes of a robot, which are to stay here, and their contents but those that
  /// another robot names, too.
  void forget_meshes(const Digest& robot);

  /// Nothing also if its file is damaged.
  std::optional<MeshContent> content(const Digest& content) const;
  /// Drops the contents of a robot's meshes: a server has them.
  void drop_contents(const RobotDescription& description) const;
  /// Robots that name contents which are kept.
  std::vector<Digest> robots_with_contents() const;

  /// \return the description that keep_robot() kept last; NotFound if there is none, InvalidInput,
  ///         TooLarge or Storage if its file is damaged or cannot be read.
  Result<RobotDescription> robot(const Digest& robot) const;

  /// Takes the state of the server's store from a reply; to be called before its receipts are
  /// applied. If it is another epoch of a store that is known, that was restored or rolled back:
  /// its sent reports are pending again. Those of other stores are kept, or as `Resend` says.
  /// \param token  empty: the reply has none, the one remembered stays.
  /// \return whether reports are pending again.
  bool note_store(const Uuid& epoch, const ConsistencyToken& token);

  bool has_receipts() const;  ///< whether an epoch was ever noted
  /// Whether nothing may be sent before the server's store is noted.
  bool holds_back() const { return resend_ == Resend::None && has_receipts(); }
  ConsistencyToken known_token() const;  ///< the newest; empty if there is none

  /// Adds `sending` to the age of the sent reports and deletes old ones (sent_reports.hpp), as well
  /// as temporary files written more than a day ago.
  void age(std::chrono::milliseconds sending);

 private:
  std::filesystem::path file(std::string_view part, const Uuid& report_uuid) const;
  std::filesystem::path reason_file(std::string_view part, const Uuid& report_uuid) const;
  void put_away(std::string_view part, const Uuid& report_uuid, std::string_view reason);
  std::vector<Uuid> reports_in(std::string_view part) const;
  std::optional<Uuid> change_store(const Uuid& from, const Uuid& to) const;
  std::size_t resend_sent() const;
  std::map<Digest, RobotDescription> kept_robots() const;
  void drop_contents_of(const std::set<Digest>& robots) const;
  void drop_contents_without_reports() const;

  const std::filesystem::path folder_;
  const Resend resend_;
  std::set<Uuid> reported_before_;  // pending at the opening, for Resend::None
  SentReports sent_;
  OtherStores others_;
};

/// The outbox for one server: $XDG_STATE_HOME/kinship/outbox/domain-<domain>@<server>, by default
/// below ~/.local/state. Characters that a file name cannot have become `_`.
/// \throws Failure(InvalidInput) if neither XDG_STATE_HOME nor HOME is an absolute path.
std::filesystem::path default_outbox_folder(std::uint32_t domain, std::string_view server);

}  // namespace kinship::link
