#include "robot_files.hpp"

#include <cstdlib>
#include <fstream>
#include <stdexcept>

namespace kinship_moveit {
namespace {

namespace fs = std::filesystem;

void write(const fs::path& file, const std::string& text) {
  std::ofstream stream(file);
  stream << text << std::flush;
  if (!stream)
    throw std::invalid_argument("cannot write " + file.string());
}

}  // namespace

RobotFiles::RobotFiles(const Settings& settings) : source_(settings.robot), axes_(settings.axes) {
  if (!source_.empty())
    return;
  if (settings.urdf.empty())
    throw std::invalid_argument("the node has neither robot_description nor kinship.robot");
  std::string name = (fs::temp_directory_path() / "kinship-moveit-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr)
    throw std::invalid_argument("cannot make a folder " + name);
  folder_ = name;
  source_ = (folder_ / "robot.urdf").string();
  write(source_, settings.urdf);
  if (!settings.srdf.empty()) {
    srdf_ = (folder_ / "robot.srdf").string();
    write(srdf_, settings.srdf);
  }
}

RobotFiles::~RobotFiles() {
  std::error_code ignored;
  if (!folder_.empty())
    fs::remove_all(folder_, ignored);
}

kinship_robot_file RobotFiles::describe() const {
  auto file = sized<kinship_robot_file>();
  file.source = source_.c_str();
  file.srdf = srdf_.empty() ? nullptr : srdf_.c_str();
  file.axes = axes_.empty() ? nullptr : axes_.c_str();
  return file;
}

}  // namespace kinship_moveit
