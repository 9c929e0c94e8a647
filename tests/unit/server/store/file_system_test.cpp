#include "server/store/sqlite/files/file_system.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <linux/magic.h>
#include <unistd.h>

#include <cerrno>

#include "proto/types/failure.hpp"
#include "server/store/sqlite/files/named_store.hpp"
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

TEST(FileSystem, ALockInVainLeavesNoSignOfAStore) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "s.db", lock_file = directory / "s.db.lock";
  const auto fail = [](const std::filesystem::path& path) {
    return StoreLock(path, [] { throw Failure(ErrorCode::Storage, "no room"); });
  };
  EXPECT_EQ(refusal_of(file, fail), "no room");
  EXPECT_FALSE(std::filesystem::exists(lock_file));
  {
    const StoreLock made(file, [&] { make_for_owner(file); });
  }
  EXPECT_TRUE(std::filesystem::exists(lock_file));
  std::filesystem::remove(file);
  { const StoreLock again(file); }
  EXPECT_TRUE(std::filesystem::exists(lock_file)) << "that of a store that is gone";
}

TEST(FileSystem, WhatANameLeadsToIsUnknownUnlessTheSystemSays) {
  const test::TemporaryDirectory directory;
  const std::filesystem::path file = directory / "s.db";
  make_for_owner(file);
  const files::File open(file, O_RDONLY);
  NamedStore named(file, open);
  std::filesystem::remove(file);
  EXPECT_EQ(named.look().change, StoreChange::FileGone);
  std::filesystem::create_symlink(file, file);
  EXPECT_THROW(static_cast<void>(named.look()), files::FileError);
}

}  // namespace
}  // namespace kinship::store::file_system_test
