#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/publications.hpp"

/// Access rules of callers. Each refusal_of function returns an error that names the caller, the
/// request and the missing permission; nothing if the request is allowed.
namespace kinship::access {

/// Whether a text matches a pattern: `*` stands for any number of characters, `?` for one.
bool matches(std::string_view pattern, std::string_view text) noexcept;

/// "robot_7 (role robot)"; without a certificate, the place of the caller.
std::string describe(const Caller& caller);

/// Whether the caller's certificate is for some tasks or robots only.
bool is_narrowed(const Caller& caller) noexcept;

/// Whether the caller may see data about a task and a robot; an empty name is about none and
/// allowed for every caller.
bool may_see(const Caller& caller, std::string_view task, std::string_view robot);

/// By role, and for a caller limited to tasks or robots by the verb's reach; without security,
/// verbs that change something also by the place of the caller, or by the token that it shows.
/// CancelJob is allowed here to every caller that may have begun a job: see refusal_of_job().
std::optional<Error> refusal_of(const Caller& caller, AdminVerb verb);

/// For a task or robot (label) that a request names.
std::optional<Error> refusal_of_task(const Caller& caller, std::string_view task);
std::optional<Error> refusal_of_robot(const Caller& caller, std::string_view label);

/// For a job that another client began.
/// \param verb  CancelJob, or a verb that reads.
std::optional<Error> refusal_of_job(const Caller& caller, AdminVerb verb, const std::string& job);

/// Registering, reporting and fetching, by role, task and robot (label).
std::optional<Error> refusal_of_registration(const Caller& caller, std::string_view label);
/// For a robot that is known under this label; the registration may name another.
std::optional<Error> refusal_of_known_robot(const Caller& caller, std::string_view label);
std::optional<Error> refusal_of_report(const Caller& caller, std::string_view task,
                                       std::string_view robot);
std::optional<Error> refusal_of_fetch(const Caller& caller, std::string_view task,
                                      std::string_view robot);

/// Whether a caller receives an event: role reader or above; a caller limited to tasks or robots,
/// only events that name its own.
bool may_hear(const Caller& caller, const Event& event);

}  // namespace kinship::access
