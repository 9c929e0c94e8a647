#include "client/cli/register_command.hpp"

#include <ostream>

#include "client/cli/exit_code.hpp"
#include "client/cli/robot_geometry.hpp"
#include "proto/json/robot_answers_json.hpp"

namespace kinship::cli {
namespace {

void print_same_arms(const std::vector<std::string>& labels, std::ostream& out) {
  if (labels.empty())
    return;
  out << "the same arm as";
  for (std::size_t i = 0; i < labels.size(); ++i)
    out << (i == 0 ? " " : ", ") << labels[i];
  out << ": experience passes between them as it is\n";
}

}  // namespace

int register_robot(link::Client& server, const models::RobotArguments& arguments, bool json,
                   std::ostream& out, std::ostream& err) {
  const auto description = models::describe_robot(arguments);
  if (!description) {
    err << "robots register: " << description.error().message << '\n';
    return exit_code(description.error().code);
  }
  read_geometry("robots register", arguments, *description, err);
  const auto reply = server.register_robot(*description);
  if (!reply) {
    err << "robots register: " << reply.error().message << '\n';
    return exit_code(reply.error().code);
  }
  if (reply->status == RegisterStatus::Refused) {
    err << "robots register: refused: " << reply->message << '\n';
    return kWrongUsage;
  }
  if (!reply->message.empty())
    err << "robots register: " << reply->message << "; the label '" << description->label
        << "' is not kept\n";
  if (json)
    out << json::to_json(*reply, description->label) << '\n';
  else
    out << (reply->message.empty() ? description->label + " is " : "") << "robot "
        << reply->robot.short_hex() << ": " << reply->dof << " joints, " << reply->solver
        << (reply->status == RegisterStatus::Known ? " (known already)" : "") << '\n';
  if (!json)
    print_same_arms(reply->same_arms, out);
  return kDone;
}

}  // namespace kinship::cli
