#include "session.hpp"

#include <stdexcept>

namespace kinship_moveit {
namespace {

std::mutex of_the_process;
std::weak_ptr<Session>& the_session() {
  static std::weak_ptr<Session> session;
  return session;
}

/// Where no parameter says otherwise, libkinship reads the environment.
Owned<kinship_client> open_client(const Settings& settings) {
  auto options = sized<kinship_client_options>();
  options.domain =
      settings.domain >= 0 ? static_cast<std::uint32_t>(settings.domain) : KINSHIP_ENVIRONMENT;
  options.server = settings.server.empty() ? nullptr : settings.server.c_str();
  options.outbox = settings.outbox.empty() ? nullptr : settings.outbox.c_str();
  options.security = settings.security.empty() ? nullptr : settings.security.c_str();
  options.timeout_ms = static_cast<std::uint32_t>(settings.timeout_ms);
  kinship_client* client = nullptr;
  if (kinship_client_open(&options, &client) != KINSHIP_OK)
    throw std::runtime_error(kinship_error_text());
  return Owned<kinship_client>(client);
}

}  // namespace

std::shared_ptr<Session> Session::open(const rclcpp::Node::SharedPtr& node) {
  const std::scoped_lock lock(of_the_process);
  if (auto known = the_session().lock())
    return known;
  try {
    auto made = std::make_shared<Session>(*node);
    the_session() = made;
    return made;
  } catch (const std::exception& error) {
    RCLCPP_ERROR(rclcpp::get_logger("kinship_moveit"), "planned without Kinship: %s", error.what());
    return nullptr;
  }
}

std::shared_ptr<Session> Session::current() {
  const std::scoped_lock lock(of_the_process);
  return the_session().lock();
}

Session::Session(rclcpp::Node& node)
    : settings_(read_settings(node)),
      logger_(rclcpp::get_logger("kinship_moveit")),
      client_(open_client(settings_)) {
  if (const std::string ends = kinship_client_warning(client_.get()); !ends.empty())
    warn_once(ends);
}

std::shared_ptr<Arm> Session::arm(const moveit::core::RobotModel& model, const std::string& group) {
  std::shared_ptr<Arm> arm;
  {
    const std::scoped_lock lock(mutex_);
    if (const auto known = arms_.find(group); known != arms_.end())
      return known->second && known->second->is_ready() ? known->second : nullptr;
    try {
      arm = std::make_shared<Arm>(model, group);
    } catch (const std::invalid_argument& error) {
      arms_[group] = nullptr;
      RCLCPP_WARN(logger_, "planned without Kinship: %s", error.what());
      return nullptr;
    }
    arms_[group] = arm;
  }
  post([this, arm] {
    if (const std::string told = arm->make(*client_, settings_, wants_planners_); !told.empty())
      warn_once(told);
  });
  return nullptr;
}

void Session::warn_once(const std::string& text) {
  const std::scoped_lock lock(mutex_);
  if (told_.insert(text).second)
    RCLCPP_WARN(logger_, "%s", text.c_str());
}

void Session::post(std::function<void()> job) {
  if (!worker_.post(std::move(job)))
    warn_once("more than 1000 reports wait for the disk: some are lost");
}

void Session::set_latest(const std::string& group, std::shared_ptr<const Query> query) {
  const std::scoped_lock lock(mutex_);
  latest_[group] = std::move(query);
}

std::shared_ptr<const Query> Session::latest(const std::string& group) const {
  const std::scoped_lock lock(mutex_);
  const auto known = latest_.find(group);
  return known == latest_.end() ? nullptr : known->second;
}

}  // namespace kinship_moveit
