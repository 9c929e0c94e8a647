#include "client/experiments/pipeline/experience_server.hpp"

#include <algorithm>
#include <chrono>

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

using namespace std::chrono_literals;

link::ClientOptions client_options(std::uint32_t domain) {
  link::ClientOptions options;
  options.domain = domain;
  options.has_outbox = false;  // the learning sets on disk can be handed over again
  options.timeout = 120s;
  return options;
}

bool is_durable(const Receipt& receipt) {
  return receipt.status == ReceiptStatus::Stored || receipt.status == ReceiptStatus::Duplicate ||
         receipt.status == ReceiptStatus::Recorded;
}

}  // namespace

ExperienceServer::ExperienceServer(const ServerProcess::Options& options,
                                   const std::vector<StudyMember>& fleet)
    : fleet_(fleet), process_(options), client_(client_options(options.domain)) {
  for (const StudyMember& member : fleet_) {
    const RegisterReply reply = client_.register_robot(member.robot.description).value_or_throw();
    if (reply.status == RegisterStatus::Refused)
      throw Failure(ErrorCode::InvalidInput,
                    "the server refuses robot '" + member.label() + "': " + reply.message);
  }
}

void ExperienceServer::report(const std::vector<Attempt>& attempts) {
  const std::vector<Receipt> receipts = client_.deliver(attempts).value_or_throw();
  for (const Receipt& receipt : receipts)
    if (!is_durable(receipt))
      throw Failure(
          ErrorCode::InvalidInput,
          "the server did not take attempt " + receipt.report_uuid.text() + ": " + receipt.message);
}

Fetched ExperienceServer::fetch(const DistributionWish& wish) {
  const StudyMember& target = fleet_.at(wish.target);
  FetchRequest request;
  request.task = wish.task;
  request.robot = target.digest;
  request.T_task_base = target.placed.T_task_base;
  request.profile = wish.profile;
  for (const std::size_t source : wish.sources)
    request.selection.sources.push_back(fleet_.at(source).digest);
  std::ranges::sort(request.selection.sources);
  request.deadline = 60s;
  request.experience_bytes = kDefaultExperienceBytes;
  request.rehearsed = wish.rehearsed;
  while (true) {
    FetchReply reply = client_.fetch(request).value_or_throw();
    if (reply.status == FetchStatus::Pending || reply.status == FetchStatus::Busy)
      continue;
    if (!reply.distribution)
      throw Failure(ErrorCode::NotFound, "no distribution of task '" + wish.task + "' for robot '" +
                                             target.label() + "': " + reply.message);
    if (wish.rehearsed && !(reply.rehearsal && reply.rehearsal->is_complete))
      continue;
    return {*std::move(reply.distribution), std::move(reply.experience).value_or(TaskExperience{}),
            std::move(reply.rehearsal)};
  }
}

}  // namespace kinship::experiments
