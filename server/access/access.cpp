#include "server/access/access.hpp"

#include <algorithm>

#include "proto/types/enum_text.hpp"

namespace kinship::access {
namespace {

bool matches_any(const std::vector<std::string>& patterns, std::string_view text) {
  return patterns.empty() || text.empty() ||
         std::ranges::any_of(patterns,
                             [&](const std::string& pattern) { return matches(pattern, text); });
}

std::string listed(const std::vector<std::string>& patterns) {
  std::string text;
  for (const std::string& pattern : patterns)
    text += (text.empty() ? "" : ", ") + pattern;
  return text;
}

/// "its certificate is for tasks bin_*, robots panda"
std::string scope_of(const Caller& caller) {
  std::string text = "its certificate is for";
  if (!caller.tasks.empty())
    text += " tasks " + listed(caller.tasks);
  if (!caller.robots.empty())
    text += (caller.tasks.empty() ? " robots " : ", robots ") + listed(caller.robots);
  return text;
}

Error refused(const Caller& caller, std::string_view act, const std::string& why) {
  return {ErrorCode::InvalidInput, describe(caller) + " may not " + std::string(act) + ": " + why};
}

bool has_role(const Caller& caller, AccessRole least) {
  return static_cast<int>(caller.role) >= static_cast<int>(least);
}

/// A change of a task reaches all its robots, one of a robot all its tasks.
bool reaches_beyond(const Caller& caller, const VerbRule& rule) {
  return rule.is(VerbRule::Changes) &&
         ((rule.argument == VerbArgument::Task && !caller.robots.empty()) ||
          (rule.argument == VerbArgument::Robot && !caller.tasks.empty()));
}

std::optional<Error> refusal_by_place(const Caller& caller, std::string_view act) {
  if (!caller.name.empty())
    return std::nullopt;
  switch (caller.token) {
    case TokenProof::Shown:
      return std::nullopt;
    case TokenProof::Missing:
      return refused(caller, act,
                     "this server serves other hosts without security, where that needs its token: "
                     "kinship --token FILE, a copy of the file that kinshipd names at its start; "
                     "kinshipd --security has certificates tell who may do it");
    case TokenProof::Wrong:
      return refused(
          caller, act,
          "the proof of the token is wrong: another token, a request that was sent before, "
          "or the server was started anew");
    case TokenProof::NotNeeded:
      break;
  }
  if (caller.is_local)
    return std::nullopt;
  return refused(caller, act,
                 "this server runs without security, where that is for its own machine alone; "
                 "kinshipd --security has certificates tell who may do it");
}

/// Robots and administrators only: a reader or operator has nothing to report.
std::optional<Error> refusal_of_robots_act(const Caller& caller, std::string_view act) {
  if (caller.role == AccessRole::Robot || caller.role == AccessRole::Admin)
    return std::nullopt;
  return refused(caller, act, "needs role robot or admin");
}

std::optional<Error> refusal_of_names(const Caller& caller, std::string_view task,
                                      std::string_view robot, const std::string& act) {
  if (!matches_any(caller.tasks, task))
    return refused(caller, act + " task '" + std::string(task) + "'", scope_of(caller));
  if (!matches_any(caller.robots, robot))
    return refused(caller, act + " robot '" + std::string(robot) + "'", scope_of(caller));
  return std::nullopt;
}

}  // namespace

bool matches(std::string_view pattern, std::string_view text) noexcept {
  std::size_t at_pattern = 0, at_text = 0;
  std::size_t star = std::string_view::npos, after_star = 0;  // the last one, its match's end
  while (at_text < text.size()) {
    if (at_pattern < pattern.size() && pattern[at_pattern] == '*') {
      star = at_pattern++;
      after_star = at_text;
    } else if (at_pattern < pattern.size() &&
               (pattern[at_pattern] == '?' || pattern[at_pattern] == text[at_text])) {
      ++at_pattern;
      ++at_text;
    } else if (star != std::string_view::npos) {
      at_pattern = star + 1;
      at_text = ++after_star;
    } else {
      return false;
    }
  }
  return pattern.find_first_not_of('*', at_pattern) == std::string_view::npos;
}

std::string describe(const Caller& caller) {
  if (caller.name.empty())
    return caller.is_local ? "a client on this machine" : "a client on another host";
  return caller.name + " (role " + std::string(to_text(caller.role)) + ")";
}

bool is_narrowed(const Caller& caller) noexcept {
  return !caller.tasks.empty() || !caller.robots.empty();
}

bool may_see(const Caller& caller, std::string_view task, std::string_view robot) {
  return matches_any(caller.tasks, task) && matches_any(caller.robots, robot);
}

std::optional<Error> refusal_of(const Caller& caller, AdminVerb verb) {
  const VerbRule& rule = rule_of(verb);
  if (!has_role(caller, rule.least))
    return refused(caller, rule.act, "needs role " + std::string(to_text(rule.least)));
  if (rule.is(VerbRule::OfAll) && is_narrowed(caller))
    return refused(caller, rule.act, "that is about all tasks and robots, " + scope_of(caller));
  if (reaches_beyond(caller, rule))
    return refused(caller, rule.act, "that reaches beyond what it is for: " + scope_of(caller));
  if (rule.is(VerbRule::Changes) && verb != AdminVerb::CancelJob)
    return refusal_by_place(caller, rule.act);
  return std::nullopt;
}

std::optional<Error> refusal_of_task(const Caller& caller, std::string_view task) {
  return refusal_of_names(caller, task, {}, "ask about");
}

std::optional<Error> refusal_of_robot(const Caller& caller, std::string_view label) {
  return refusal_of_names(caller, {}, label, "ask about");
}

std::optional<Error> refusal_of_job(const Caller& caller, AdminVerb verb, const std::string& job) {
  const std::string act =
      std::string(verb == AdminVerb::CancelJob ? "cancel" : "see") + " job '" + job + "'";
  if (!has_role(caller, AccessRole::Operator))
    return refused(caller, act, "it is not its own, which needs role operator");
  if (is_narrowed(caller))
    return refused(caller, act,
                   "it is not its own, which may be about others; " + scope_of(caller));
  return verb == AdminVerb::CancelJob ? refusal_by_place(caller, act) : std::nullopt;
}

std::optional<Error> refusal_of_registration(const Caller& caller, std::string_view label) {
  if (auto refusal = refusal_of_robots_act(caller, "register robots"))
    return refusal;
  return refusal_of_names(caller, {}, label, "register");
}

/// In words that do not tell the label.
std::optional<Error> refusal_of_known_robot(const Caller& caller, std::string_view label) {
  if (matches_any(caller.robots, label))
    return std::nullopt;
  return refused(caller, "register this robot",
                 "it is known here under another label, and " + scope_of(caller));
}

std::optional<Error> refusal_of_report(const Caller& caller, std::string_view task,
                                       std::string_view robot) {
  if (auto refusal = refusal_of_robots_act(caller, "report"))
    return refusal;
  return refusal_of_names(caller, task, robot, "report for");
}

std::optional<Error> refusal_of_fetch(const Caller& caller, std::string_view task,
                                      std::string_view robot) {
  return refusal_of_names(caller, task, robot, "fetch for");
}

bool may_hear(const Caller& caller, const Event& event) {
  if (!has_role(caller, AccessRole::Reader))
    return false;
  if (!is_narrowed(caller))
    return true;
  // An event without a task or robot may name others in its text.
  const bool names_enough = (caller.tasks.empty() || !event.task.empty()) &&
                            (caller.robots.empty() || !event.robot.empty());
  return names_enough && may_see(caller, event.task, event.robot);
}

}  // namespace kinship::access
