#pragma once

#include <span>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/summaries.hpp"
#include "server/catalog/advice_cache.hpp"
#include "server/runtime/robot_registry.hpp"
#include "server/service/event_feed.hpp"

/// Events of the service, for people who watch.
namespace kinship::service {

void publish_registered(EventFeed& feed, const RobotDescription& description,
                        const RegisterReply& reply);

/// One event per robot and task of a batch, and one for its refused attempts.
/// \param robots  knows labels.
void publish_report(EventFeed& feed, const runtime::RobotRegistry& robots,
                    std::span<const catalog::AttemptCost> costs, std::span<const Receipt> receipts);

/// Attempts that were refused before their robot was known.
void publish_refused(EventFeed& feed, std::span<const Receipt> receipts);

/// A fetch of a task's experience alone names no robot: it is answered UnknownRobot, with the
/// experience, and is no refusal.
void publish_fetch(EventFeed& feed, const runtime::RobotRegistry& robots,
                   const FetchRequest& request, const FetchReply& reply);

void publish_fit(EventFeed& feed, const runtime::RobotRegistry& robots,
                 const Distribution& distribution);

void publish_job(EventFeed& feed, const Job& job);

/// The label of a robot in memory, else its short digest.
std::string name_of(const runtime::RobotRegistry& robots, const Digest& robot);

}  // namespace kinship::service
