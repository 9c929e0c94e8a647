#include "client/planner/server_line.hpp"

#include <exception>
#include <future>
#include <ostream>
#include <utility>

#include "client/link/host_name.hpp"
#include "client/link/robot_names.hpp"
#include "robots/models/loaded_robot.hpp"

namespace kinship::planner {
namespace {

guided::NoGuidance why_not(const Error& error) {
  switch (error.code) {
    case ErrorCode::Unavailable:
      return guided::NoGuidance::NoServer;
    case ErrorCode::NotFound:
      return guided::NoGuidance::NotFound;
    default:
      return guided::NoGuidance::Failed;
  }
}

}  // namespace

ServerLine::ServerLine(const PlanOptions& options, kinematics::RobotModel robot, FitRobot fit,
                       std::ostream& messages, const std::function<bool()>& stop)
    : options_(options),
      robot_(std::move(robot)),
      fit_(std::move(fit)),
      messages_(messages),
      stop_(stop) {
  if (options_.guidance == GuidanceMode::Uniform)
    why_unguided_ = options_.task.empty() ? "no task is named" : "--guidance uniform";
  if (!options_.needs_experience() && !options_.report)
    return;
  link::ClientOptions client;
  client.domain = options_.domain;
  client.server = options_.server;
  client.security = options_.security;
  client.has_outbox = options_.report;  // a client that only looks delivers nothing
  client.outbox = options_.outbox;
  client.resend = options_.resend;
  client.timeout = options_.timeout;
  if (const std::string why = link::why_unknown(options_.server); !why.empty())
    messages_ << "--server '" << options_.server << "': " << why << '\n';  // it may be, later
  try {
    client_ = std::make_unique<link::Client>(client);
    if (const auto warning = client_->expiry_warning())
      messages_ << "warning: " << *warning << '\n';
    register_robot();
  } catch (const std::exception& exception) {
    trouble_ = Error{ErrorCode::Internal, exception.what()};
    messages_ << "no line to a server: " << exception.what() << '\n';
  }
}

template <typename Reply>
Result<Reply> ServerLine::wait_for(const std::function<Result<Reply>()>& call) {
  constexpr std::chrono::milliseconds kPatience{50};
  auto reply = std::async(std::launch::async, call);
  while (reply.wait_for(kPatience) != std::future_status::ready)
    if (stop_())
      client_->cancel();
  try {
    return reply.get();
  } catch (const std::exception& exception) {
    return Error{ErrorCode::Internal, exception.what()};
  }
}

Result<RegisterReply> ServerLine::send_description() {
  return wait_for<RegisterReply>([this] { return client_->register_robot(robot_); });
}

/// \return whether there are any, which were not there before.
bool ServerLine::add_mesh_solids() {
  if (!robot_.description.mesh_solids.solids.empty())
    return false;
  Result<collision::FittedRobot> fitted = fit_();
  if (!fitted)
    messages_ << "robot '" << robot_.description.label
              << "': no solids around its meshes: " << fitted.error().message << '\n';
  else
    robot_.description.mesh_solids = std::move(fitted).value().mesh_solids;
  return !robot_.description.mesh_solids.solids.empty();
}

/// \return whether there are any, which were not there before.
bool ServerLine::add_meshes() {
  if (!robot_.description.meshes.empty())
    return false;
  const auto notes = models::add_meshes(options_.robot, robot_);
  if (!notes)
    messages_ << "robot '" << robot_.description.label << "': no meshes: " << notes.error().message
              << '\n';
  else
    for (const std::string& note : *notes)
      messages_ << "robot '" << robot_.description.label << "': " << note << '\n';
  return !robot_.description.meshes.empty();
}

void ServerLine::register_robot() {
  if (options_.robot.without_meshes)
    client_->forget_meshes(robot_.chain.digest());
  Result<RegisterReply> reply = send_description();
  // A server that does not tell has no use for them.
  const bool is_taken = reply && reply->status != RegisterStatus::Refused;
  const bool has_solids = is_taken && !reply->geometry.empty() &&
                          reply->geometry_grade < GeometryGrade::Approximate && add_mesh_solids();
  const bool has_meshes = is_taken && !reply->meshes.empty() &&
                          reply->geometry_grade < GeometryGrade::Exact && add_meshes();
  if (has_solids || has_meshes)
    reply = send_description();
  if (reply && !reply->geometry.empty() && reply->geometry_grade != GeometryGrade::Exact)
    messages_ << "robot '" << robot_.description.label
              << "', as the server filters for it: " << reply->geometry << '\n';
  trouble_.reset();
  is_robot_refused_ = reply && reply->status == RegisterStatus::Refused;
  if (!reply)
    trouble_ = reply.error();
  else if (is_robot_refused_)
    trouble_ = Error{ErrorCode::InvalidInput, "the server refused it: " + reply->message};
  if (trouble_)
    messages_ << "robot '" << robot_.description.label << "' not registered: " << trouble_->message
              << '\n';
  else if (!reply->message.empty())
    messages_ << "robot '" << robot_.description.label << "': " << reply->message << '\n';
}

/// \return nothing, or why the named robots cannot be the sources.
std::optional<Error> ServerLine::find_sources(Selection& selection) {
  if (options_.sources.empty())
    return std::nullopt;
  Result<std::vector<Digest>> robots = wait_for<std::vector<Digest>>(
      [this] { return link::resolve_robots(*client_, options_.sources); });
  if (!robots)
    return robots.error();
  selection.sources = *std::move(robots);
  return std::nullopt;
}

guided::NoGuidance ServerLine::fetch_guidance(guided::GuidanceOptions wanted,
                                              const std::vector<ProblemLine>& lines) {
  if (options_.guidance == GuidanceMode::Uniform)
    return guided::NoGuidance::None;
  std::optional<Error> trouble;
  if (options_.needs_experience())
    trouble = trouble_ ? trouble_ : find_sources(wanted.selection);
  if (trouble) {
    messages_ << "no guidance, all is planned uniformly: " << trouble->message << '\n';
    why_unguided_ = trouble->message;
    return why_not(*trouble);
  }
  for (const ProblemLine& line : lines)
    if (line.problem && wanted.start.size() == 0)
      wanted.start = line.problem->start;
  const bool wants_all = wanted.selection.sources.empty() && wanted.selection.since_ms == 0;
  guidance_ = std::make_unique<guided::GuidanceCache>(
      [this](const FetchRequest& request) {
        return wait_for<FetchReply>([&] { return client_->fetch(request); });
      },
      std::move(wanted));
  guided::NoGuidance first_reason = guided::NoGuidance::None;
  bool begins_task = false;
  for (const ProblemLine& line : lines) {
    if (stop_())
      break;
    if (!line.problem)
      continue;
    const auto [answer, is_new] = guidance_->ask(*line.problem);
    if (!is_new)
      continue;
    const std::string outcome = answer.guidance ? "" : "none, ";
    messages_ << "guidance for the placement of '" << line.problem->name << "': " << outcome
              << answer.message << '\n';
    begins_task = begins_task || (answer.why_not == guided::NoGuidance::NoExperience && wants_all);
    if (first_reason == guided::NoGuidance::None)
      first_reason = answer.why_not;
  }
  if (options_.report && begins_task)
    messages_ << "--report: the server has no paths of task '" << options_.task
              << "': this run begins it under that name\n";
  return first_reason;
}

guided::QueryGuidance ServerLine::choose(const Problem& problem) const {
  return guidance_ ? guidance_->choose(problem) : guided::QueryGuidance{.why_not = why_unguided_};
}

void ServerLine::add(const guided::PlannedProblem& planned) {
  if (guidance_)
    guidance_->add(planned);
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

bool ServerLine::finish() {
  if (!options_.report)
    return true;
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
  if (!kept_.empty())
    messages_ << "outbox: " << kept_ << std::endl;
  return unreportable_ == 0;
}

void ServerLine::flush() {
  const auto deadline = trouble_ ? std::chrono::milliseconds(0) : options_.timeout;
  const link::Client::OutboxState state = client_->flush(deadline);
  messages_ << "; outbox: " << state.accepted << " acknowledged, " << state.pending << " pending, "
            << state.refused << " refused";
  if (state.set_aside > 0)
    messages_ << ", " << state.set_aside << " set aside ('kinship outbox list')";
  if (state.refused > 0)
    messages_ << " ('kinship outbox list'), the last because " << state.last_refusal;
  kept_ = link::describe(state.kept);
  if (state.pending > 0)
    messages_ << " (pending reports are sent when the outbox is next used)";
}

}  // namespace kinship::planner
