#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/link/environment.hpp"
#include "client/link/reported_placement.hpp"
#include "client/python/administration.hpp"
#include "client/python/arrays.hpp"
#include "client/python/bindings.hpp"
#include "client/python/client_handle.hpp"
#include "client/python/errors.hpp"
#include "client/python/follower_handle.hpp"
#include "client/python/guidance_handle.hpp"
#include "client/python/robot_names.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::python {
namespace {

using OutboxState = link::Client::OutboxState;

/// The common arguments of fetch and follow, as Python gives them.
struct Wish {
  std::string task;
  RobotName robot;
  std::optional<Array> T_task_base;
  std::string profile;
  std::vector<RobotName> sources;
  std::string weighting;
  std::int64_t since_ms = 0;
};

/// A request without placement is for where the robot stood when it last reported the task.
/// \throws Failure if the server does not say it, the exception Refused if this client may not
/// know.
void place(const ClientHandle& client, FetchRequest& request) {
  if (request.T_task_base)
    return;
  const auto known = client.wait_for<Result<link::ReportedPlacement>>(
      [task = request.task, robot = request.robot](link::Client& line) {
        return link::reported_placement(line, task, robot.hex());
      });
  if (!known) {
    const std::string why =
        "T_task_base is not given, and where the robot last reported the task is not told: " +
        known.error().message;
    if (known.error().code == ErrorCode::InvalidInput)
      raise_error("Refused", why);
    throw Failure(known.error().code, why);
  }
  request.T_task_base = known->T_task_base;
}

FetchRequest request_of(const ClientHandle& client, const Wish& wish) {
  FetchRequest request;
  request.task = wish.task;
  request.T_task_base = read_pose(wish.T_task_base, "T_task_base");
  request.profile = wish.profile;
  request.selection.since_ms = wish.since_ms;
  if (!wish.weighting.empty())
    request.selection.weighting = parse_word<Weighting>(wish.weighting).value_or_throw();
  request.robot = client.find(wish.robot);
  std::vector<Digest>& sources = request.selection.sources;
  for (const RobotName& source : wish.sources)
    sources.push_back(client.find(source));
  std::ranges::sort(sources);
  sources.erase(std::unique(sources.begin(), sources.end()), sources.end());
  return request;
}

/// \throws the exception that stands for a reply with nothing to plan with.
[[noreturn]] void raise_status(FetchStatus status, const FetchRequest& request,
                               const std::string& message) {
  const std::string about = "task '" + request.task + "', robot " + request.robot.short_hex();
  const std::string why = message.empty() ? "" : ": " + message;
  switch (status) {
    case FetchStatus::Pending:
      raise_error("NotReady", about + ": still being made at the deadline" + why);
    case FetchStatus::Busy:
      raise_error("NotReady", about + ": the server was busy until the deadline" + why);
    case FetchStatus::NoExperience:
      raise_error("NoExperience", about + ": no experience" + why);
    case FetchStatus::UnknownRobot:
      raise_error("UnknownRobot", about + ": the server does not know the robot" + why);
    case FetchStatus::Ready:  // with what is of no use
    case FetchStatus::Failed:
      raise_error("FitFailed", about + ": failed" + why);
    case FetchStatus::Refused:
      break;
  }
  raise_error("Refused", about + ": refused" + why);
}

std::shared_ptr<SampledDistribution> distribution_of(Result<FetchReply> fetched,
                                                     const FetchRequest& request) {
  FetchReply reply = std::move(fetched).value_or_throw();
  if (reply.status != FetchStatus::Ready)
    raise_status(reply.status, request, reply.message);
  return std::make_shared<SampledDistribution>(
      std::make_shared<const Distribution>(*std::move(reply.distribution)));
}

/// How a planner is to be guided, as Python says it.
struct GuidanceWish {
  double deadline = 0;
  std::string guide;
  std::optional<double> share, control_share;
  bool is_rehearsed = false;
  std::optional<Array> start, T_task_goal;
  bool is_to_configuration = false;
};

std::shared_ptr<GuidanceHandle> guidance_of(const ClientHandle& client, const Robot& robot,
                                            const FetchRequest& request, const GuidanceWish& wish) {
  guided::GuidanceOptions wanted;
  wanted.task = request.task;
  wanted.robot = robot.digest();
  wanted.dof = robot.chain().dof();
  wanted.chain = robot.chain();
  wanted.profile = request.profile;
  wanted.selection = request.selection;
  wanted.sampling = {.guided_fraction = wish.share, .control_fraction = wish.control_share};
  if (!wish.guide.empty())
    wanted.guide = parse_word<Guide>(wish.guide).value_or_throw();
  wanted.rehearsed = wish.is_rehearsed;
  wanted.wait = to_milliseconds(wish.deadline, "deadline");
  if (wish.start)
    wanted.start = read_configurations(*wish.start, robot.chain().dof(), "start").columns.col(0);
  wanted.T_task_goal = read_pose(wish.T_task_goal, "T_task_goal");
  wanted.to_configuration = wish.is_to_configuration;
  FetchStatus status = FetchStatus::Ready;
  const auto fetch = [&](const FetchRequest& asked) -> Result<FetchReply> {
    FetchReply reply =
        (asked.rehearsed ? client.fetch_rehearsed(asked) : client.fetch(asked)).value_or_throw();
    status = reply.status;
    return reply;
  };
  guided::GuidanceAnswer answer = guided::fetch_guidance(fetch, wanted, request.T_task_base);
  if (!answer.guidance)
    raise_status(status, request, answer.message);
  return std::make_shared<GuidanceHandle>(robot.digest(), std::move(answer), robot.chain(),
                                          request.T_task_base);
}

RegisterReply register_robot(const ClientHandle& client, const Robot& robot) {
  const std::shared_ptr<link::Client> line = client.line();
  std::optional<kinematics::RobotModel> model;
  {
    const py::gil_scoped_release unlocked;  // solids are fitted around meshes
    model = robot.model_for_server();
    if (robot.keeps_meshes())
      line->forget_meshes(robot.digest());
  }
  const RegisterReply reply =
      client
          .wait_for<Result<RegisterReply>>([model = *std::move(model)](link::Client& line) {
            return line.register_robot(model);
          })
          .value_or_throw();
  if (reply.status == RegisterStatus::Refused)
    raise_error("Refused", "robot '" + robot.description().label + "': " + reply.message);
  return reply;
}

std::string report(const ClientHandle& client, const json::NamedAttempt& named) {
  const Attempt attempt = attempt_of(named);
  const std::shared_ptr<link::Client> line = client.line();
  const py::gil_scoped_release unlocked;
  line->report(attempt);
  return attempt.report_uuid.text();
}

std::vector<Receipt> deliver(const ClientHandle& client,
                             const std::vector<json::NamedAttempt>& named) {
  std::vector<Attempt> attempts;
  attempts.reserve(named.size());
  for (const json::NamedAttempt& attempt : named)
    attempts.push_back(attempt_of(attempt));
  return client
      .wait_for<Result<std::vector<Receipt>>>(
          [attempts = std::move(attempts)](link::Client& line) { return line.deliver(attempts); })
      .value_or_throw();
}

std::string receipt_word(const Receipt& receipt) {
  switch (receipt.status) {
    case ReceiptStatus::Stored:
      return "stored";
    case ReceiptStatus::Duplicate:
      return "duplicate";
    case ReceiptStatus::Recorded:
      return "recorded";
    case ReceiptStatus::Refused:
      return "refused";
    case ReceiptStatus::UnknownRobot:
      return "unknown_robot";
    case ReceiptStatus::TryAgain:
      break;
  }
  return "try_again";
}

void bind_answers(py::module_& module) {
  py::class_<OutboxState>(module, "OutboxState", "How far reports have got.")
      .def_readonly("pending", &OutboxState::pending, "Not yet acknowledged by the server.")
      .def_readonly("accepted", &OutboxState::accepted, "Since this client started.")
      .def_readonly("refused", &OutboxState::refused, "Since this client started.")
      .def_readonly("last_refusal", &OutboxState::last_refusal,
                    "Why the last of the refused is, or empty.")
      .def_readonly("problem", &OutboxState::problem, "Why sending does not get on, or empty.")
      .def_readonly("set_aside", &OutboxState::set_aside,
                    "Since this client started; see 'kinship outbox'.")
      .def_property_readonly(
          "kept",
          [](const OutboxState& self) {
            std::map<std::string, std::size_t> kept;
            for (const link::KeptReports& each : self.kept)
              kept.emplace(each.store, each.reports);
            return kept;
          },
          "How many reports are kept of stores that the server had before, by store; "
          "Client(resend='all') sends them.")
      .def("__repr__", [](const OutboxState& self) {
        return "<kinship.OutboxState " + std::to_string(self.pending) + " pending, " +
               std::to_string(self.accepted) + " accepted, " + std::to_string(self.refused) +
               " refused, " + std::to_string(self.set_aside) + " set aside>";
      });
  py::class_<Receipt>(module, "Receipt", "The server's answer to one attempt.")
      .def_property_readonly(
          "report_uuid", [](const Receipt& self) { return self.report_uuid.text(); },
          "Of the attempt.")
      .def_property_readonly("status", receipt_word,
                             "'stored', 'duplicate', 'recorded' (its path is not kept), 'refused', "
                             "'try_again' or 'unknown_robot'.")
      .def_readonly("message", &Receipt::message, "Why.");
  py::class_<RegisterReply>(module, "Registration", "The server's answer to a robot.")
      .def_property_readonly(
          "robot", [](const RegisterReply& self) { return self.robot.hex(); }, "Its digest.")
      .def_property_readonly(
          "is_new",
          [](const RegisterReply& self) { return self.status == RegisterStatus::Registered; },
          "Whether the server did not know it before.")
      .def_readonly("solver", &RegisterReply::solver, "What inverse kinematics will use.")
      .def_readonly("message", &RegisterReply::message, "A warning; mostly empty.")
      .def_readonly("same_arms", &RegisterReply::same_arms,
                    "Labels of known robots that are the same arm.")
      .def_readonly("geometry", &RegisterReply::geometry, "What the server filters with, in words.")
      .def("__repr__", [](const RegisterReply& self) {
        return "<kinship.Registration " + self.robot.short_hex() +
               (self.status == RegisterStatus::Registered ? ", new" : ", known") + ">";
      });
}

void bind_follower(py::module_& module) {
  py::class_<FollowerHandle>(module, "Follower",
                             "Holds the newest distribution without blocking who asks for it.")
      .def("newest", &FollowerHandle::newest,
           "The newest distribution, at once; None as long as there is none.")
      .def(
          "wait_for_newer",
          [](FollowerHandle& self, const std::shared_ptr<SampledDistribution>& held,
             double timeout) {
            return self.wait_for_newer(held, to_milliseconds(timeout, "timeout"));
          },
          py::arg("held") = py::none(), py::kw_only(), py::arg("timeout") = 60.0,
          "Waits, timeout s at most, until the newest is another revision than held. Returns the "
          "newest then.")
      .def_property_readonly("status", &FollowerHandle::status,
                             "'ready', 'pending', 'no_experience', 'unknown_robot', 'no_server', "
                             "'refused' or 'failed'.")
      .def_property_readonly(
          "reason", [](const FollowerHandle& self) { return self.line()->state().reason; },
          "Why it is not ready; a warning otherwise.")
      .def("close", &FollowerHandle::close, "Ends it. What it gave stays valid.")
      .def(
          "__enter__", [](py::object self) { return self; }, "Itself.")
      .def(
          "__exit__", [](FollowerHandle& self, const py::args&) { self.close(); }, "Closes it.");
}

void bind_life(ClientClass& client) {
  client
      .def(
          py::init([](std::optional<std::uint32_t> domain, const std::optional<std::string>& server,
                      const std::optional<std::filesystem::path>& outbox, bool has_outbox,
                      std::optional<double> timeout,
                      const std::optional<std::filesystem::path>& security,
                      const std::optional<std::string>& resend) {
            link::ClientOptions options = link::options_from_environment();
            options.domain = domain.value_or(options.domain);
            options.server = server.value_or(options.server);
            options.security = security.value_or(options.security);
            options.outbox = outbox.value_or(options.outbox);
            options.has_outbox = has_outbox;
            options.resend = link::parse_resend(resend.value_or("")).value_or_throw();
            if (timeout)
              options.timeout = to_milliseconds(*timeout, "timeout");
            auto handle = std::make_unique<ClientHandle>(options);
            if (const auto warning = handle->line()->expiry_warning())
              warn("CredentialsExpire", *warning);
            return handle;
          }),
          py::kw_only(), py::arg("domain") = py::none(), py::arg("server") = py::none(),
          py::arg("outbox") = py::none(), py::arg("has_outbox") = true,
          py::arg("timeout") = py::none(), py::arg("security") = py::none(),
          py::arg("resend") = py::none(),
          R"(Opens a line to a server; the server need not be there.

domain      of DDS, as kinshipd's; by default what KINSHIP_DOMAIN says, or 0
server      its host; by default what KINSHIP_SERVER says, or 127.0.0.1
outbox      folder where reports wait for their receipts; by default one for this server
has_outbox  False: delivers nothing that waits there, and report() is not allowed
timeout     of register, deliver and listings, s; by default what KINSHIP_TIMEOUT says, or 5
security    folder of credentials; by default what KINSHIP_SECURITY says, or none
resend      what a store that the outbox never saw is sent of older reports: 'all' that are kept, or 'none'; by
            default those that no store has acknowledged. A store that was put back gets what it lost in any case

Warns (CredentialsExpire) of credentials that are valid for less than 30 days.)")
      .def_property_readonly(
          "expiry_warning",
          [](const ClientHandle& self) { return self.line()->expiry_warning().value_or(""); },
          "What it would be warned of if it were opened now; empty: nothing.")
      .def("close", &ClientHandle::close,
           "Ends every wait. What is in the outbox is sent by the next client.")
      .def(
          "__enter__", [](py::object self) { return self; }, "Itself.")
      .def(
          "__exit__", [](ClientHandle& self, const py::args&) { self.close(); }, "Closes it.");
}

void bind_reports(ClientClass& client) {
  client
      .def("register", register_robot, py::arg("robot"),
           "Makes a robot known to the server. Raises Refused or NoServer.")
      .def("report", report, py::arg("attempt"),
           R"(Puts an attempt into the outbox, durably, and sends it in the background.

Waits for no server. Returns its UUID; raises InvalidInput if the server would refuse it, as a path with other joints
than the robot's, and NotFound for a robot that was never registered with this outbox.)")
      .def("deliver", deliver, py::arg("attempts"),
           "Hands attempts over at once, past the outbox. Returns a Receipt each; raises NoServer.")
      .def_property_readonly(
          "outbox",
          [](const ClientHandle& self) {
            const std::shared_ptr<link::Client> line = self.line();
            const py::gil_scoped_release unlocked;
            return line->outbox();
          },
          "How far reports have got.")
      .def(
          "flush",
          [](const ClientHandle& self, double deadline) {
            return self.flush(to_milliseconds(deadline, "deadline"));
          },
          py::arg("deadline") = 30.0,
          "Waits, deadline s at most, until the server has acknowledged every report. The result "
          "tells how many "
          "were refused, and why the last was.");
}

void bind_fetching(ClientClass& client) {
  client
      .def(
          "fetch",
          [](const ClientHandle& self, const std::string& task, const RobotName& robot,
             double deadline, const std::optional<Array>& T_task_base, const std::string& profile,
             const std::vector<RobotName>& sources, const std::string& weighting,
             std::int64_t since_ms, std::uint64_t minimum_generation) {
            FetchRequest request =
                request_of(self, {task, robot, T_task_base, profile, sources, weighting, since_ms});
            place(self, request);
            request.minimum_generation = minimum_generation;
            request.deadline = to_milliseconds(deadline, "deadline");
            return distribution_of(self.fetch(request), request);
          },
          py::arg("task"), py::arg("robot"), py::kw_only(), py::arg("deadline") = 30.0,
          py::arg("T_task_base") = py::none(), py::arg("profile") = "default",
          py::arg("sources") = std::vector<RobotName>(), py::arg("weighting") = "",
          py::arg("since_ms") = 0, py::arg("minimum_generation") = 0,
          R"(The distribution of a task for a robot.

robot        a Robot, its digest, or the label by which the server knows it
deadline     so long it may be waited for, s; 0: what is there already
T_task_base  where the robot stands in the task's frame: (4, 4) or (7,); by default where it stood when it
             last reported the task, for which credentials need role reader; Distribution.T_task_base
             and Guidance.T_task_base tell it
profile      parameters of transfer and fit
sources      the robots whose experience counts; empty: all
weighting    'sources' or 'paths'; empty: the profile's
since_ms     experience received at or after, Unix time, ms

Raises NotReady, NoExperience, UnknownRobot, FitFailed, Refused or NoServer.)")
      .def(
          "follow",
          [](const ClientHandle& self, const std::string& task, const RobotName& robot,
             const std::optional<Array>& T_task_base, const std::string& profile,
             const std::vector<RobotName>& sources, const std::string& weighting,
             std::int64_t since_ms) {
            const FetchRequest request =
                request_of(self, {task, robot, T_task_base, profile, sources, weighting, since_ms});
            const std::shared_ptr<link::Client> line = self.line();
            const py::gil_scoped_release unlocked;
            return std::make_unique<FollowerHandle>(
                line->follow(request, {.asks_placement = true}));
          },
          py::arg("task"), py::arg("robot"), py::kw_only(), py::arg("T_task_base") = py::none(),
          py::arg("profile") = "default", py::arg("sources") = std::vector<RobotName>(),
          py::arg("weighting") = "", py::arg("since_ms") = 0,
          "Holds the newest distribution from now on, for what fetch() would be asked for; without "
          "T_task_base, for where the robot last reported the task, which needs role reader. May "
          "outlive the client.");
}

void bind_guidance(ClientClass& client) {
  client.def(
      "guidance",
      [](const ClientHandle& self, const std::string& task, const std::shared_ptr<Robot>& robot,
         double deadline, const std::optional<Array>& T_task_base, const std::string& profile,
         const std::vector<RobotName>& sources, const std::string& weighting, std::int64_t since_ms,
         const std::string& guide, std::optional<double> share, std::optional<double> control_share,
         bool rehearsed, const std::optional<Array>& start, const std::optional<Array>& T_task_goal,
         bool to_configuration) {
        FetchRequest request =
            request_of(self, {task, robot, T_task_base, profile, sources, weighting, since_ms});
        place(self, request);
        return guidance_of(self, *robot, request,
                           {deadline, guide, share, control_share, rehearsed, start, T_task_goal,
                            to_configuration});
      },
      py::arg("task"), py::arg("robot"), py::kw_only(), py::arg("deadline") = 30.0,
      py::arg("T_task_base") = py::none(), py::arg("profile") = "default",
      py::arg("sources") = std::vector<RobotName>(), py::arg("weighting") = "",
      py::arg("since_ms") = 0, py::arg("guide") = "", py::arg("share") = py::none(),
      py::arg("control_share") = py::none(), py::arg("rehearsed") = false,
      py::arg("start") = py::none(), py::arg("T_task_goal") = py::none(),
      py::arg("to_configuration") = false,
      R"(What kinship-plan would guide the robot with: distribution, stored ways, advice.

Parameters that fetch() has mean the same here: without T_task_base, where the robot last reported the task,
which needs role reader. plan() takes the result. Raises as fetch().

robot          a Robot: its chain follows the stored ways
guide          parts of the guidance that are used, e.g. 'retreat+ways'; empty: what the server found best
share          of guided samples, 0 to 1; by default what the server advises
control_share  of queries planned uniformly to compare; by default as the evidence says
rehearsed      True: waits until the server knows which guide is best
start          where the robot's queries usually begin: the server plans what others recorded from there
T_task_goal    (4, 4) or (7,), where the transfer frame is to go in the next query: the server plans for that
               goal in recorded scenes if no report reached it, or in the place of recorded goals that the
               robot cannot plan to
to_configuration  True: queries ask for one configuration, not for any at a pose)");
}

}  // namespace

void bind_client(py::module_& module) {
  bind_answers(module);
  bind_follower(module);
  ClientClass client(module, "Client",
                     "A line to kinshipd: registers robots, reports attempts, fetches and follows "
                     "distributions. Whatever waits lets other threads run, and hears Ctrl-C. May "
                     "be shared between threads, but not taken through a fork.");
  bind_life(client);
  bind_reports(client);
  bind_fetching(client);
  bind_guidance(client);
  bind_administration(client);
}

}  // namespace kinship::python
