#pragma once

#include <map>
#include <memory>
#include <mutex>
#include <set>
#include <string>

#include "arm.hpp"
#include "worker.hpp"

namespace kinship_moveit {

struct Query;

/// The line to a server that all plugins of a process share, and the robot's groups. Threads share
/// it; nothing but Arm::guidance waits, and that is bounded.
class Session {
 public:
  /// The session of the process, made with the node's parameters if there is none.
  /// \return null if a parameter is wrong or libkinship cannot open its outbox: an error is logged.
  static std::shared_ptr<Session> open(const rclcpp::Node::SharedPtr& node);
  /// Null if there is none: then nothing is guided.
  static std::shared_ptr<Session> current();

  /// \throws std::invalid_argument as read_settings(); std::runtime_error if libkinship cannot
  ///         open its outbox.
  explicit Session(rclcpp::Node& node);

  const Settings& settings() const { return settings_; }
  kinship_client& client() { return *client_; }
  rclcpp::Logger logger() const { return logger_; }

  /// Kinship's planners are wanted of arms made from now on.
  void want_planners() { wants_planners_ = true; }
  /// \return null while it is being made, or if it cannot be. The first call of a group begins it.
  std::shared_ptr<Arm> arm(const moveit::core::RobotModel& model, const std::string& group);

  /// Writes a warning, once for equal texts.
  void warn_once(const std::string& text);
  /// Does a job behind planning.
  void post(std::function<void()> job);

  /// The query that samplers of a group serve: the last that began.
  void set_latest(const std::string& group, std::shared_ptr<const Query> query);
  std::shared_ptr<const Query> latest(const std::string& group) const;

 private:
  const Settings settings_;
  const rclcpp::Logger logger_;
  Owned<kinship_client> client_;
  std::atomic<bool> wants_planners_ = false;
  mutable std::mutex mutex_;  // guards the next three
  std::map<std::string, std::shared_ptr<Arm>> arms_;
  std::map<std::string, std::shared_ptr<const Query>> latest_;
  std::set<std::string> told_;
  Worker worker_;  // last: its jobs use the others
};

}  // namespace kinship_moveit
