#pragma once

#include <barrier>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "client/link/client.hpp"
#include "tests/bench/measure.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"

/// Clients that give a server work to do, as processes of their own: a benchmark is this program
/// again, with a role as its first argument (run_role()).
namespace kinship::bench {

constexpr auto kTask = "sweep";  ///< of which there is a distribution

inline link::ClientOptions without_outbox(std::uint32_t domain) {
  return {.domain = domain, .outbox = {}, .has_outbox = false, .timeout = std::chrono::seconds(60)};
}

inline FetchRequest request_for(const Digest& robot) {
  FetchRequest request;
  request.task = kTask;
  request.robot = robot;
  request.deadline = std::chrono::seconds(60);
  return request;
}

/// Registers the Panda, reports its sweeps and has the distribution made.
inline Digest teach(link::Client& client, std::uint64_t sweeps) {
  const Digest panda =
      client.register_robot(test::model_description("panda")).value_or_throw().robot;
  std::vector<Attempt> attempts;
  for (std::uint64_t i = 0; i < sweeps; ++i)
    attempts.push_back(test::panda_attempt(panda, kTask, i));
  client.deliver(std::move(attempts)).value_or_throw();
  client.fetch(request_for(panda)).value_or_throw();
  return panda;
}

/// A report of 8 KB for a task of which nobody wants a distribution.
inline Attempt report_of_8_kb(const Digest& panda, const std::string& task, std::uint64_t seed) {
  constexpr Eigen::Index kWaypoints = 146;  // 8176 bytes as float64
  Attempt attempt = test::panda_attempt(panda, task, seed);
  const Eigen::MatrixXd corners = attempt.path->waypoints();
  Eigen::MatrixXd waypoints(corners.rows(), kWaypoints);
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> noise(-0.001, 0.001);
  for (Eigen::Index i = 0; i < kWaypoints; ++i) {
    const double at = static_cast<double>(i * (corners.cols() - 1)) / kWaypoints;
    const auto corner = static_cast<Eigen::Index>(at);
    const double part = at - static_cast<double>(corner);
    waypoints.col(i) = (1 - part) * corners.col(corner) + part * corners.col(corner + 1);
    for (double& value : waypoints.col(i))
      value += noise(generator);  // else it would shrink to a tenth
  }
  attempt.path = Path(std::move(waypoints));
  return attempt;
}

/// Four clients that report, one path at a time each, from when each has had its first receipt:
/// discovery and handshakes do not count. What they report nobody reported before.
/// \param rate_per_s  of all together; 0: as many as they can.
/// \param seconds     0: until they are killed.
/// \return how many were stored.
inline std::uint64_t report_at(std::uint32_t domain, const Digest& panda, double rate_per_s,
                               double seconds, const std::string& task) {
  constexpr std::size_t kClients = 4;
  const auto first_seed =
      static_cast<std::uint64_t>(std::chrono::system_clock::now().time_since_epoch().count());
  std::vector<std::uint64_t> stored(kClients);
  std::barrier connected(kClients);
  {
    std::vector<std::jthread> threads;
    for (std::size_t number = 0; number < kClients; ++number)
      threads.emplace_back([&, number] {
        link::Client client(without_outbox(domain));
        std::uint64_t seed = first_seed + 1'000'000 * number;
        client.deliver({report_of_8_kb(panda, task, seed++)}).value_or_throw();
        connected.arrive_and_wait();
        const double begin_s = wall_s();
        for (std::uint64_t i = 0; seconds == 0 || wall_s() < begin_s + seconds; ++i) {
          if (rate_per_s > 0) {
            const double due_s = begin_s + static_cast<double>(i * kClients) / rate_per_s;
            std::this_thread::sleep_for(std::chrono::duration<double>(due_s - wall_s()));
          }
          const auto receipts =
              client.deliver({report_of_8_kb(panda, task, seed++)}).value_or_throw();
          stored[number] += receipts.at(0).status == ReceiptStatus::Stored ? 1U : 0U;
        }
      });
  }
  std::uint64_t all = 0;
  for (const std::uint64_t of_one : stored)
    all += of_one;
  return all;
}

/// Has distributions made, one after the other, at 16 placements; each is evicted again.
[[noreturn]] inline void have_fits_made(std::uint32_t domain, const Digest& panda) {
  link::Client client(without_outbox(domain));
  for (std::uint64_t i = 0;; ++i) {
    FetchRequest request = request_for(panda);
    request.T_task_base = Eigen::Isometry3d::Identity();
    request.T_task_base->translation().x() = 0.001 * static_cast<double>(1 + i % 16);
    const FetchReply made = client.fetch(request).value_or_throw();
    AdminRequest evict;
    evict.verb = AdminVerb::EvictDistribution;
    evict.argument = made.distribution.value().id.hex();
    client.admin(evict).value_or_throw();
  }
}

/// The work of a process of this program.
/// \param arguments  ROLE DOMAIN ROBOT, and of `reports` RATE SECONDS [TASK].
/// \return whether ROLE is one of these.
inline bool run_role(const std::vector<std::string>& arguments) {
  if (arguments.size() < 3)
    return false;
  const auto domain = static_cast<std::uint32_t>(std::stoul(arguments[1]));
  const auto robot = Digest::from_hex(arguments[2]);
  if (arguments[0] == "reports" && arguments.size() >= 5 && robot)
    std::cout << report_at(domain, *robot, std::stod(arguments[3]), std::stod(arguments[4]),
                           arguments.size() > 5 ? arguments[5] : "beside")
              << std::endl;
  else if (arguments[0] == "fits" && robot)
    have_fits_made(domain, *robot);
  else
    return false;
  return true;
}

/// Starts this program in a role.
inline test::ChildProcess start_role(const std::string& role, std::uint32_t domain,
                                     const Digest& robot, std::vector<std::string> more = {}) {
  std::vector<std::string> command = {"/proc/self/exe", role, std::to_string(domain), robot.hex()};
  command.insert(command.end(), more.begin(), more.end());
  return test::ChildProcess(command);
}

}  // namespace kinship::bench
