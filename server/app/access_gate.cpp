#include "server/app/access_gate.hpp"

#include <algorithm>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/access/access.hpp"
#include "server/access/withheld_sources.hpp"

namespace kinship::app {
namespace {

using RobotLabels = service::Service::RobotLabels;

/// The label of a robot as far as a narrowed caller's certificate needs it.
struct KnownLabel {
  std::string label;                     ///< empty: it does not matter
  std::optional<ReceiptStatus> trouble;  ///< it cannot be told now
  std::string why = {};
};

KnownLabel look_up(const Caller& caller, const RobotLabels& labels, const Digest& robot) {
  if (caller.robots.empty())
    return {};
  const auto found = labels.find(robot);
  if (found == labels.end())
    return {{}, ReceiptStatus::UnknownRobot, "robot " + robot.short_hex() + " is not registered"};
  if (!found->second)
    return {{}, ReceiptStatus::TryAgain, found->second.error().message};
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

void keep_allowed(ReportRequest& request, const Caller& caller, const RobotLabels& labels) {
  std::vector<Attempt> allowed;
  for (Attempt& attempt : request.attempts) {
    if (auto receipt = receipt_against(caller, labels, attempt)) {
      request.refused.push_back(std::move(*receipt));
      continue;
    }
    attempt.machine = caller.name;
    allowed.push_back(std::move(attempt));
  }
  request.attempts = std::move(allowed);
}

}  // namespace

void register_robot(service::Service& service, const Caller& caller, RobotDescription description,
                    const std::function<void(const RegisterReply&)>& done) {
  if (const auto refusal = access::refusal_of_registration(caller, description.label))
    return service.refuse_registration(description.label, refusal->message, done);
  if (!access::is_narrowed(caller))
    return service.register_robot(std::move(description), done, caller.client);
  service.register_robot(
      std::move(description),
      [caller, done](RegisterReply reply) {
        std::erase_if(reply.same_arms, [&](const std::string& label) {
          return !access::may_see(caller, "", label);
        });
        done(reply);
      },
      caller.client);
}

void report(service::Service& service, const Caller& caller, ReportRequest request,
            const std::function<void(const ReportReply&)>& done) {
  if (caller.name.empty())
    return service.report(std::move(request), done, caller.client);
  std::set<Digest> robots;
  if (!caller.robots.empty())
    for (const Attempt& attempt : request.attempts)
      robots.insert(attempt.robot);
  service.name_robots(
      robots,
      [&service, caller, request = std::move(request), done](const RobotLabels& labels) mutable {
        keep_allowed(request, caller, labels);
        service.report(std::move(request), done, caller.client);
      },
      caller.client);
}

void fetch(service::Service& service, const Caller& caller, const FetchRequest& request,
           const std::string& waiter, const std::function<void(const FetchReply&)>& done) {
  if (const auto refusal = access::refusal_of_fetch(caller, request.task, ""))
    return service.refuse_fetch(refusal->message, done);
  if (!access::withholds_sources(caller))
    return service.fetch(request, waiter, done);
  const auto for_its_robots = [caller, robot = request.robot, done](FetchReply reply) {
    access::withhold_sources(caller, robot, reply);
    done(reply);
  };
  service.name_robots(
      {request.robot},
      [&service, caller, request, waiter, done, for_its_robots](const RobotLabels& labels) {
        const auto robot = labels.find(request.robot);
        if (robot != labels.end() && robot->second)
          if (const auto refusal =
                  access::refusal_of_fetch(caller, request.task, robot->second.value()))
            return service.refuse_fetch(refusal->message, done);
        service.fetch(request, waiter, for_its_robots);  // which says what is not registered
      },
      caller.client);
}

}  // namespace kinship::app
