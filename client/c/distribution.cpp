#include <algorithm>
#include <chrono>
#include <string>
#include <utility>

#include "client/c/errors.hpp"
#include "client/c/handles.hpp"
#include "client/link/reported_placement.hpp"

namespace kinship::c_library {
namespace {

using SharedDistribution = std::shared_ptr<const Distribution>;

FetchRequest read_request(const kinship_request& given) {
  require(given.task, "request->task");
  FetchRequest request;
  request.task = given.task;
  request.robot = read_robot(given.robot, "request->robot");
  if (given.T_task_base != nullptr)
    request.T_task_base = read_pose(given.T_task_base, "request->T_task_base");
  if (given.profile != nullptr)
    request.profile = given.profile;
  request.deadline = std::chrono::milliseconds(given.deadline_ms);
  return request;
}

/// The same for paths to recall.
FetchRequest read_recall_request(const kinship_request& given) {
  FetchRequest request = read_request(given);
  request.experience_bytes = kDefaultExperienceBytes;
  if (given.start != nullptr) {
    if (given.start_dof < 1 || given.start_dof > kMaxDof)
      throw Failure(invalid_input("request->start_dof is " + std::to_string(given.start_dof) +
                                  ", must be 1 to " + std::to_string(kMaxDof)));
    request.start.assign(given.start, given.start + given.start_dof);
  }
  if (given.T_task_goal != nullptr)
    request.T_task_goal = read_pose(given.T_task_goal, "request->T_task_goal");
  request.to_configuration = given.to_configuration != 0;
  return request;
}

/// Without a placement: where the robot stood when it last reported the task, as far as the server
/// tells.
void place(FetchRequest& request, kinship_client& client) {
  if (request.T_task_base)
    return;
  const auto reported = link::reported_placement(client.line, request.task, request.robot.hex());
  if (!reported)
    throw Failure(reported.error().code,
                  "request->T_task_base is NULL, and where the robot last "
                  "reported the task is not told: " +
                      reported.error().message);
  request.T_task_base = reported->T_task_base;
}

/// Why a fetch brought no distribution.
kinship_code explain(const FetchReply& reply, const std::string& task) {
  const auto say = [&](kinship_code code, const std::string& otherwise) {
    return remember(code, reply.message.empty() ? otherwise : reply.message);
  };
  switch (reply.status) {
    case FetchStatus::Pending:
      return say(KINSHIP_PENDING, "the distribution of task '" + task + "' is still being made");
    case FetchStatus::NoExperience:
      return say(KINSHIP_NO_EXPERIENCE, "no experience with task '" + task + "'");
    case FetchStatus::UnknownRobot:
      return say(KINSHIP_UNKNOWN_ROBOT, "the server does not know this robot");
    case FetchStatus::Busy:
      return say(KINSHIP_UNAVAILABLE, "the server is busy");
    case FetchStatus::Failed:
      return remember(KINSHIP_NO_EXPERIENCE, reply.distribution
                                                 ? reply.distribution->reason
                                                 : "nothing could be transferred or fitted");
    case FetchStatus::Ready:
    case FetchStatus::Refused:
      break;
  }
  return say(KINSHIP_REFUSED, "the server sent no distribution");
}

/// Why a follower holds none.
kinship_code explain(const link::Follower::State& state) {
  switch (state.status) {
    case link::FollowStatus::NoServer:
      return remember(KINSHIP_UNAVAILABLE, state.reason);
    case link::FollowStatus::NoExperience:
    case link::FollowStatus::Failed:
      return remember(KINSHIP_NO_EXPERIENCE, state.reason);
    case link::FollowStatus::UnknownRobot:
      return remember(KINSHIP_UNKNOWN_ROBOT, state.reason);
    case link::FollowStatus::Refused:
      return remember(KINSHIP_REFUSED, state.reason);
    case link::FollowStatus::Ready:
    case link::FollowStatus::Pending:
      break;
  }
  return remember(KINSHIP_PENDING, state.reason);
}

bool is_same(const SharedDistribution& a, const SharedDistribution& b) {
  return a == b || (a && b && a->revision == b->revision && a->store_epoch == b->store_epoch &&
                    a->id == b->id);
}

}  // namespace
}  // namespace kinship::c_library

using namespace kinship::c_library;

kinship_code kinship_fetch(kinship_client* client, const kinship_request* request,
                           kinship_distribution** distribution) {
  return guarded([&] {
    require(client, "client");
    require(distribution, "distribution");
    *distribution = nullptr;
    kinship::FetchRequest wanted = read_request(read_structure(request, "request"));
    place(wanted, *client);
    const auto reply = client->line.fetch(wanted);
    if (!reply)
      return remember(reply.error());
    if (reply->status != kinship::FetchStatus::Ready || !reply->distribution ||
        !reply->distribution->mixture)
      return explain(*reply, wanted.task);
    *distribution = new kinship_distribution{
        std::make_shared<const kinship::Distribution>(*reply->distribution)};
    return KINSHIP_OK;
  });
}

kinship_code kinship_fetch_recall(kinship_client* client, const kinship_request* request,
                                  kinship_recall** recall) {
  return guarded([&] {
    require(client, "client");
    require(recall, "recall");
    *recall = nullptr;
    const kinship_request given = read_structure(request, "request");
    const kinship::kinematics::Chain chain =
        client->chain_of(read_robot(given.robot, "request->robot"));
    kinship::FetchRequest wanted = read_recall_request(given);
    place(wanted, *client);
    wanted.rehearsed = wanted.deadline.count() > 0;
    const auto reply = client->line.fetch(wanted);
    if (!reply)
      return remember(reply.error());
    if (reply->recall && !reply->recall->paths.empty()) {
      *recall = new kinship_recall(chain, *reply->recall, wanted.T_task_base);
      return KINSHIP_OK;
    }
    const bool is_ready = reply->status == kinship::FetchStatus::Ready;
    const bool is_rehearsed = reply->rehearsal && reply->rehearsal->is_complete;
    if ((is_ready || reply->status == kinship::FetchStatus::Failed) && !is_rehearsed)
      return remember(KINSHIP_PENDING,
                      "paths to recall for task '" + wanted.task + "' are still being made");
    if (!is_ready)
      return explain(*reply, wanted.task);
    return remember(KINSHIP_NO_EXPERIENCE, "no paths to recall for task '" + wanted.task + "'");
  });
}

void kinship_distribution_free(kinship_distribution* distribution) { delete distribution; }

kinship_code kinship_distribution_describe(const kinship_distribution* distribution,
                                           kinship_distribution_info* info) {
  return guarded([&] {
    require(distribution, "distribution");
    const kinship::Distribution& value = *distribution->value;
    kinship_distribution_info told{};
    told.dof = static_cast<size_t>(value.mixture->dimension());
    told.components = static_cast<size_t>(value.mixture->size());
    told.revision = value.revision;
    for (const kinship::Source& source : value.sources)
      told.paths += source.paths;
    told.recommended_share = value.advice.recommended_share;
    write_structure(told, info, "info");
    return KINSHIP_OK;
  });
}

kinship_code kinship_distribution_copy(const kinship_distribution* distribution, double* weights,
                                       double* means, double* covariances) {
  return guarded([&] {
    require(distribution, "distribution");
    const kinship::Mixture& mixture = *distribution->value->mixture;
    if (weights != nullptr)
      std::copy_n(mixture.weights().data(), mixture.weights().size(), weights);
    if (means != nullptr)
      std::copy_n(mixture.means().data(), mixture.means().size(), means);
    for (Eigen::Index k = 0; covariances != nullptr && k < mixture.size(); ++k) {
      const Eigen::MatrixXd& covariance = mixture.covariance(k);  // symmetric: rows or columns
      covariances = std::copy_n(covariance.data(), covariance.size(), covariances);
    }
    return KINSHIP_OK;
  });
}

kinship_code kinship_follower_open(kinship_client* client, const kinship_request* request,
                                   kinship_follower** follower) {
  return guarded([&] {
    require(client, "client");
    require(follower, "follower");
    *follower = nullptr;
    const kinship_request given = read_structure(request, "request");
    const kinship::link::FollowOptions options{.asks_placement = true};
    if (given.with_recall == 0) {
      *follower = new kinship_follower{client->line.follow(read_request(given), options)};
      return KINSHIP_OK;
    }
    kinship::kinematics::Chain chain = client->chain_of(read_robot(given.robot, "request->robot"));
    *follower = new kinship_follower{client->line.follow(read_recall_request(given), options),
                                     std::move(chain)};
    return KINSHIP_OK;
  });
}

void kinship_follower_close(kinship_follower* follower) { delete follower; }

kinship_code kinship_follower_newer(kinship_follower* follower, const kinship_distribution* held,
                                    uint32_t timeout_ms, kinship_distribution** distribution) {
  return guarded([&] {
    require(follower, "follower");
    require(distribution, "distribution");
    *distribution = nullptr;
    const SharedDistribution known = held == nullptr ? nullptr : held->value;
    const auto deadline = std::chrono::steady_clock::now() + std::chrono::milliseconds(timeout_ms);
    const SharedDistribution newest = timeout_ms == 0
                                          ? follower->value->newest()
                                          : follower->value->wait_for_newer(known, deadline);
    if (!newest)
      return explain(follower->value->state());
    if (is_same(newest, known))
      return remember(KINSHIP_PENDING, "the distribution that is held is the newest");
    *distribution = new kinship_distribution{newest};
    return KINSHIP_OK;
  });
}

kinship_code kinship_follower_recall(kinship_follower* follower, const kinship_recall* held,
                                     kinship_recall** recall) {
  return guarded([&] {
    require(follower, "follower");
    require(recall, "recall");
    *recall = nullptr;
    if (!follower->chain)
      return remember(KINSHIP_INVALID_INPUT, "the follower's request said no with_recall");
    const std::shared_ptr<const kinship::RecallLibrary> newest = follower->value->recall();
    if (newest)
      follower->had_paths = true;
    else if (held != nullptr && follower->had_paths)
      return remember(KINSHIP_NO_EXPERIENCE, "the paths that are held were taken back");
    else
      return remember(KINSHIP_PENDING, "no paths to recall have come yet");
    if (held != nullptr && held->guide.library().revision == newest->revision)
      return remember(KINSHIP_PENDING, "the paths that are held are the newest");
    *recall = new kinship_recall(*follower->chain, *newest, follower->value->T_task_base());
    return KINSHIP_OK;
  });
}
