// 01: Report a path. An arm that has planned reports its path and its cost to the fleet's server.
//
//   01_report_a_path MODELS SEED        MODELS: the folder share/kinship/robots of the installation
//
// A report is on disk when report() returns and reaches the server sooner or later; flush() waits
// for that.
#include <iostream>

#include "arms.hpp"

int main(int count, char** words) try {
  if (count != 3) {
    std::cerr << "usage: 01_report_a_path MODELS SEED\n";
    return 2;
  }
  kinship::link::Client client(kinship::link::options_from_environment());
  const kinship::RegisterReply reply = client.register_robot(panda(words[1])).value_or_throw();
  std::cout << "registered as " << reply.robot.short_hex() << ", " << reply.dof << " joints\n";

  const std::uint64_t first = std::stoul(words[2]);
  for (std::uint64_t seed = first; seed < first + 6; ++seed)
    client.report(sweep_attempt(reply.robot, seed));  // never waits for the network

  const auto outbox = client.flush(std::chrono::seconds(30));
  std::cout << "accepted " << outbox.accepted << ", refused " << outbox.refused << ", pending "
            << outbox.pending << '\n';
  return outbox.accepted == 6 ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
