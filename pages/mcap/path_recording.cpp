#include "pages/mcap/path_recording.hpp"

#include <ostream>
#include <stdexcept>
#include <utility>

#include "proto/types/enum_text.hpp"
#include "proto/types/failure.hpp"
#include "proto/types/number_text.hpp"
#include "robots/geometry/known_shapes.hpp"
#include "robots/kinematics/forward_kinematics.hpp"

namespace kinship::mcap {
namespace {

using namespace std::chrono_literals;

constexpr std::chrono::nanoseconds kStart = 1s;  // in MCAP a time of 0 can mean that there is none
constexpr std::chrono::nanoseconds kRest = 500ms;  // at the end of a path
constexpr std::chrono::nanoseconds kChange = 1ms;  // to the next: viewers interpolate between times
constexpr double kPerSecond = 30;
constexpr const char* kTimes =
    "made up: every segment of a path lasts as long as its slowest joint needs at the velocity "
    "limit of the URDF (1 rad/s or 0.25 m/s where there is none), without acceleration; the robot "
    "rests for 0.5 s at the end of each path";

constexpr const char* kTask = "task";
constexpr Color kLink = {0.55, 0.6, 0.66, 1}, kApproximateLink = {0.55, 0.6, 0.66, 0.5},
                kObject = {0.76, 0.66, 0.5, 0.8}, kHeld = {0.85, 0.5, 0.12, 1},
                kHand = {0.04, 0.48, 0.46, 1};

std::string link_frame(const kinematics::RobotModel& robot, int link) {
  return robot.description.label + "/" + robot.chain.links()[static_cast<std::size_t>(link)].name;
}

std::string transfer_frame(const kinematics::RobotModel& robot) {
  return robot.description.label + ":transfer";
}

std::vector<Entity> link_entities(const kinematics::RobotModel& robot) {
  std::map<int, Entity> entities;
  for (const geometry::LinkShape& each :
       geometry::read_known_shapes(robot).value_or_throw().shapes.shapes) {
    const std::string frame = link_frame(robot, each.link);
    Entity& entity =
        entities
            .try_emplace(each.link,
                         Entity{frame, frame, each.approximate ? kApproximateLink : kLink})
            .first->second;
    entity.solids.push_back({each.shape, each.T_link_shape});
  }
  std::vector<Entity> list;
  for (auto& [link, entity] : entities)
    list.push_back(std::move(entity));
  return list;
}

/// The poses of links in their parents: those that a joint moves against its parent, or the others.
std::vector<FrameTransform> link_transforms(const kinematics::RobotModel& robot,
                                            const Eigen::Ref<const Eigen::VectorXd>& q,
                                            bool moving) {
  const std::vector<Eigen::Isometry3d> T_base_links = kinematics::link_poses(robot.chain, q);
  const std::vector<kinematics::ChainLink>& links = robot.chain.links();
  std::vector<FrameTransform> transforms;
  for (std::size_t i = 1; i < links.size(); ++i) {
    const auto parent = static_cast<std::size_t>(links[i].parent);
    if ((links[i].joint != links[parent].joint) == moving)
      transforms.push_back({link_frame(robot, links[i].parent),
                            link_frame(robot, static_cast<int>(i)),
                            T_base_links[parent].inverse() * T_base_links[i]});
  }
  return transforms;
}

std::vector<Entity> scene_entities(const kinematics::RobotModel& robot,
                                   const std::optional<RecordedScene>& scene) {
  std::vector<Entity> entities;
  if (!scene)
    return entities;
  for (const SceneObject& object : scene->objects)
    entities.push_back({kTask, object.name, kObject, {{object.shape, object.T_task_object}}});
  for (const HeldObject& held : scene->held)
    entities.push_back({transfer_frame(robot),
                        "held " + held.name,
                        kHeld,
                        {{held.shape, held.T_transfer_object}}});
  return entities;
}

Eigen::Isometry3d placement_of(const Attempt& attempt) {
  return attempt.T_task_base.value_or(Eigen::Isometry3d::Identity());
}

std::map<std::string, std::string> facts_of(const Attempt& attempt, const std::string& label) {
  return {{"report_uuid", attempt.report_uuid.text()},
          {"robot", label},
          {"robot_digest", attempt.robot.hex()},
          {"task", attempt.task},
          {"machine", attempt.machine},
          {"planner", attempt.record.planner},
          {"sampling_mode", std::string(to_text(attempt.record.sampling_mode))},
          {"collision_checks", std::to_string(attempt.record.collision_checks)},
          {"planning_time_s", number_text(attempt.record.planning_time_s)}};
}

}  // namespace

PathRecording::PathRecording(std::ostream& out, std::map<std::string, std::string> choice)
    : out_(out), choice_(std::move(choice)), now_(kStart) {}

void PathRecording::begin() {
  constexpr const char* kProgram = "kinship " KINSHIP_VERSION;
  writer_.emplace(out_, kProgram);
  transforms_ = writer_->add_channel("/transforms", frame_transforms_schema());
  fixed_transforms_ = writer_->add_channel("/fixed_transforms", frame_transforms_schema());
  robot_ = writer_->add_channel("/robot", scene_update_schema());
  scene_ = writer_->add_channel("/scene", scene_update_schema());
  hand_ = writer_->add_channel("/hand", scene_update_schema());
  choice_.insert({{"program", kProgram}, {"times", kTimes}});
  writer_->add_metadata("kinship", choice_);
}

void PathRecording::add_robot(RobotDescription description) {
  Robot robot{kinematics::read_model(std::move(description)).value_or_throw(), {}, {}};
  robot.links = link_entities(robot.model);
  robot.speeds = kinematics::path_speeds(robot.model);
  const Digest digest = robot.model.chain.digest();
  robots_.insert_or_assign(digest, std::move(robot));
}

void PathRecording::add_path(const Attempt& attempt) {
  if (!attempt.path)
    throw std::invalid_argument("PathRecording: attempt " + attempt.report_uuid.text() +
                                " has no path");
  const auto found = robots_.find(attempt.robot);
  if (found == robots_.end())
    throw Failure(ErrorCode::NotFound, "path " + attempt.report_uuid.text() + ": robot " +
                                           attempt.robot.short_hex() + " is not described");
  const Robot& robot = found->second;
  if (attempt.path->dof() != robot.model.chain.dof())
    throw Failure(ErrorCode::InvalidInput, "path " + attempt.report_uuid.text() + ": " +
                                               std::to_string(attempt.path->dof()) +
                                               " joints, robot '" + robot.model.description.label +
                                               "' has " + std::to_string(robot.model.chain.dof()));
  if (!writer_)
    begin();
  const kinematics::TimedPath path = kinematics::timed(*attempt.path, robot.speeds, kPerSecond);
  write_metadata(robot, attempt, path);
  write_fixed(robot, placement_of(attempt));
  write_drawings(robot, attempt, path);
  const std::chrono::nanoseconds start = now_;
  for (std::size_t i = 0; i < path.times.size(); ++i) {
    now_ = start + path.times[i];
    write_moving(robot, path.configurations.col(static_cast<Eigen::Index>(i)));
  }
  now_ += kRest;
  write_fixed(robot, placement_of(attempt));
  write_moving(robot, path.configurations.rightCols<1>());
  now_ += kChange;
  ++paths_;
}

std::chrono::nanoseconds PathRecording::duration() const noexcept { return now_ - kStart; }

void PathRecording::finish() { writer_->finish(); }

void PathRecording::write_fixed(const Robot& robot, const Eigen::Isometry3d& T_task_base) {
  const kinematics::Chain& chain = robot.model.chain;
  const Eigen::VectorXd q = Eigen::VectorXd::Zero(chain.dof());
  std::vector<FrameTransform> transforms = link_transforms(robot.model, q, false);
  transforms.push_back(
      {kTask, link_frame(robot.model, 0), T_task_base * kinematics::link_poses(chain, q).front()});
  transforms.push_back({link_frame(robot.model, chain.find_link(chain.tip_link())),
                        transfer_frame(robot.model), chain.T_tip_transfer()});
  writer_->write(fixed_transforms_, now_, frame_transforms(now_, transforms));
}

void PathRecording::write_moving(const Robot& robot, const Eigen::Ref<const Eigen::VectorXd>& q) {
  writer_->write(transforms_, now_, frame_transforms(now_, link_transforms(robot.model, q, true)));
}

void PathRecording::write_drawings(const Robot& robot, const Attempt& attempt,
                                   const kinematics::TimedPath& path) {
  const std::string& label = robot.model.description.label;
  Entity hand{kTask, "hand", kHand};
  hand.line.resize(3, path.configurations.cols());
  for (Eigen::Index i = 0; i < hand.line.cols(); ++i)
    hand.line.col(i) =
        placement_of(attempt) *
        kinematics::T_base_transfer(robot.model.chain, path.configurations.col(i)).translation();
  hand.caption = label + ", " + attempt.task + ", " + attempt.report_uuid.text();
  hand.metadata = facts_of(attempt, label);
  writer_->write(robot_, now_, scene_update(now_, robot.links));
  writer_->write(scene_, now_, scene_update(now_, scene_entities(robot.model, attempt.scene)));
  writer_->write(hand_, now_, scene_update(now_, {hand}));
}

void PathRecording::write_metadata(const Robot& robot, const Attempt& attempt,
                                   const kinematics::TimedPath& path) {
  auto facts = facts_of(attempt, robot.model.description.label);
  facts["start_ns"] = std::to_string(now_.count());
  facts["end_ns"] = std::to_string((now_ + path.times.back()).count());
  facts["waypoints"] = std::to_string(attempt.path->size());
  writer_->add_metadata("path", facts);
}

}  // namespace kinship::mcap
