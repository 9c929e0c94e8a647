#pragma once

#include <chrono>
#include <cstddef>
#include <iosfwd>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "pages/mcap/scene_messages.hpp"
#include "pages/mcap/writer.hpp"
#include "proto/types/attempt.hpp"
#include "proto/types/robot_description.hpp"
#include "robots/kinematics/timed_path.hpp"
#include "robots/kinematics/urdf.hpp"

namespace kinship::mcap {

/// A recording of stored paths for viewers: one after the other, each robot moving along its path.
/// Nothing is written before the first path.
///
/// Topics: /transforms (frames of the links that joints move), /fixed_transforms (placement in the
/// frame `task`, links rigid to their parents, transfer frame), /robot (collision solids known
/// without meshes), /scene (objects, held ones in the transfer frame), /hand (the way of the
/// transfer frame's origin). A topic's last message is all that a viewer needs at a time. The frame
/// of a link is LABEL/LINK, the transfer frame LABEL:transfer.
class PathRecording {
 public:
  /// \param out     outlives the object.
  /// \param choice  of the paths, for the metadata, e.g. {"task", "box_to_shelf"}.
  explicit PathRecording(std::ostream& out, std::map<std::string, std::string> choice = {});

  /// \throws Failure with the errors of kinematics::read_model and geometry::read_known_shapes.
  void add_robot(RobotDescription description);

  /// \param attempt  with a path.
  /// \throws Failure(NotFound) if its robot was not added, Failure(InvalidInput) if the path has
  ///         another number of joints; std::invalid_argument without a path.
  void add_path(const Attempt& attempt);

  std::size_t paths() const noexcept { return paths_; }
  std::chrono::nanoseconds duration() const noexcept;

  /// Completes the file of one path or more. The last call.
  void finish();

 private:
  struct Robot {
    kinematics::RobotModel model;
    std::vector<Entity> links;  ///< those with solids
    Eigen::VectorXd speeds;     ///< dof, joint units per second
  };

  void begin();
  void write_fixed(const Robot& robot, const Eigen::Isometry3d& T_task_base);
  void write_moving(const Robot& robot, const Eigen::Ref<const Eigen::VectorXd>& q);
  void write_drawings(const Robot& robot, const Attempt& attempt,
                      const kinematics::TimedPath& path);
  void write_metadata(const Robot& robot, const Attempt& attempt,
                      const kinematics::TimedPath& path);

  std::ostream& out_;
  std::map<std::string, std::string> choice_;
  std::optional<Writer> writer_;
  std::uint16_t transforms_ = 0, fixed_transforms_ = 0, robot_ = 0, scene_ = 0, hand_ = 0;
  std::map<Digest, Robot> robots_;
  std::size_t paths_ = 0;
  std::chrono::nanoseconds now_;
};

}  // namespace kinship::mcap
