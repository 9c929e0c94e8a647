#include "arm.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "robot_files.hpp"

namespace kinship_moveit {
namespace {

template <typename Handle>
std::shared_ptr<Handle> share(Handle* handle) {
  return std::shared_ptr<Handle>(handle, Release());
}

}  // namespace

Arm::Arm(const moveit::core::RobotModel& model, const std::string& group)
    : group_(group), model_name_(model.getName()) {
  if (!model.hasJointModelGroup(group))
    throw std::invalid_argument("there is no group '" + group + "'");
  const moveit::core::JointModelGroup& joints = *model.getJointModelGroup(group);
  if (!joints.isChain() || joints.getLinkModelNames().empty())
    throw std::invalid_argument("group '" + group + "' is no chain");
  const auto* base = joints.getJointModels().front()->getParentLinkModel();
  base_link_ = base != nullptr ? base->getName() : model.getRootLinkName();
  tip_link_ = joints.getLinkModelNames().back();
  dof_ = joints.getVariableCount();
}

std::string Arm::make(kinship_client& client, const Settings& settings, bool plans) {
  try {
    const RobotFiles files(settings);
    const std::string label =
        settings.label.empty() ? model_name_ + "_" + group_ : settings.label + "_" + group_;
    auto file = files.describe();
    file.base_link = base_link_.c_str();
    file.tip_link = tip_link_.c_str();
    file.label = label.c_str();
    file.T_tip_transfer = settings.T_tip_transfer.data();
    std::size_t dof = 0;
    const kinship_code code = kinship_register_file(&client, &file, &robot_, &dof);
    if (code != KINSHIP_OK && code != KINSHIP_UNAVAILABLE)
      return "group '" + group_ + "' is planned without Kinship: " + kinship_error_text();
    const std::string away = code == KINSHIP_OK ? "" : kinship_error_text();
    if (dof != dof_)
      return "group '" + group_ + "' is planned without Kinship: it has " + std::to_string(dof_) +
             " variables, its chain " + std::to_string(dof) + " joints";
    kinship_planner* planner = nullptr;
    if (plans && kinship_planner_create(&file, &planner, nullptr) != KINSHIP_OK)
      return "group '" + group_ + "' has no planner of Kinship: " + kinship_error_text();
    if (planner != nullptr)
      planner_ = share(planner);
    is_ready_ = true;
    return away.empty() ? ""
                        : "no server of Kinship answers (" + away +
                              "): planning goes on without guidance, reports wait in the outbox";
  } catch (const std::exception& error) {
    return "group '" + group_ + "' is planned without Kinship: " + error.what();
  }
}

Arm::Followed* Arm::find(kinship_client& client, const Settings& settings, const std::string& task,
                         const Eigen::Isometry3d& T_task_base) {
  const PoseNumbers pose = to_numbers(T_task_base);
  Key key{task, {}};
  for (std::size_t i = 0; i < pose.size(); ++i)
    key.second[i] = std::lround(pose[i] * 1000);
  ++queries_;
  if (const auto known = followed_.find(key); known != followed_.end()) {
    known->second.used = queries_;
    return &known->second;
  }
  constexpr std::size_t kMaxFollowed = 16;  // each has a thread, and a lease of the server's
  if (followed_.size() >= kMaxFollowed)
    followed_.erase(std::min_element(
        followed_.begin(), followed_.end(),
        [](const auto& a, const auto& b) { return a.second.used < b.second.used; }));
  auto request = sized<kinship_request>();
  request.robot = &robot_;
  request.task = task.c_str();
  request.T_task_base = pose.data();
  if (!settings.profile.empty())
    request.profile = settings.profile.c_str();
  request.with_recall = settings.offers_recall ? 1 : 0;
  kinship_follower* follower = nullptr;
  if (kinship_follower_open(&client, &request, &follower) != KINSHIP_OK)
    return nullptr;
  Followed& made = followed_[key];
  made.follower.reset(follower);
  made.used = queries_;
  return &made;
}

void Arm::refresh(Followed& followed, std::uint32_t wait_ms, std::string& why) {
  kinship_distribution* newer = nullptr;
  const kinship_code code = kinship_follower_newer(
      followed.follower.get(), followed.held.distribution.get(), wait_ms, &newer);
  if (code == KINSHIP_OK) {
    kinship_sampler* sampler = nullptr;
    auto info = sized<kinship_distribution_info>();
    followed.held.distribution = share(newer);
    kinship_distribution_describe(newer, &info);
    followed.held.share = info.recommended_share;
    kinship_sampler_create(newer, &sampler);
    followed.held.sampler = sampler != nullptr ? share(sampler) : nullptr;
  } else if (code != KINSHIP_PENDING) {
    followed.held.distribution = nullptr;
    followed.held.sampler = nullptr;
    why = kinship_error_text();
  }
  kinship_recall* recall = nullptr;
  const kinship_code recalled =
      kinship_follower_recall(followed.follower.get(), followed.held.recall.get(), &recall);
  if (recalled == KINSHIP_OK)
    followed.held.recall = share(recall);
  else if (recalled == KINSHIP_NO_EXPERIENCE)
    followed.held.recall = nullptr;
}

Guidance Arm::guidance(kinship_client& client, const Settings& settings, const std::string& task,
                       const Eigen::Isometry3d& T_task_base, std::string& why) {
  const std::scoped_lock lock(mutex_);
  Followed* followed = find(client, settings, task, T_task_base);
  if (followed == nullptr) {
    why = kinship_error_text();
    return {};
  }
  const bool is_first = !std::exchange(followed->was_awaited, true);
  refresh(*followed, is_first ? static_cast<std::uint32_t>(settings.first_wait_ms) : 0, why);
  return followed->held;
}

void Arm::follow(kinship_client& client, const Settings& settings, const std::string& task,
                 const Eigen::Isometry3d& T_task_base) {
  const std::scoped_lock lock(mutex_);
  find(client, settings, task, T_task_base);
}

}  // namespace kinship_moveit
