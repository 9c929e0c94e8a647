#include "tests/faults/short_lived_clients.hpp"

#include <atomic>
#include <chrono>
#include <csignal>
#include <iostream>
#include <memory>
#include <thread>

#include "client/link/client.hpp"
#include "tests/support/robots.hpp"

namespace kinship::test {

int run_short_lived_clients(const std::vector<std::string>& arguments) {
  constexpr std::size_t kFollowers = 5;
  const auto domain = static_cast<std::uint32_t>(std::stoul(arguments.at(0)));
  std::vector<std::unique_ptr<link::Client>> clients(std::stoul(arguments.at(1)));
  std::vector<std::unique_ptr<link::Follower>> followers;
  FetchRequest request;
  request.task = "sweep";
  request.robot = model_chain("panda").digest();
  for (auto& client : clients)
    client = std::make_unique<link::Client>(link::ClientOptions{
        .domain = domain, .outbox = {}, .has_outbox = false, .timeout = std::chrono::seconds(30)});
  for (std::size_t i = 0; i < clients.size(); i += kFollowers)
    followers.push_back(clients[i]->follow(request));
  std::atomic<int> answered = 0;
  {
    std::vector<std::jthread> askers;
    for (const auto& client : clients)
      askers.emplace_back([&] {
        const auto status = client->admin({});
        const auto fetched = client->fetch(request);
        if (status && status->status == AdminStatus::Ok && fetched &&
            fetched->status == FetchStatus::Ready)
          ++answered;
      });
  }
  std::cout << "answered " << answered << std::endl;
  if (arguments.at(2) == "die")
    std::raise(SIGKILL);
  return 0;
}

}  // namespace kinship::test
