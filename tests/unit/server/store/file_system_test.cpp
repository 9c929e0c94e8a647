#include "server/store/sqlite/files/file_system.hpp"

#include <gtest/gtest.h>
#include <linux/magic.h>
#include <unistd.h>

#include <cerrno>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/files/store_file.hpp"
#include "server/store/sqlite/files/store_lock.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::file_system_test {
namespace {

template <typename Use = decltype(locate_store)>
std::string refusal_of(const std::filesystem::path& file, const Use& use = locate_store) {
  try {
    static_cast<void>(use(file));
  } catch (const Failure& failure) {
    return failure.what();
  }
  return "no refusal";
}

TEST(FileSystem, KnowsNetworkFilesystemsByTheirType) {
  EXPECT_EQ(network_filesystem_of(NFS_SUPER_MAGIC), "NFS");
  EXPECT_EQ(network_filesystem_of(SMB_SUPER_MAGIC), "SMB");
  EXPECT_EQ(network_filesystem_of(V9FS_MAGIC), "9P");
  EXPECT_EQ(network_filesystem_of(EXT4_SUPER_MAGIC), "");
  EXPECT_EQ(network_filesystem_of(TMPFS_MAGIC), "");
  EXPECT_EQ(network_filesystem_of(OVERLAYFS_SUPER_MAGIC), "");
}

TEST(FileSystem, DirectoriesOfThisMachineMayHoldAStore) {
  const test::TemporaryDirectory directory;
  EXPECT_NO_THROW(require_local_filesystem(directory / "s.db", directory.path()));
}

TEST(FileSystem, ErrorsSayWhatToChange) {
  EXPECT_EQ(explain_file_error(EROFS, "/data"),
            "lies on a read-only filesystem; mount it with write access, or name a file elsewhere "
            "(--store FILE)");
  EXPECT_EQ(explain_file_error(EACCES, "/data"),
            "user " + std::to_string(geteuid()) +
                " may not write in '/data'; give it to that user, or name a file elsewhere "
                "(--store FILE)");
  EXPECT_EQ(explain_file_error(EMFILE, "/data"), "Too many open files");
}

TEST(FileSystem, AnAddressIsNoStore) {
  EXPECT_EQ(refusal_of("postgresql://db.example/kinship"),
            "store 'postgresql://db.example/kinship': is an address (postgresql://); a store is a "
            "file of this machine");
  EXPECT_EQ(
      refusal_of("file:s/a.db?mode=ro"),
      "store 'file:s/a.db?mode=ro': is an address (file:); a store is a file of this machine");
  EXPECT_EQ(refusal_of(":memory:"),
            "store ':memory:': would be lost with the process; a store is a file");
  const test::TemporaryDirectory directory;
  EXPECT_EQ(refusal_of(directory / "a:b" / "http://x"), "no refusal");  // an odd name is a name
}

TEST(FileSystem, OneProcessHasAStoreAtATime) {
  const test::TemporaryDirectory directory;
  const StoreLock held(directory / "s.db");
  const auto lock = [](const std::filesystem::path& file) { return StoreLock(file); };
  EXPECT_EQ(refusal_of(directory / "s.db", lock), "store '" + (directory / "s.db").string() +
                                                      "' is open in another server, process " +
                                                      std::to_string(getpid()));
  EXPECT_NE(refusal_of("/proc/kinship/s.db", lock).find("file '/proc/kinship/s.db.lock': "),
            std::string::npos);
}

}  // namespace
}  // namespace kinship::store::file_system_test
