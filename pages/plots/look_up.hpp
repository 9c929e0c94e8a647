#pragma once

#include <cstddef>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pages/plots/drawn_robot.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/digest.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/robot_description.hpp"
#include "proto/types/summaries.hpp"
#include "proto/types/uuid.hpp"

namespace kinship::plots {

/// What figures of many paths ask for, of a server or of its client. All throw Failure, e.g.
/// NotFound for a path that was dropped after it was listed.
struct LookUp {
  /// Of a task and a robot (none: of all), the newest first, until `take` returns false.
  std::function<void(const std::string& task, const std::optional<Digest>& robot,
                     const std::function<bool(PathSummary)>& take)>
      for_each_path;
  std::function<Attempt(const Uuid& report)> attempt;
  std::function<RobotDescription(const Digest& robot)> robot;
  /// Those kept of a robot and task.
  std::function<std::vector<DistributionSummary>(const std::string& task, const Digest& robot)>
      distributions;
  std::function<Distribution(const Digest& id)> distribution;
};

/// Of a task and a robot (none: of all), the newest first: all, or so many that `most` of them are
/// in use.
std::vector<PathSummary> newest_paths(const LookUp& look_up, const std::string& task,
                                      const std::optional<Digest>& robot, std::size_t most);

/// The robots of a figure, each looked up and read when it is first needed.
class DrawnRobots {
 public:
  /// \param look_up  outlives it.
  explicit DrawnRobots(const LookUp& look_up) : look_up_(look_up) {}

  /// Null for a robot that is not known, or whose description cannot be read.
  const DrawnRobot* find(const Digest& robot);

 private:
  const LookUp& look_up_;
  std::map<Digest, std::unique_ptr<const DrawnRobot>> robots_;
};

}  // namespace kinship::plots
