#pragma once

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/caller.hpp"
#include "proto/types/result.hpp"

namespace kinship::security {

/// The server's record of a client: DIR/clients/NAME.toml.
struct ClientRecord {
  std::string name;
  AccessRole role = AccessRole::Robot;
  std::vector<std::string> tasks = {};    ///< patterns (`*`, `?`) that it is limited to; empty: all
  std::vector<std::string> robots = {};   ///< labels that it is limited to; empty: all
  std::string serial = {};                ///< of its newest certificate, hexadecimal
  std::uint32_t generation = 1;           ///< of it: each renewal has the next (CertificateName)
  std::uint32_t oldest_accepted = 1;      ///< generation: earlier ones are refused
  std::string authority = {};             ///< fingerprint of the authority that issued it
  std::vector<std::string> trusted = {};  ///< fingerprints of the authorities that it trusts
  std::chrono::sys_seconds expires = {};
  std::optional<std::chrono::sys_seconds> revoked = {};  ///< when
};

/// What stays so of a client, whatever becomes of its record.
struct Revocation {
  std::string client;
  std::optional<std::chrono::sys_seconds> revoked = {};  ///< when
  std::uint32_t oldest_accepted = 1;                     ///< generation of credentials
  std::uint32_t generation = 1;                          ///< the newest that was issued
};

/// The fault of a client's name; nothing if it is 1 to 56 of [A-Za-z0-9_-] and not the server's
/// name. A certificate has 64 characters for it and its generation.
std::optional<Error> check_client_name(std::string_view name);

/// The fault of a pattern of tasks; nothing if it is 1 to 128 of the characters of task names, *
/// and ?.
std::optional<Error> check_task_pattern(std::string_view pattern);

std::string record_text(const ClientRecord& record);  ///< as TOML

/// \param what  names the text in messages.
Result<ClientRecord> read_record(std::string_view text, const std::string& what);

/// The rights of a client, as attached to its requests.
Caller caller_of(const ClientRecord& record);

}  // namespace kinship::security
