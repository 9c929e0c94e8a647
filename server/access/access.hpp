#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/caller.hpp"
#include "proto/types/conversations.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/publications.hpp"

/// What a caller may ask for. Each function returns why not, in words that name who, what and what
/// it would take; nothing if it may.
namespace kinship::access {

/// `*` stands for any number of characters, `?` for one.
bool matches(std::string_view pattern, std::string_view text) noexcept;

/// "robot_7 (role robot)"; without a certificate where it asks from.
std::string describe(const Caller& caller);

/// Whether its certificate is for some tasks or robots only.
bool is_narrowed(const Caller& caller) noexcept;

/// Whether what is about a task and a robot is for this caller; an empty name is about none, which
/// suits everybody.
bool may_see(const Caller& caller, std::string_view task, std::string_view robot);

/// By its role alone; of verbs that change something, without security, by where it asks from.
/// CancelJob is allowed here to whoever may have begun one: see refusal_of_job().
std::optional<Error> refusal_of(const Caller& caller, AdminVerb verb);

/// Of a task or robot (label) that a request names.
std::optional<Error> refusal_of_task(const Caller& caller, std::string_view task);
std::optional<Error> refusal_of_robot(const Caller& caller, std::string_view label);

/// Of a job that another client began.
/// \param verb  CancelJob, or one that reads.
std::optional<Error> refusal_of_job(const Caller& caller, AdminVerb verb, const std::string& job);

/// Registering, reporting and fetching, by role, task and robot (label).
std::optional<Error> refusal_of_registration(const Caller& caller, std::string_view label);
/// Of a robot that is known under this label, whatever the registration calls it.
std::optional<Error> refusal_of_known_robot(const Caller& caller, std::string_view label);
std::optional<Error> refusal_of_report(const Caller& caller, std::string_view task,
                                       std::string_view robot);
std::optional<Error> refusal_of_fetch(const Caller& caller, std::string_view task,
                                      std::string_view robot);

/// Whether it hears of an event: readers and those after them, narrowed ones of what names a task
/// and a robot of theirs.
bool may_hear(const Caller& caller, const Event& event);

}  // namespace kinship::access
