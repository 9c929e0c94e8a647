#include "server/store/sqlite/files/file_system.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <sys/vfs.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <string_view>
#include <utility>

#include "proto/types/failure.hpp"

namespace kinship::store {
namespace {

/// statfs(2) and linux/magic.h, which has not all of them.
constexpr std::pair<long, std::string_view> kNetworkFilesystems[] = {
    {0x6969, "NFS"},        {0x517B, "SMB"},        {0xFF534D42, "CIFS"},  {0xFE534D42, "SMB"},
    {0x01021997, "9P"},     {0x00C36400, "Ceph"},   {0x5346414F, "AFS"},   {0x6B414653, "AFS"},
    {0x0BD00BD0, "Lustre"}, {0x01161970, "GFS2"},   {0x7461636F, "OCFS2"}, {0x73757245, "Coda"},
    {0x47504653, "GPFS"},   {0x19830326, "BeeGFS"}, {0x564C, "NCP"},
};

constexpr std::string_view kUnborn = "-";  // no time of birth

/// The inode, and when it was born.
std::pair<std::string_view, std::string_view> parts_of(std::string_view identity) {
  const std::size_t space = identity.find(' ');
  if (space == std::string_view::npos)
    return {identity, kUnborn};
  return {identity.substr(0, space), identity.substr(space + 1)};
}

}  // namespace

std::string network_filesystem_of(long type) {
  for (const auto& [known, name] : kNetworkFilesystems)
    if (known == type)
      return std::string(name);
  return {};
}

void require_local_filesystem(const std::filesystem::path& file,
                              const std::filesystem::path& directory) {
  struct statfs found {};
  if (statfs(directory.c_str(), &found) != 0)
    return;  // opening the file tells why
  const std::string name = network_filesystem_of(static_cast<long>(found.f_type));
  if (!name.empty())
    throw Failure(
        ErrorCode::Storage,
        "store '" + file.string() + "': lies on a network filesystem (" + name +
            "), where neither locks nor syncs hold; name a file on a disk of this machine "
            "(backups may go there)");
}

bool is_mount_point(const std::filesystem::path& file) {
  struct statx status {};
  return statx(AT_FDCWD, file.c_str(), AT_STATX_DONT_SYNC, STATX_TYPE, &status) == 0 &&
         (status.stx_attributes & STATX_ATTR_MOUNT_ROOT) != 0;
}

std::string explain_file_error(int reason, const std::filesystem::path& directory) {
  if (reason == EROFS)
    return "lies on a read-only filesystem; mount it with write access, or name a file elsewhere "
           "(--store FILE)";
  if (reason == EACCES || reason == EPERM)
    return "user " + std::to_string(geteuid()) + " may not write in '" + directory.string() +
           "'; give it to that user, or name a file elsewhere (--store FILE)";
  return std::strerror(reason);
}

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
