#pragma once

#include <span>
#include <string_view>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"

namespace kinship::access {

/// Who may ask for an admin verb.
struct VerbRule {
  AdminVerb verb;
  std::string_view name;  ///< in the audit log: stays as it is
  std::string_view act;   ///< in words: "... may not <act>"
  AccessRole least;       ///< this role, and those after it in AccessRole
  /// It changes something: it is in the audit log, and without security for this machine alone.
  bool is_change;
  /// It is about all tasks and robots at once: not for a certificate that is for some of them.
  bool is_about_all = false;
};

/// One for each verb, in their order.
std::span<const VerbRule> verb_rules();

const VerbRule& rule_of(AdminVerb verb);

}  // namespace kinship::access
