#include "server/app/access_gate.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "proto/types/nearest_name.hpp"
#include "server/access/access.hpp"
#include "server/access/withheld_sources.hpp"

namespace kinship::app {
namespace {

using RobotLabels = service::RegistrationService::RobotLabels;

/// The label of a robot as far as a narrowed caller's certificate needs it.
struct KnownLabel {
  std::string label;                     ///< empty: it does not matter
  std::optional<ReceiptStatus> trouble;  ///< it cannot be told now
  std::string why = {};
};

/// The store's message about an unreadable robot has a label, which may be another's.
std::string why_not_now(const Digest& robot, const Error& error) {
  return error.code == ErrorCode::Unavailable
             ? error.message
             : "robot " + robot.short_hex() + " cannot be read from the store now";
}

KnownLabel look_up(const Caller& caller, const RobotLabels& labels, const Digest& robot) {
  if (caller.robots.empty())
    return {};
  const auto found = labels.find(robot);
  if (found == labels.end())
    return {{}, ReceiptStatus::UnknownRobot, "robot " + robot.short_hex() + " is not registered"};
  if (!found->second)
    return {{}, ReceiptStatus::TryAgain, why_not_now(robot, found->second.error())};
  return {found->second.value(), std::nullopt};
}

/// The answer to an attempt that goes no further; nothing if the caller may report it.
std::optional<Receipt> receipt_against(const Caller& caller, const RobotLabels& labels,
                                       const Attempt& attempt) {
  const KnownLabel robot = look_up(caller, labels, attempt.robot);
  // A task that is not the caller's is not, whichever the robot is.
  if (const auto refusal = access::refusal_of_report(caller, attempt.task, robot.label))
    return Receipt{attempt.report_uuid, ReceiptStatus::Refused, refusal->message};
  if (robot.trouble)
    return Receipt{attempt.report_uuid, *robot.trouble, robot.why};
  return std::nullopt;
}

/// \return whether some are to be sent again.
bool keep_allowed(ReportRequest& request, const Caller& caller, const RobotLabels& labels) {
  std::vector<Attempt> allowed;
  bool is_postponed = false;
  for (Attempt& attempt : request.attempts) {
    if (auto receipt = receipt_against(caller, labels, attempt)) {
      is_postponed = is_postponed || receipt->status == ReceiptStatus::TryAgain;
      request.refused.push_back(std::move(*receipt));
      continue;
    }
    attempt.machine = caller.name;
    allowed.push_back(std::move(attempt));
  }
  request.attempts = std::move(allowed);
  return is_postponed;
}

bool may_know_all_tasks(const Caller& caller) {
  return !access::is_narrowed(caller) && !access::refusal_of(caller, AdminVerb::ListTasks);
}

/// A robot that is known already is taken only under a label of the caller's.
runtime::RobotRegistry::LabelRule rule_for(const Caller& caller) {
  if (caller.robots.empty())
    return {};
  return
      [caller](const std::string& label) { return access::refusal_of_known_robot(caller, label); };
}

}  // namespace

void register_robot(service::RegistrationService& registration, const Caller& caller,
                    RobotDescription description,
                    const std::function<void(const RegisterReply&)>& done) {
  if (const auto refusal = access::refusal_of_registration(caller, description.label))
    return registration.refuse(description.label, refusal->message, done);
  if (!access::is_narrowed(caller))
    return registration.register_robot(std::move(description), done, caller.client);
  registration.register_robot(
      std::move(description),
      [caller, done](RegisterReply reply) {
        std::erase_if(reply.same_arms, [&](const std::string& label) {
          return !access::may_see(caller, "", label);
        });
        done(reply);
      },
      caller.client, rule_for(caller));
}

void report(service::ReportService& reports, service::RegistrationService& robots,
            const Caller& caller, ReportRequest request,
            const std::function<void(const ReportReply&)>& done) {
  if (caller.name.empty())
    return reports.report(std::move(request), done, caller.client);
  std::set<Digest> reporting;
  if (!caller.robots.empty())
    for (const Attempt& attempt : request.attempts)
      reporting.insert(attempt.robot);
  robots.name_robots(
      reporting,
      [&reports, caller, request = std::move(request), done](const RobotLabels& labels) mutable {
        const bool is_postponed = keep_allowed(request, caller, labels);
        reports.report(
            std::move(request),
            [done, is_postponed](ReportReply reply) {
              if (is_postponed)
                reply.retry_after = std::max(reply.retry_after, service::TaskPools::kRetryAfter);
              done(reply);
            },
            caller.client);
      },
      caller.client);
}

void fetch(service::FetchService& fetches, service::RegistrationService& robots,
           const Caller& caller, const FetchRequest& request, const std::string& waiter,
           const std::function<void(const FetchReply&)>& done) {
  if (const auto refusal = access::refusal_of_fetch(caller, request.task, ""))
    return fetches.refuse(refusal->message, done);
  if (!may_know_all_tasks(caller) && !access::withholds_sources(caller))
    return fetches.fetch(request, waiter, [done](FetchReply reply) {
      reply.message = without_suggestion(std::move(reply.message));
      done(reply);
    });
  if (!access::withholds_sources(caller))
    return fetches.fetch(request, waiter, done);
  const auto for_its_robots = [caller, robot = request.robot, done](FetchReply reply) {
    access::withhold_sources(caller, robot, reply);
    reply.message = without_suggestion(std::move(reply.message));
    done(reply);
  };
  robots.name_robots(
      {request.robot},
      [&fetches, caller, request, waiter, done, for_its_robots](const RobotLabels& labels) {
        const auto robot = labels.find(request.robot);
        if (robot != labels.end() && !robot->second)
          return fetches.postpone(why_not_now(request.robot, robot->second.error()), done);
        if (robot != labels.end())
          if (const auto refusal =
                  access::refusal_of_fetch(caller, request.task, robot->second.value()))
            return fetches.refuse(refusal->message, done);
        fetches.fetch(request, waiter, for_its_robots);  // which says which robot is not registered
      },
      caller.client);
}

}  // namespace kinship::app
