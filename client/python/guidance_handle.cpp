#include "client/python/guidance_handle.hpp"

#include <string>

#include "proto/types/enum_text.hpp"

namespace kinship::python {

std::shared_ptr<GuidanceHandle> GuidanceHandle::of_distribution(
    const SampledDistribution& distribution) {
  guided::GuidanceOptions wanted;
  wanted.task = distribution.value()->task;
  wanted.robot = distribution.value()->robot;
  wanted.dof = distribution.mixture().dimension();
  wanted.guide = Guide::Mixture;
  wanted.sampling.control_fraction = 0;
  const auto fetch = [&](const FetchRequest&) -> Result<FetchReply> {
    FetchReply reply;
    reply.status = FetchStatus::Ready;
    reply.distribution = *distribution.value();
    return reply;
  };
  guided::GuidanceAnswer answer = guided::fetch_guidance(fetch, wanted, std::nullopt);
  if (!answer.guidance)
    throw Failure(ErrorCode::InvalidInput, answer.message);
  return std::make_shared<GuidanceHandle>(wanted.robot, std::move(answer));
}

std::shared_ptr<GuidanceHandle> GuidanceHandle::of_robot(const Robot& robot, Guide guide) {
  if (needs_experience(guide))
    throw Failure(
        ErrorCode::InvalidInput,
        "guide '" + std::string(to_text(guide)) +
            "' needs the experience of a task: Client.guidance(); retreat and none do not");
  guided::GuidanceOptions wanted;
  wanted.robot = robot.digest();
  wanted.chain = robot.chain();
  wanted.guide = guide;
  wanted.sampling.control_fraction = 0;
  return std::make_shared<GuidanceHandle>(wanted.robot,
                                          guided::fetch_guidance({}, wanted, std::nullopt));
}

double GuidanceHandle::guided_part() const {
  const std::scoped_lock lock(mutex_);
  return answer_.sampling->guided_part();
}

SamplingMode GuidanceHandle::choose(const Problem& problem) const {
  const std::scoped_lock lock(mutex_);
  return answer_.sampling->choose(guided::sampling_mode_seed(problem));
}

double GuidanceHandle::recall_trust() const {
  const std::scoped_lock lock(mutex_);
  return recall_trust_.value();
}

void GuidanceHandle::add(const guided::PlannedProblem& planned) {
  const std::scoped_lock lock(mutex_);
  recall_trust_.add(planned.recall_expected, planned.result.found_by == FoundBy::Recalled);
  answer_.sampling->add(planned.result.sampling_mode, planned.outcome,
                        planned.result.collision_checks);
}

}  // namespace kinship::python
