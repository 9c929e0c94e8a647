#pragma once

#include <functional>
#include <map>
#include <memory>
#include <set>
#include <string>

#include "proto/types/conversations.hpp"
#include "proto/types/result.hpp"
#include "server/service/service_parts.hpp"

namespace kinship::service {

/// Registers robots, and tells their labels. A robot in memory waits for no request that needs the
/// store. May be shared between threads; `done` as in Service.
class RegistrationService {
 public:
  explicit RegistrationService(const ServiceParts& parts) : parts_(parts) {}

  /// Answers from memory without the store where possible. `done` is not called if the server is
  /// stopping or the store cannot take it: the client asks again.
  /// \param client    the caller; empty: no particular client, without a quota.
  /// \param may_take  see RobotRegistry::register_robot.
  void register_robot(RobotDescription description, std::function<void(const RegisterReply&)> done,
                      const std::string& client = {},
                      runtime::RobotRegistry::LabelRule may_take = {});
  /// Answers and counts a registration that is refused before it reaches the registry.
  void refuse(const std::string& label, const std::string& why,
              const std::function<void(const RegisterReply&)>& done);

  /// Robots, from memory where possible; those that are not registered are missing. An error says
  /// why one cannot be read now: the store's error, or Unavailable if too many tasks wait. `done`
  /// is called at most once; not if the server is stopping.
  using Robots = std::map<Digest, Result<runtime::RobotRegistry::RobotPointer>>;
  void find_robots(const std::set<Digest>& robots, std::function<void(const Robots&)> done,
                   const std::string& client);

  /// The same for their labels.
  using RobotLabels = std::map<Digest, Result<std::string>>;
  void name_robots(const std::set<Digest>& robots, std::function<void(const RobotLabels&)> done,
                   const std::string& client);

 private:
  struct Registration;
  using RegistrationPointer = std::shared_ptr<const Registration>;
  void begin(runtime::WorkerPool& pool, const RegistrationPointer& registration,
             std::function<void()> answer);
  void announce_registered(const Registration& registration, const RegisterReply& reply);

  const ServiceParts parts_;
};

}  // namespace kinship::service
