#include "server/store/sqlite/files/file_identity.hpp"

#include <fcntl.h>
#include <sys/stat.h>

#include <cerrno>
#include <cstring>

#include "proto/types/failure.hpp"

namespace kinship::store {
namespace {

constexpr std::string_view kUnborn = "-";  // no time of birth

/// The inode, and when it was born.
std::pair<std::string_view, std::string_view> parts_of(std::string_view identity) {
  const std::size_t space = identity.find(' ');
  if (space == std::string_view::npos)
    return {identity, kUnborn};
  return {identity.substr(0, space), identity.substr(space + 1)};
}

}  // namespace

std::string identity_of(const std::filesystem::path& file) {
  struct statx status {};
  if (statx(AT_FDCWD, file.c_str(), AT_STATX_SYNC_AS_STAT, STATX_INO | STATX_BTIME, &status) != 0)
    throw Failure(ErrorCode::Storage, std::string("its inode: ") + std::strerror(errno));
  std::string identity = std::to_string(status.stx_ino) + " ";
  if ((status.stx_mask & STATX_BTIME) == 0)
    return identity.append(kUnborn);
  return identity + std::to_string(status.stx_btime.tv_sec) + "." +
         std::to_string(status.stx_btime.tv_nsec);
}

bool may_be_same_file(std::string_view a, std::string_view b) {
  const auto [inode_a, born_a] = parts_of(a);
  const auto [inode_b, born_b] = parts_of(b);
  return inode_a == inode_b && (born_a == born_b || born_a == kUnborn || born_b == kUnborn);
}

}  // namespace kinship::store
