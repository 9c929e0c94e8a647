#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "client/link/sent_reports.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/result.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::link {

/// Reports of a client on disk, one file each, named by report UUID:
/// `pending/` until the server's receipt, then `sent/` (sent_reports.hpp) or `rejected/` for good.
/// Beside them `robots/`: what to register their robots with.
///
/// Processes may share one: anybody adds, the holder of the sender lock (ReportSender) moves.
/// Methods throw Failure(Storage) naming the file. May be shared between threads.
class Outbox {
 public:
  /// Makes the folders if they are missing, durably.
  explicit Outbox(std::filesystem::path folder);

  const std::filesystem::path& folder() const noexcept { return folder_; }

  void add(const Attempt& attempt);  ///< into pending; durable on return

  std::size_t pending_count() const;
  std::vector<Uuid> pending() const;  ///< oldest first

  /// \return a pending attempt; NotFound if it is gone, InvalidInput or TooLarge if its file is
  ///         damaged.
  Result<Attempt> read(const Uuid& report_uuid) const;

  void mark_sent(const Uuid& report_uuid);
  void reject(const Uuid& report_uuid, std::string_view reason);  ///< reason: <uuid>.reason.txt

  void keep_robot(const Digest& robot, const RobotDescription& description);  ///< durably

  /// \return what keep_robot() was given last; NotFound if it never was, InvalidInput or TooLarge
  ///         if its file is damaged.
  Result<RobotDescription> robot(const Digest& robot) const;

  /// To be told what every reply says of the store, before the receipts in it. If its epoch differs
  /// from the one remembered, the server's store was restored, replaced or rolled back, and what
  /// was sent is pending again.
  /// \param mark  empty: the server gives none, the one remembered stays.
  /// \return whether something is pending again.
  bool note_store(const Uuid& epoch, const HistoryMark& mark);

  bool has_receipts() const;       ///< whether an epoch was ever noted
  HistoryMark known_mark() const;  ///< the newest; empty if there is none

  /// What was sent grows older by so much, and is deleted if it is old (sent_reports.hpp);
  /// temporary files that were written more than a day ago are.
  void age(std::chrono::milliseconds sending);

 private:
  std::filesystem::path file(std::string_view part, const Uuid& report_uuid) const;

  std::filesystem::path folder_;
  SentReports sent_;
};

/// The outbox for one server: $XDG_STATE_HOME/kinship/outbox/domain-<domain>@<server>, by default
/// below ~/.local/state. What cannot be in a file name is `_`.
/// \throws Failure(InvalidInput) if neither XDG_STATE_HOME nor HOME is an absolute path.
std::filesystem::path default_outbox_folder(std::uint32_t domain, std::string_view server);

}  // namespace kinship::link
