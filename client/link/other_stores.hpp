#pragma once

#include <chrono>
#include <cstddef>
#include <filesystem>
#include <optional>
#include <set>
#include <vector>

#include "client/link/kept_reports.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::link {

/// Stores that the server of an outbox had before the one that it has: what they acknowledged, in
/// `other_stores/<store>/`, laid out as the outbox itself, with their epochs and consistency
/// tokens, and in `pending/` what was held back for them. A store that comes back finds it as it
/// was. Acknowledged reports age as those of the outbox do (sent_reports.hpp).
///
/// Each method may be ended at any point and is then called again. All but offer_again() and kept()
/// are for the holder of the sender lock. Methods throw Failure(Storage) naming the file.
class OtherStores {
 public:
  static constexpr const char* kFolder = "other_stores";  ///< in the outbox

  /// \param outbox  the folder of the outbox.
  explicit OtherStores(std::filesystem::path outbox);

  /// Puts away what the outbox keeps for the store that it has.
  void put_away(const Uuid& epoch) const;
  /// Puts away those of some reports that are still pending, too.
  void hold_back(const Uuid& epoch, const std::set<Uuid>& reports) const;

  /// The epoch in which a store was known last; empty: it was never seen, or nothing is kept of it.
  std::optional<Uuid> known_epoch(const Uuid& epoch) const;
  /// Gives back to the outbox what is kept for the store that it has now. Sending does not wait for
  /// the empty folder to go: age() deletes it.
  void bring_back(const Uuid& epoch) const;

  /// Makes all that is kept pending. \return how many reports.
  std::size_t offer_again() const;
  /// Deletes all that is kept of some stores, for good. \return how many reports.
  std::size_t drop(const std::vector<KeptReports>& stores) const;

  std::vector<KeptReports> kept() const;  ///< of each store of which something is kept

  /// Deletes stores of which nothing is kept any more, too.
  void age(std::chrono::milliseconds sending) const;

 private:
  std::filesystem::path folder_of(const Uuid& epoch) const;
  std::vector<std::filesystem::path> folders() const;

  std::filesystem::path outbox_;
};

}  // namespace kinship::link
