#include "client/plan/server_line.hpp"

#include <exception>
#include <ostream>

namespace kinship::plan {
namespace {

Result<RegisterReply> ask_to_register(link::Client& client, const RobotDescription& description) {
  try {
    return client.register_robot(description);
  } catch (const std::exception& exception) {
    return Error{ErrorCode::Internal, exception.what()};
  }
}

}  // namespace

ServerLine::ServerLine(const PlanOptions& options, const RobotDescription& description,
                       std::ostream& messages)
    : options_(options), description_(description), messages_(messages) {
  if (options_.guidance == GuidanceMode::None && !options_.report)
    return;
  link::ClientOptions client;
  client.domain = options_.domain;
  client.has_outbox = options_.report;  // who only looks delivers nothing
  client.outbox = options_.outbox;
  client.timeout = options_.timeout;
  try {
    client_ = std::make_unique<link::Client>(client);
    register_robot();
  } catch (const std::exception& exception) {
    trouble_ = Error{ErrorCode::Internal, exception.what()};
    messages_ << "no line to a server: " << exception.what() << '\n';
  }
}

void ServerLine::register_robot() {
  const Result<RegisterReply> reply = ask_to_register(*client_, description_);
  trouble_.reset();
  if (!reply)
    trouble_ = reply.error();
  else if (reply->status == RegisterStatus::Refused)
    trouble_ = Error{ErrorCode::InvalidInput, "the server refused it: " + reply->message};
  if (trouble_)
    messages_ << "robot '" << description_.label << "' not registered: " << trouble_->message
              << '\n';
}

NoGuidance ServerLine::fetch_guidance(const GuidanceWish& wish,
                                      const std::vector<ProblemLine>& lines) {
  if (options_.guidance == GuidanceMode::None)
    return NoGuidance::None;
  if (trouble_) {
    messages_ << "no guidance: " << trouble_->message << '\n';
    return trouble_->code == ErrorCode::Unavailable ? NoGuidance::NoServer : NoGuidance::Failed;
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

void ServerLine::report(const std::function<Attempt()>& make_attempt) {
  try {
    if (!client_)
      throw Failure(ErrorCode::Unavailable, "no line to a server");
    client_->report(make_attempt());
    ++reported_;
  } catch (const std::exception& exception) {
    if (unreportable_++ == 0)
      messages_ << "an attempt could not be reported: " << exception.what() << '\n';
  }
}

void ServerLine::finish() {
  if (!options_.report)
    return;
  if (client_ && trouble_)
    register_robot();
  messages_ << "reports: " << reported_ << " attempts";
  try {
    if (client_)
      flush();
  } catch (const std::exception& exception) {
    messages_ << "; the outbox could not be emptied: " << exception.what();
  }
  if (unreportable_ > 0)
    messages_ << "; " << unreportable_ << " attempts could not be kept";
  messages_ << std::endl;
}

void ServerLine::flush() {
  const auto deadline = trouble_ ? std::chrono::milliseconds(0) : options_.timeout;
  const link::Client::OutboxState state = client_->flush(deadline);
  messages_ << "; outbox: " << state.accepted << " acknowledged, " << state.pending << " pending, "
            << state.refused << " refused";
  if (state.pending > 0)
    messages_ << " (pending reports are sent when the outbox is next used)";
}

}  // namespace kinship::plan
