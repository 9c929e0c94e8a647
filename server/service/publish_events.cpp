#include "server/service/publish_events.hpp"

#include <algorithm>
#include <cstdio>
#include <map>
#include <utility>

#include "proto/types/enum_text.hpp"

namespace kinship::service {
namespace {

/// How the attempts of a robot and task fared.
struct Fate {
  std::size_t stored = 0, duplicate = 0, recorded = 0, later = 0;
};

void count(Fate& fate, ReceiptStatus status) {
  switch (status) {
    case ReceiptStatus::Stored:
      ++fate.stored;
      break;
    case ReceiptStatus::Duplicate:
      ++fate.duplicate;
      break;
    case ReceiptStatus::Recorded:
      ++fate.recorded;
      break;
    case ReceiptStatus::TryAgain:
    case ReceiptStatus::UnknownRobot:
      ++fate.later;
      break;
    case ReceiptStatus::Refused:
      break;
  }
}

void add_part(std::string& words, std::size_t number, const char* what) {
  if (number > 0)
    words += (words.empty() ? "" : ", ") + std::to_string(number) + what;
}

std::string describe(const Fate& fate) {
  std::string words;
  add_part(words, fate.stored, " stored");
  add_part(words, fate.recorded, " recorded");
  add_part(words, fate.duplicate, " known already");
  add_part(words, fate.later, " to be sent again");
  return words;
}

const char* describe(FetchStatus status) {
  switch (status) {
    case FetchStatus::Ready:
      return "ready";
    case FetchStatus::Pending:
      return "pending";
    case FetchStatus::NoExperience:
      return "no experience";
    case FetchStatus::UnknownRobot:
      return "unknown robot";
    case FetchStatus::Busy:
      return "busy";
    case FetchStatus::Refused:
      return "refused";
    case FetchStatus::Failed:
      return "failed";
  }
  return "";
}

std::string describe(const FetchReply& reply) {
  std::string words = describe(reply.status);
  if (reply.distribution)
    return words + ": distribution " + reply.distribution->id.short_hex() + " revision " +
           std::to_string(reply.distribution->revision);
  return reply.message.empty() ? words : words + ": " + reply.message;
}

std::string describe(const Distribution& distribution) {
  std::string words = distribution.id.short_hex() + " revision " +
                      std::to_string(distribution.revision) + ": " +
                      std::to_string(distribution.configurations) + " configurations, ";
  char seconds[48];
  std::snprintf(seconds, sizeof seconds, "transfer %.2f s, fit %.2f s",
                distribution.transfer_time_s, distribution.fit_time_s);
  words += seconds;
  if (distribution.fit)
    words += ", " + describe(*distribution.fit);
  if (distribution.state == DistributionState::Failed)
    words += ", failed";
  return distribution.reason.empty() ? words : words + ": " + distribution.reason;
}

}  // namespace

std::string name_of(const runtime::RobotRegistry& robots, const Digest& robot) {
  const runtime::RobotRegistry::RobotPointer known = robots.find_in_memory(robot);
  return known ? known->label : robot.short_hex();
}

void publish_registered(EventFeed& feed, const RobotDescription& description,
                        const RegisterReply& reply) {
  if (reply.status == RegisterStatus::Refused)
    return feed.tell(EventKind::Refusal, {}, description.label,
                     [&] { return "registration refused: " + reply.message; });
  feed.tell(EventKind::Registered, {}, description.label, [&] {
    return (reply.status == RegisterStatus::Known ? "known as " : "new, ") +
           reply.robot.short_hex() + ", " + std::to_string(reply.dof) + " joints, " + reply.solver +
           (reply.took_geometry ? "; better geometry: " + reply.geometry : "");
  });
}

void publish_report(EventFeed& feed, const runtime::RobotRegistry& robots,
                    std::span<const catalog::AttemptCost> costs,
                    std::span<const Receipt> receipts) {
  std::map<std::pair<std::string, Digest>, Fate> fates;
  for (std::size_t i = 0; i < std::min(costs.size(), receipts.size()); ++i)
    if (receipts[i].status != ReceiptStatus::Refused)
      count(fates[{costs[i].task, costs[i].robot}], receipts[i].status);
  for (const auto& [whose, fate] : fates)
    feed.tell(EventKind::Report, whose.first, name_of(robots, whose.second),
              [&fate = fate] { return describe(fate); });
  publish_refused(feed, receipts);
}

void publish_refused(EventFeed& feed, std::span<const Receipt> receipts) {
  const auto is_refused = [](const Receipt& receipt) {
    return receipt.status == ReceiptStatus::Refused;
  };
  const auto first = std::find_if(receipts.begin(), receipts.end(), is_refused);
  if (first == receipts.end())
    return;
  feed.tell(EventKind::Refusal, {}, {}, [&] {
    return std::to_string(std::count_if(first, receipts.end(), is_refused)) + " of " +
           std::to_string(receipts.size()) + " attempts refused, first: " + first->message;
  });
}

void publish_fetch(EventFeed& feed, const runtime::RobotRegistry& robots,
                   const FetchRequest& request, const FetchReply& reply) {
  if (request.robot == Digest() && request.experience_bytes > 0 &&
      reply.status == FetchStatus::UnknownRobot)
    return feed.tell(EventKind::Fetch, request.task, {},
                     [] { return std::string("the task's experience, for no robot"); });
  const bool is_refused =
      reply.status == FetchStatus::Refused || reply.status == FetchStatus::UnknownRobot;
  feed.tell(is_refused ? EventKind::Refusal : EventKind::Fetch, request.task,
            name_of(robots, request.robot),
            [&] { return is_refused ? "fetch: " + describe(reply) : describe(reply); });
}

void publish_fit(EventFeed& feed, const runtime::RobotRegistry& robots,
                 const Distribution& distribution) {
  feed.tell(EventKind::Fit, distribution.task, name_of(robots, distribution.robot),
            [&] { return describe(distribution); });
}

void publish_job(EventFeed& feed, const Job& job) {
  feed.tell(EventKind::Administration, {}, {}, [&] {
    return "job " + job.id + ", " + job.verb + " '" + job.argument +
           "': " + std::string(to_text(job.state)) +
           (job.message.empty() ? "" : ", " + job.message);
  });
}

}  // namespace kinship::service
