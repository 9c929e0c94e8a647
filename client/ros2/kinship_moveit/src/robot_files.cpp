#include "robot_files.hpp"

#include <cstdlib>
#include <fstream>
#include <regex>
#include <set>
#include <sstream>
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

/// The packages of the ament index that hold what a URDF names package://NAME/...
std::vector<std::string> packages_in(const std::string& urdf) {
  static const std::regex kPackage("package://([^/\"']+)/");
  const char* prefixes = std::getenv("AMENT_PREFIX_PATH");
  std::set<std::string> found;
  for (std::sregex_iterator it(urdf.begin(), urdf.end(), kPackage), end; it != end; ++it) {
    std::istringstream paths(prefixes != nullptr ? prefixes : "");
    for (std::string prefix; std::getline(paths, prefix, ':');) {
      const fs::path share = fs::path(prefix) / "share" / it->str(1);
      if (fs::is_directory(share)) {
        found.insert(it->str(1) + "=" + share.string());
        break;
      }
    }
  }
  return {found.begin(), found.end()};
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
  packages_ = packages_in(settings.urdf);
  for (const std::string& package : packages_)
    package_texts_.push_back(package.c_str());
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
  file.packages = package_texts_.data();
  file.package_count = package_texts_.size();
  return file;
}

}  // namespace kinship_moveit
