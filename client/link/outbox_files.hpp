#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <string_view>

#include "proto/types/uuid.hpp"

namespace kinship::files {
class LockFile;
}

/// The files of an outbox, one report each. For the sources of this folder only.
namespace kinship::link {

inline constexpr std::string_view kPending = "pending";
inline constexpr std::string_view kSent = "sent";               ///< acknowledged
inline constexpr std::string_view kSentBefore = "sent_before";  ///< acknowledged earlier
inline constexpr std::string_view kEpoch = "store_epoch";
inline constexpr std::string_view kToken = "consistency_token";

/// The epoch in a folder; empty: none is noted there.
std::optional<Uuid> noted_epoch(const std::filesystem::path& folder);

std::string report_file_name(const Uuid& report_uuid);

/// The UUID in the name of a report's file; empty for any other name.
std::optional<Uuid> report_uuid_of(const std::filesystem::path& path);

/// Calls `visit` with every entry of a folder. Entries that vanish meanwhile are no error.
/// \throws Failure(Storage) naming the folder if it cannot be listed.
void for_each_entry(const std::filesystem::path& folder,
                    const std::function<void(const std::filesystem::directory_entry&)>& visit);

/// The right to send from an outbox and to delete of it; empty if another owner on this machine has
/// it. \throws Failure(Storage) if the lock file cannot be opened.
std::optional<files::LockFile> try_to_become_sender(const std::filesystem::path& outbox);

/// The process that has that right, or had it last: its id, or "unknown".
std::string sender_of(const std::filesystem::path& outbox);

/// \return false if it was not there. \throws Failure(Storage) naming the target.
bool move_file(const std::filesystem::path& from, const std::filesystem::path& to);

}  // namespace kinship::link
