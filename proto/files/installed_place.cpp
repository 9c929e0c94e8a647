#include "proto/files/installed_place.hpp"

namespace kinship::files {

std::filesystem::path own_program() { return std::filesystem::read_symlink("/proc/self/exe"); }

std::filesystem::path installed_place(const std::filesystem::path& name,
                                      const std::filesystem::path& in_sources) {
  const std::filesystem::path installed =
      own_program().parent_path().parent_path() / "share" / "kinship" / name;
  return std::filesystem::exists(installed) ? installed : in_sources;
}

}  // namespace kinship::files
