#include "robots/models/ros_packages.hpp"

#include <tinyxml2.h>
#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <string_view>
#include <system_error>
#include <utility>
#include <vector>

#include "proto/types/failure.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::models {
namespace {

namespace fs = std::filesystem;

constexpr const char* kManifest = "package.xml";
constexpr std::size_t kMaxManifestBytes = 262'144;
constexpr int kMaxDepth = 8;                 // of packages below a folder of ROS_PACKAGE_PATH
constexpr std::size_t kMaxFolders = 20'000;  // looked into, of one such folder

/// The name in a folder's package.xml; empty if it has none that can be read.
std::string package_name(const fs::path& folder) {
  std::error_code unreadable;
  if (!fs::is_regular_file(folder / kManifest, unreadable))
    return {};
  try {
    const std::string text = read_text(folder / kManifest, kMaxManifestBytes);
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS)
      return {};
    const tinyxml2::XMLElement* package = document.FirstChildElement("package");
    const tinyxml2::XMLElement* name =
        package == nullptr ? nullptr : package->FirstChildElement("name");
    const std::string found = name == nullptr || name->GetText() == nullptr ? "" : name->GetText();
    const std::size_t begin = found.find_first_not_of(" \t\r\n");
    return begin == std::string::npos
               ? ""
               : found.substr(begin, found.find_last_not_of(" \t\r\n") - begin + 1);
  } catch (const Failure&) {
    return {};
  }
}

bool is_ignored(const fs::path& folder) {
  constexpr std::array<const char*, 3> kMarks = {"COLCON_IGNORE", "AMENT_IGNORE", "CATKIN_IGNORE"};
  std::error_code unreadable;
  for (const char* mark : kMarks)
    if (fs::exists(folder / mark, unreadable))
      return true;
  return folder.filename().string().starts_with('.');
}

/// Packages do not contain packages.
std::optional<fs::path> find_below(const fs::path& top, const std::string& name) {
  std::error_code unreadable;
  std::vector<std::pair<fs::path, int>> open = {{top, 0}};
  for (std::size_t looked = 0; !open.empty() && looked < kMaxFolders; ++looked) {
    const auto [folder, depth] = open.back();
    open.pop_back();
    if (fs::exists(folder / kManifest, unreadable)) {
      if (package_name(folder) == name)
        return folder;
      continue;
    }
    if (depth == kMaxDepth || (depth > 0 && is_ignored(folder)))
      continue;
    for (fs::directory_iterator entry(folder, unreadable), end; !unreadable && entry != end;
         entry.increment(unreadable))
      if (entry->is_directory(unreadable) && !entry->is_symlink(unreadable))
        open.emplace_back(entry->path(), depth + 1);
  }
  return std::nullopt;
}

std::vector<fs::path> folders_of(const char* variable) {
  const char* value = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): nothing sets it
  std::vector<fs::path> folders;
  for (std::string_view rest = value == nullptr ? "" : value; !rest.empty();) {
    const std::size_t end = std::min(rest.find(':'), rest.size());
    if (end > 0)
      folders.emplace_back(rest.substr(0, end));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  return folders;
}

/// "AMENT_PREFIX_PATH (/a/share/arm, /b/share/arm)"
std::string place_text(const char* variable, const std::vector<fs::path>& looked) {
  std::string text;
  for (const fs::path& place : looked)
    text += (text.empty() ? "" : ", ") + place.string();
  return std::string(variable) + " (" + (text.empty() ? "not set" : text) + ")";
}

}  // namespace

PackageSearch find_ros_package(const std::string& name, const fs::path& beside) {
  constexpr const char *kPrefixes = "AMENT_PREFIX_PATH", *kSources = "ROS_PACKAGE_PATH";
  std::error_code unreadable;
  std::vector<fs::path> shares;
  for (const fs::path& prefix : folders_of(kPrefixes)) {
    shares.push_back(prefix / "share" / name);
    if (fs::is_directory(shares.back(), unreadable))
      return {shares.back(), {}};
  }
  const std::vector<fs::path> sources = folders_of(kSources);
  for (const fs::path& source : sources)
    if (auto folder = find_below(source, name))
      return {std::move(folder), {}};
  const fs::path start = fs::absolute(beside, unreadable).lexically_normal();
  for (fs::path folder = start; folder.has_relative_path(); folder = folder.parent_path())
    if (package_name(folder) == name)
      return {folder, {}};
  return {std::nullopt, place_text(kPrefixes, shares) + ", " + place_text(kSources, sources) +
                            ", package.xml in " + start.string() + " and above"};
}

}  // namespace kinship::models
