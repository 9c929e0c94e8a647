#include "client/cli/path_import.hpp"

#include <fstream>
#include <map>
#include <utility>

#include "client/cli/attempt_delivery.hpp"
#include "client/cli/foreign_paths.hpp"
#include "client/link/robot_names.hpp"
#include "proto/files/lines.hpp"
#include "proto/json/experience_line.hpp"

namespace kinship::cli {
namespace {

/// The lines of an experience file on their way.
class LineImport {
 public:
  explicit LineImport(AttemptDelivery& delivery) : delivery_(delivery) {}

  /// \return false if it cannot go on.
  bool take(const files::Line& line) {
    const std::string place = "line " + std::to_string(line.number);
    if (!line.text) {
      delivery_.refuse(place, line.text.error().message);
      return true;
    }
    Result<json::ExperienceLine> parsed = json::experience_line_from_json(*line.text);
    if (!parsed)
      delivery_.refuse(place, parsed.error().message);
    else if (const auto* robot = std::get_if<RobotDescription>(&*parsed))
      register_robot(place, *robot);
    else
      hold(place, std::get<json::NamedAttempt>(std::move(parsed).value()));
    return !delivery_.end();
  }

 private:
  void register_robot(const std::string& place, const RobotDescription& description) {
    const Result<RegisterReply> reply = delivery_.server().register_robot(description);
    if (!reply && reply.error().code == ErrorCode::Unavailable) {
      delivery_.stop(reply.error());
      return;
    }
    if (!reply || reply->status == RegisterStatus::Refused) {
      delivery_.refuse(place, "robot '" + description.label +
                                  "': " + (reply ? reply->message : reply.error().message));
      return;
    }
    delivery_.count_robot();
    labels_.insert_or_assign(description.label, reply->robot);
    if (!reply->message.empty())
      delivery_.tell(place, reply->message);
  }

  void hold(const std::string& place, json::NamedAttempt named) {
    if (!named.label.empty()) {
      const Result<Digest> robot = find_robot(named.label);
      if (!robot && robot.error().code == ErrorCode::Unavailable) {
        delivery_.stop(robot.error());
        return;
      }
      if (!robot) {
        delivery_.refuse(place, robot.error().message);
        return;
      }
      named.attempt.robot = *robot;
    }
    delivery_.hold(place, std::move(named.attempt));
  }

  /// By its name in the file, or at the server.
  Result<Digest> find_robot(const std::string& label) {
    if (const auto known = labels_.find(label); known != labels_.end())
      return known->second;
    const auto robots = link::resolve_robots(delivery_.server(), {label});
    if (!robots)
      return robots.error();
    labels_.emplace(label, robots->front());
    return robots->front();
  }

  AttemptDelivery& delivery_;
  std::map<std::string, Digest> labels_;
};

}  // namespace

int import_paths(link::Client& server, const ImportOptions& options, std::istream& standard_input,
                 std::ostream& out, std::ostream& err) {
  if (options.file.empty())
    return import_foreign_paths(server, options, out, err);
  std::ifstream file;
  const bool is_standard_input = options.file == "-";
  if (!is_standard_input)
    file = files::open_input(options.file);
  AttemptDelivery delivery(server, err, options.progress);
  LineImport import(delivery);
  files::for_each_line(is_standard_input ? standard_input : file,
                       is_standard_input ? "standard input" : options.file.string(),
                       [&](const files::Line& line) { return import.take(line); });
  return delivery.finish("line", options.json, out);
}

}  // namespace kinship::cli
