#pragma once

#include <cstdint>
#include <string>
#include <tuple>

#include "proto/types/field.hpp"
#include "proto/types/limits.hpp"

namespace kinship {

/// State of an administrative act.
enum class AuditOutcome {
  Begun,    ///< takes several transactions, or does not change the store; its end follows
  Done,     ///< as `after` says
  Refused,  ///< not done; `message` says why
  Failed    ///< some of it may have been done
};

/// An entry of the audit log for an administrative act. An entry never changes: an act that began
/// and ended has two.
struct AuditEntry {
  std::uint64_t number = 0;  ///< 1, 2 ... in the order of writing
  std::int64_t time_ms = 0;
  std::string name = {};    ///< in the certificate; empty without security
  std::string role = {};    ///< of that certificate; empty as the name
  std::string client = {};  ///< the name, or the participant
  bool is_local = true;     ///< requested on the server's machine
  std::string verb = {};    ///< e.g. "reset_task"
  std::string target = {};  ///< object of the act, as in the request
  AuditOutcome outcome = AuditOutcome::Done;
  std::string before = {}, after = {};  ///< counts and labels, as text
  std::string message = {};             ///< why refused or failed
};

template <>
inline constexpr std::tuple kFieldsOf<AuditEntry>{
    Field{"number", &AuditEntry::number},
    Field{"time_ms", &AuditEntry::time_ms},
    Field{"name", &AuditEntry::name, {.limit = kMaxWordBytes}},
    Field{"role", &AuditEntry::role, {.limit = kMaxWordBytes}},
    Field{"client", &AuditEntry::client, {.limit = kMaxMachineBytes}},
    Field{"is_local", &AuditEntry::is_local},
    Field{"verb", &AuditEntry::verb, {.limit = kMaxWordBytes}},
    Field{"target", &AuditEntry::target, {.limit = kMaxTargetBytes}},
    Field{"outcome", &AuditEntry::outcome},
    Field{"before", &AuditEntry::before, {.limit = kMaxMessageBytes}},
    Field{"after", &AuditEntry::after, {.limit = kMaxMessageBytes}},
    Field{"message", &AuditEntry::message, {.limit = kMaxMessageBytes}}};

}  // namespace kinship
