#include "client/plan/robot_files.hpp"

#include <fstream>
#include <sstream>
#include <utility>

#include "proto/types/failure.hpp"
#include "proto/types/limits.hpp"
#include "robots/kinematics/urdf.hpp"
#include "robots/models/model_folder.hpp"

namespace kinship::plan {
namespace {

std::string read_urdf_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw Failure(ErrorCode::NotFound, "cannot read '" + file.string() + "'");
  std::string text(kMaxUrdfBytes + 1, '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  text.resize(static_cast<std::size_t>(stream.gcount()));
  if (text.size() > kMaxUrdfBytes)
    throw Failure(ErrorCode::TooLarge,
                  "'" + file.string() + "' exceeds " + std::to_string(kMaxUrdfBytes) + " bytes");
  return text;
}

RobotDescription read_description(const RobotFiles& files) {
  if (!files.model.empty())
    return models::read_model_folder(files.model).value_or_throw();
  RobotDescription description;
  description.label = files.label;
  description.urdf = read_urdf_file(files.urdf);
  description.base_link = files.base_link;
  description.tip_link = files.tip_link;
  description.T_tip_transfer = files.T_tip_transfer;
  return description;
}

}  // namespace

LoadedRobot load_robot(const RobotFiles& files) {
  RobotDescription description = read_description(files);
  kinematics::Chain chain = kinematics::read_chain(description).value_or_throw();
  geometry::RobotShapes shapes = geometry::read_shapes(description, chain).value_or_throw();
  return {std::move(description), {std::move(chain), std::move(shapes)}};
}

}  // namespace kinship::plan
