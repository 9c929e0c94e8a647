#include "client/link/client.hpp"

#include <algorithm>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <stdexcept>
#include <utility>

#include "client/link/admin_rows.hpp"
#include "client/link/delivery.hpp"
#include "client/link/environment.hpp"
#include "client/link/interruptible_sleep.hpp"
#include "client/link/mesh_upload.hpp"
#include "client/link/outbox.hpp"
#include "client/link/report_sender.hpp"
#include "proto/dds/participant.hpp"
#include "proto/dds/requester.hpp"
#include "proto/security/admin_token.hpp"
#include "proto/security/credentials.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::link {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr milliseconds kReceiptTime = 5s;  // for a batch to be stored, and a robot
constexpr std::string_view kWrongProof =
    "the proof of the token is wrong";          // of a server's refusal
constexpr milliseconds kShortestPause = 100ms;  // between two requests of one fetch

/// The server's share of the time that is left, so that its "pending" still arrives in time.
milliseconds server_share(milliseconds left) {
  return left - std::min<milliseconds>(200ms, left / 4);
}

/// Asks until the reply is final or the time is over: a server that is busy says when to ask again.
template <typename Reply>
Result<Reply> ask_until_final(Clock::time_point deadline, InterruptibleSleep& sleep,
                              const std::function<Result<Reply>()>& ask) {
  while (true) {
    Result<Reply> reply = ask();
    if (!reply || reply->retry_after <= 0ms)
      return reply;
    const auto pause = std::max<milliseconds>(reply->retry_after, kShortestPause);
    if (Clock::now() + pause >= deadline)
      return reply;
    sleep.sleep(pause);
  }
}

/// How long to wait before asking again; empty: the reply is final.
std::optional<milliseconds> pause_after(const Result<FetchReply>& reply) {
  if (!reply)
    return std::nullopt;
  if (reply->status == FetchStatus::Busy)
    return std::max(reply->retry_after, kShortestPause);
  if (reply->status == FetchStatus::Pending)
    return kShortestPause;
  return std::nullopt;
}

/// A robot that reports may be of.
struct Reported {
  std::string label;
  Eigen::Index joints = 0;
};

}  // namespace

/// The parts of a client; its header does not show their types.
struct Client::Line {
  explicit Line(const ClientOptions& options)
      : timeout(options.timeout),
        token(options.token.empty() ? token_from_environment() : options.token),
        participant(std::make_shared<const dds::Participant>(dds::ParticipantOptions{
            .domain = options.domain,
            .server = options.server,
            .security =
                options.security.empty() ? security_from_environment() : options.security})),
        registering(*participant, client_id),
        reporting(*participant, client_id),
        fetching(*participant, client_id),
        administering(*participant, client_id) {
    if (!options.has_outbox)
      return;
    outbox.emplace(options.outbox.empty() ? default_outbox_folder(options.domain, options.server)
                                          : options.outbox,
                   options.resend);
    sender.emplace(
        *outbox,
        [this](const ReportRequest& batch) {
          return reporting.call(batch, Clock::now() + kReceiptTime);
        },
        [this](const RobotDescription& description) {
          return register_robot(description, [this](const RobotDescription& part) {
            return registering.call(part, Clock::now() + kReceiptTime);
          });
        },
        Clock::now, [this] { return reporting.count_servers(); });
  }
  Line(const Line&) = delete;
  Line& operator=(const Line&) = delete;

  Result<RegisterReply> send(const kinematics::Chain& chain, const RobotDescription& description);
  Result<RegisterReply> send(const RobotDescription& description);
  void require_fit(const Attempt& attempt);
  Result<RegisterReply> register_robot(const RobotDescription& description,
                                       const RegisterOnce& register_once);

  const dds::OwningProcess process;
  const milliseconds timeout;
  const std::filesystem::path token;  // empty: none
  const Uuid client_id = Uuid::random();
  std::optional<Outbox> outbox;
  std::mutex robots_mutex;                                    // guards the next one
  std::map<Digest, Reported> robots;                          // that reports may be of
  const std::shared_ptr<const dds::Participant> participant;  // with followers and watchers
  dds::Requester<codec::RegisterConversation> registering;
  dds::Requester<codec::ReportConversation> reporting;
  dds::Requester<codec::FetchConversation> fetching;
  dds::Requester<codec::AdminConversation> administering;
  InterruptibleSleep sleep;
  std::mutex challenge_mutex;  // guards the next two
  std::string challenge;       // the server's last one
  Clock::time_point challenged;
  std::optional<ReportSender> sender;  // last: uses the outbox and requesters
};

Client::Client(const ClientOptions& options) : line_(std::make_unique<Line>(options)) {}

Client::~Client() {
  if (is_forked()) {
    static_cast<void>(line_.release());  // its threads, which its end waits for, are not here
    return;
  }
  cancel();
  line_->reporting.cancel();
}

std::optional<std::string> Client::expiry_warning() const {
  const auto& credentials = line_->participant->credentials();
  if (!credentials)
    return std::nullopt;
  return security::expiry_warning(
      *credentials, std::chrono::floor<std::chrono::seconds>(std::chrono::system_clock::now()));
}

Result<RegisterReply> Client::register_robot(const RobotDescription& description) {
  if (line_->outbox)
    // An unreadable robot has no reports; the server names its fault.
    if (const auto chain = kinematics::read_chain(description))
      return line_->send(*chain, description);
  return line_->send(description);
}

Result<RegisterReply> Client::register_robot(const kinematics::RobotModel& robot) {
  return line_->send(robot.chain, robot.description);
}

void Client::forget_meshes(const Digest& robot) {
  if (line_->outbox)
    line_->outbox->forget_meshes(robot);
}

Result<RegisterReply> Client::Line::send(const kinematics::Chain& chain,
                                         const RobotDescription& description) {
  if (outbox) {
    outbox->keep_robot(chain.digest(), description);
    const std::lock_guard lock(robots_mutex);
    robots[chain.digest()] = {description.label, chain.dof()};
  }
  return send(description);
}

/// \throws Failure if the outbox does not know the robot, or knows that it has other joints. A
///         description that is damaged tells neither.
void Client::Line::require_fit(const Attempt& attempt) {
  const std::lock_guard lock(robots_mutex);
  auto known = robots.find(attempt.robot);
  if (known == robots.end()) {
    const Result<RobotDescription> description = outbox->robot(attempt.robot);
    if (!description && description.error().code == ErrorCode::NotFound)
      throw Failure(ErrorCode::NotFound,
                    "robot " + attempt.robot.short_hex() +
                        " is known neither to this client nor to its outbox '" +
                        outbox->folder().string() + "': register it before its first report");
    const auto chain = description ? kinematics::read_chain(*description) : description.error();
    if (!chain)
      return;
    known = robots.emplace(attempt.robot, Reported{description->label, chain->dof()}).first;
  }
  const Reported& robot = known->second;
  if (attempt.path && attempt.path->dof() != robot.joints)
    throw Failure(ErrorCode::InvalidInput,
                  "robot '" + robot.label + "' (" + attempt.robot.short_hex() + ") has " +
                      std::to_string(robot.joints) + " joints, the report's path has " +
                      std::to_string(attempt.path->dof()));
}

/// With the contents of its meshes, of the description or of the outbox, which lets them go once
/// the server has them or takes none.
Result<RegisterReply> Client::Line::register_robot(const RobotDescription& description,
                                                   const RegisterOnce& register_once) {
  std::map<Digest, MeshContent> contents;
  for (const MeshContent& content : description.contents)
    if (const auto mesh = TriangleMesh::read(content))
      contents.emplace(mesh->digest(), content);
  const auto find = [&](const Digest& content) {
    const auto found = contents.find(content);
    if (found != contents.end())
      return std::optional(found->second);
    return outbox ? outbox->content(content) : std::nullopt;
  };
  Result<RegisterReply> reply = register_with_meshes(description, find, register_once);
  if (outbox && reply && reply->status != RegisterStatus::Refused && reply->wanted.empty())
    outbox->drop_contents(description);
  return reply;
}

Result<RegisterReply> Client::Line::send(const RobotDescription& description) {
  Result<RegisterReply> reply = register_robot(description, [&](const RobotDescription& part) {
    const Clock::time_point deadline = Clock::now() + timeout;
    return ask_until_final<RegisterReply>(deadline, sleep,
                                          [&] { return registering.call(part, deadline); });
  });
  if (sender && reply && reply->status != RegisterStatus::Refused)
    sender->retry();
  return reply;
}

void Client::report(const Attempt& attempt) {
  if (!line_->outbox)
    throw std::logic_error("Client: report() without an outbox");
  if (const auto error = validate(attempt))
    throw Failure(*error);
  line_->require_fit(attempt);
  line_->outbox->add(attempt);
  line_->sender->wake();
}

Client::OutboxState Client::outbox() const {
  if (!line_->outbox)
    return {};
  ReportSender::Counts counts = line_->sender->counts();
  return {.pending = line_->outbox->pending_count(),
          .accepted = counts.accepted,
          .refused = counts.refused,
          .problem = std::move(counts.problem),
          .set_aside = counts.set_aside,
          .last_refusal = std::move(counts.last_refusal),
          .kept = line_->outbox->kept_of_older_stores()};
}

Client::OutboxState Client::flush(milliseconds deadline) {
  if (line_->sender) {
    line_->sender->wake();
    line_->sender->wait_until_empty(Clock::now() + deadline);
  }
  return outbox();
}

Result<FetchReply> Client::fetch(FetchRequest request) {
  if (request.deadline <= 0ms)
    return line_->fetching.call(request, Clock::now() + line_->timeout);
  const Clock::time_point deadline = Clock::now() + request.deadline;
  std::optional<Result<FetchReply>> last;
  // A reply that is not final may have brought them.
  std::optional<TaskExperience> experience;
  std::optional<RecallLibrary> recall;
  const auto answer = [&]() -> Result<FetchReply> {
    if (!*last)
      return *std::move(last);
    FetchReply whole = **last;
    if (!whole.experience)
      whole.experience = std::move(experience);
    if (!whole.recall)
      whole.recall = std::move(recall);
    return whole;
  };
  while (true) {
    const auto left = std::chrono::duration_cast<milliseconds>(deadline - Clock::now());
    request.deadline = server_share(std::max(left, milliseconds(1)));
    Result<FetchReply> reply = line_->fetching.call(request, deadline);
    // No answer this time does not undo the answer of last time.
    const bool is_worse = !reply && reply.error().code == ErrorCode::Unavailable && last;
    if (!is_worse)
      last.emplace(std::move(reply));
    if (*last && (*last)->experience) {
      experience = (*last)->experience;
      request.known_experience = (*last)->experience->revision;
    }
    if (*last && (*last)->recall) {
      recall = (*last)->recall;
      request.known_recall = (*last)->recall->revision;
    }
    const std::optional<milliseconds> pause = is_worse ? std::nullopt : pause_after(*last);
    if (!pause || Clock::now() + *pause >= deadline)
      return answer();
    line_->sleep.sleep(*pause);
  }
}

std::unique_ptr<Follower> Client::follow(const FetchRequest& request,
                                         const FollowOptions& options) const {
  return std::make_unique<Follower>(line_->participant, request, options);
}

std::unique_ptr<Watcher> Client::watch(Watcher::Handlers handlers) const {
  return std::make_unique<Watcher>(line_->participant, std::move(handlers));
}

Result<std::vector<Receipt>> Client::deliver(std::vector<Attempt> attempts) {
  return link::deliver(std::move(attempts), line_->timeout, line_->sleep,
                       [this](const ReportRequest& batch, Clock::time_point deadline) {
                         return line_->reporting.call(batch, deadline);
                       });
}

Result<AdminReply> Client::admin(const AdminRequest& request) {
  if (!line_->token.empty() && rule_of(request.verb).is(VerbRule::Changes))
    return change(request);
  const Clock::time_point deadline = Clock::now() + line_->timeout + request.deadline;
  return ask_until_final<AdminReply>(deadline, line_->sleep,
                                     [&] { return line_->administering.call(request, deadline); });
}

/// The server's; empty: it asks for no proof. Kept for a minute, unless it is to be asked for.
Result<std::string> Client::challenge(bool is_kept) {
  constexpr auto kKept = 1min;
  {
    const std::lock_guard lock(line_->challenge_mutex);
    if (is_kept && !line_->challenge.empty() && Clock::now() - line_->challenged < kKept)
      return line_->challenge;
  }
  const Clock::time_point asked = Clock::now();
  const Result<ServerStatus> status = row_of<ServerStatus>(*this, AdminRequest());
  if (!status)
    return status.error();
  const std::lock_guard lock(line_->challenge_mutex);
  line_->challenge = status->challenge;
  line_->challenged = asked;
  return status->challenge;
}

/// With a proof of its own each time that it is sent anew. A refusal may be that of a server that
/// was started since it gave its challenge: then there is another one, for which it is sent again.
Result<AdminReply> Client::change(const AdminRequest& request) {
  const Digest token = security::read_admin_token(line_->token);
  const Clock::time_point deadline = Clock::now() + line_->timeout + request.deadline;
  const auto send = [&](const std::string& challenge) {
    AdminRequest shown = request;
    if (!challenge.empty())
      shown.proof = security::prove_admin_token(token, challenge, line_->client_id, request);
    return line_->administering.call(shown, deadline);
  };
  return ask_until_final<AdminReply>(deadline, line_->sleep, [&]() -> Result<AdminReply> {
    const Result<std::string> first = challenge(true);
    if (!first)
      return first.error();
    Result<AdminReply> reply = send(*first);
    if (!reply || reply->status != AdminStatus::Refused ||
        reply->message.find(kWrongProof) == std::string::npos)
      return reply;
    const Result<std::string> second = challenge(false);
    return second ? send(*second) : reply;
  });
}

bool Client::is_forked() const { return line_->process.is_forked(); }

void Client::require_own_process() const {
  if (is_forked())
    throw Failure(ErrorCode::InvalidInput, dds::forked_process_advice());
}

void Client::cancel() {
  if (is_forked())
    return;
  line_->registering.cancel();
  line_->fetching.cancel();
  line_->administering.cancel();
  line_->sleep.end();
}

}  // namespace kinship::link
