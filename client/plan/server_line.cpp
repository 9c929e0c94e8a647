#include "client/plan/server_line.hpp"

#include <ostream>

namespace kinship::plan {

ServerLine::ServerLine(const PlanOptions& options, const RobotDescription& description,
                       std::ostream& messages)
    : options_(options), description_(description), messages_(messages) {
  if (options_.guidance == GuidanceMode::None && !options_.report)
    return;
  link::ClientOptions link;
  link.domain = options_.domain;
  link.outbox = options_.outbox;
  link.timeout = options_.timeout;
  client_ = std::make_unique<link::Client>(link);
  registered_ = register_robot();
}

bool ServerLine::register_robot() {
  const Result<RegisterReply> reply = client_->register_robot(description_);
  if (!reply) {
    messages_ << "robot '" << description_.label << "' not registered: " << reply.error().message
              << '\n';
    return false;
  }
  if (reply->status == RegisterStatus::Refused)
    throw Failure(ErrorCode::InvalidInput,
                  "the server refused robot '" + description_.label + "': " + reply->message);
  return true;
}

NoGuidance ServerLine::fetch_guidance(const GuidanceWish& wish,
                                      const std::vector<ProblemLine>& lines) {
  if (options_.guidance == GuidanceMode::None)
    return NoGuidance::None;
  if (!registered_) {
    messages_ << "guidance: none, no server answered\n";
    return NoGuidance::NoServer;
  }
  guidance_ = std::make_unique<GuidanceBook>(
      [this](const FetchRequest& request) { return client_->fetch(request); }, wish);
  NoGuidance why_not = NoGuidance::None;
  for (const ProblemLine& line : lines) {
    if (!line.problem)
      continue;
    const auto [answer, is_new] = guidance_->ask(line.problem->T_task_base);
    if (!is_new)
      continue;
    const std::string outcome = answer.guidance ? "" : "none, ";
    messages_ << "guidance for the placement of '" << line.problem->name << "': " << outcome
              << answer.message << '\n';
    if (why_not == NoGuidance::None)
      why_not = answer.why_not;
  }
  return why_not;
}

const Guidance* ServerLine::guidance(const std::optional<Eigen::Isometry3d>& T_task_base) const {
  return guidance_ ? guidance_->find(T_task_base) : nullptr;
}

void ServerLine::report(const Attempt& attempt) {
  try {
    client_->report(attempt);
    ++reported_;
  } catch (const Failure& failure) {
    if (unreportable_++ == 0)
      messages_ << "an attempt could not be reported: " << failure.what() << '\n';
  }
}

void ServerLine::finish() {
  if (!client_ || !options_.report)
    return;
  if (!registered_)
    registered_ = register_robot();
  const auto deadline = registered_ ? options_.timeout : std::chrono::milliseconds(0);
  const link::Client::OutboxState state = client_->flush(deadline);
  messages_ << "reports: " << reported_ << " attempts; outbox: " << state.accepted
            << " acknowledged, " << state.pending << " pending, " << state.refused << " refused";
  if (unreportable_ > 0)
    messages_ << "; " << unreportable_ << " attempts could not be kept";
  if (state.pending > 0)
    messages_ << " (pending reports are sent when the outbox is next used)";
  messages_ << std::endl;
}

}  // namespace kinship::plan
