// 07: Work offline. No step needs a server: a report waits on disk, a fetch ends at its deadline,
// and the planner goes on uniformly. Run it without a server, then with one: the waiting reports
// arrive.
//
//   07_work_offline MODELS
#include <iostream>

#include "arms.hpp"

int main(int count, char** words) try {
  if (count != 2) {
    std::cerr << "usage: 07_work_offline MODELS\n";
    return 2;
  }
  kinship::link::ClientOptions options = kinship::link::options_from_environment();
  options.timeout =
      std::chrono::seconds(2);  // of register_robot(), and of a fetch without deadline
  kinship::link::Client client(options);
  const kinship::RobotDescription arm = panda(words[1]);
  const auto reply = client.register_robot(arm);  // kept on disk for when a server is there
  std::cout << "server: " << (reply ? "there" : reply.error().message) << '\n';

  // The robot's digest follows from its kinematics alone, without a request.
  const kinship::Digest robot = kinship::kinematics::read_chain(arm).value_or_throw().digest();
  kinship::FetchRequest request;
  request.task = "sweep";
  request.robot = robot;
  request.T_task_base = Eigen::Isometry3d::Identity();  // where it stands
  request.deadline = std::chrono::seconds(1);
  const auto answer = client.fetch(request);
  const bool is_guided = answer && answer->status == kinship::FetchStatus::Ready;
  std::cout << "planning " << (is_guided ? "guided" : "uniformly") << '\n';

  client.report(sweep_attempt(robot, 42));
  const auto outbox = client.flush(std::chrono::seconds(reply ? 30 : 1));
  std::cout << "accepted " << outbox.accepted << ", pending " << outbox.pending << '\n';
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
