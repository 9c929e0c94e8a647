#include "client/cli/fetch_command.hpp"

#include <iomanip>
#include <limits>
#include <optional>
#include <ostream>
#include <random>

#include "client/cli/admin_rows.hpp"
#include "client/cli/exit_code.hpp"
#include "client/cli/table.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/summaries_json.hpp"
#include "proto/mixture/sampler.hpp"
#include "proto/types/enum_text.hpp"
#include "robots/models/robot_arguments.hpp"

namespace kinship::cli {
namespace {

constexpr const char* kCommand = "distributions fetch";

std::optional<Digest> find_robot(link::Client& server, const std::string& name, std::ostream& err,
                                 int& code) {
  const auto rows = show_rows(server, AdminVerb::ShowRobot, name, kCommand, err, code);
  if (rows.empty())
    return std::nullopt;
  const auto robot = json::robot_summary_from_json(rows.front());
  if (!robot) {
    err << kCommand << ": cannot read the server's row: " << robot.error().message << '\n';
    code = kFailed;
    return std::nullopt;
  }
  return robot->robot;
}

/// Says why there is no distribution to print. \return an exit code, kDone if there is one.
int judge(const Result<FetchReply>& reply, std::ostream& err) {
  if (!reply) {
    err << kCommand << ": " << reply.error().message << '\n';
    return exit_code(reply.error().code);
  }
  const auto say = [&](const char* what) {
    err << kCommand << ": " << what << (reply->message.empty() ? "" : ": ") << reply->message
        << '\n';
  };
  switch (reply->status) {
    case FetchStatus::Ready:
      return kDone;
    case FetchStatus::NoExperience:
      say("no experience");
      return kNotFound;
    case FetchStatus::UnknownRobot:
      say("unknown robot");
      return kNotFound;
    case FetchStatus::Pending:
      say("still being made when the wait (--wait) was over");
      return kFailed;
    case FetchStatus::Busy:
      say("the server is busy");
      return kFailed;
    case FetchStatus::Refused:
      say("refused");
      return kWrongUsage;
    default:
      say("failed");
      return kFailed;
  }
}

int print_samples(const Distribution& distribution, const FetchOptions& options, std::ostream& out,
                  std::ostream& err) {
  const mixture::Sampler sampler(*distribution.mixture, distribution.limits);
  std::mt19937_64 generator(options.seed);
  for (Eigen::Index joint = 0; joint < sampler.dimension(); ++joint)
    out << (joint == 0 ? "q_" : ",q_") << joint + 1;
  out << '\n' << std::setprecision(std::numeric_limits<double>::max_digits10);
  for (std::uint64_t i = 0; i < options.samples; ++i) {
    const auto q = sampler.sample(generator);
    if (!q) {
      err << kCommand << ": the mixture lies outside the joint limits\n";
      return kFailed;
    }
    for (Eigen::Index joint = 0; joint < q->size(); ++joint)
      out << (joint == 0 ? "" : ",") << (*q)(joint);
    out << '\n';
  }
  return kDone;
}

}  // namespace

void print_distribution(const Distribution& distribution, std::ostream& out) {
  out << "distribution  " << distribution.id.short_hex() << " revision " << distribution.revision
      << ", " << to_text(distribution.state) << '\n'
      << "task, robot   " << distribution.task << ", " << distribution.robot.short_hex() << '\n'
      << "placement     "
      << (distribution.T_task_base ? pose_text(*distribution.T_task_base) : "not given") << '\n'
      << "profile       " << distribution.profile << " (" << distribution.engines << ")\n";
  if (distribution.mixture)
    out << "mixture       " << distribution.mixture->size() << " components in "
        << distribution.mixture->dimension() << " dimensions, fitted to "
        << distribution.configurations << " configurations\n";
  out << "made          " << time_text(distribution.fitted_ms) << ", transfer "
      << number_text(distribution.transfer_time_s, 2) << " s, fit "
      << number_text(distribution.fit_time_s, 2) << " s\n"
      << "share         " << number_text(distribution.advice.recommended_share, 2) << " recommended"
      << (distribution.advice.evidence.empty() ? "" : ": ") << distribution.advice.evidence << '\n';
  if (!distribution.reason.empty())
    out << "note          " << distribution.reason << '\n';
  out << '\n';
  Table table({"SOURCE", "ROBOT", "PATHS", "GENERATION", "POSES", "SOLVED"});
  for (const Source& source : distribution.sources)
    table.add_row({source.label, source.robot.short_hex(), std::to_string(source.paths),
                   std::to_string(source.generation), std::to_string(source.poses),
                   std::to_string(source.poses_solved)});
  table.print(out);
}

int fetch_distribution(link::Client& server, const FetchOptions& options, std::ostream& out,
                       std::ostream& err) {
  FetchRequest request;
  request.task = options.task;
  request.profile = options.profile;
  request.deadline = options.wait;
  if (!options.placement.empty()) {
    const auto T_task_base = models::parse_pose(options.placement);
    if (!T_task_base) {
      err << kCommand << ": --placement: " << T_task_base.error().message << '\n';
      return kWrongUsage;
    }
    request.T_task_base = *T_task_base;
  }
  int code = kDone;
  const auto robot = find_robot(server, options.robot, err, code);
  if (!robot)
    return code;
  request.robot = *robot;
  const auto reply = server.fetch(request);
  if (code = judge(reply, err); code != kDone)
    return code;
  if (options.samples > 0)
    return print_samples(*reply->distribution, options, out, err);
  if (options.json)
    out << json::to_json(*reply->distribution) << '\n';
  else
    print_distribution(*reply->distribution, out);
  return kDone;
}

}  // namespace kinship::cli
