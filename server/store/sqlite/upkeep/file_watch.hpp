#pragma once

#include <filesystem>
#include <functional>
#include <mutex>
#include <string>
#include <string_view>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/files/named_store.hpp"
#include "server/store/sqlite/files/store_lock.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"

namespace kinship::store {

/// Watches that what is written is the file that is named. Once it is not, nothing more is read or
/// written until the file is back, and what the open connection still reads is saved as
/// FILE.rescued-<time> beside the store. May be shared between threads, except methods of the
/// writer's thread.
class FileWatch {
 public:
  /// \param lock, readers  outlive the watch.
  /// \param log  takes a line when the file is gone, saved, and back; may be empty.
  FileWatch(std::filesystem::path file, const StoreLock& lock, ReaderPool& readers,
            std::function<void(std::string_view)> log);

  /// On the writer's thread: the store is open for writing, as new or again.
  void note_opened();
  /// On the writer's thread, outside of any transaction.
  /// \param writer  the connection that writes; to be closed without a checkpoint on a throw.
  /// \throws NotTheFile once a name leads elsewhere, after saving.
  void require_named(Database& writer);
  /// The same before the store is opened again.
  void require_named_closed();

  /// Empty while all is well; else the sentence that status and log say.
  std::string trouble() const;

 private:
  void tell(const NamedStore::Finding& found, const std::string& saved);
  std::string save(Database& writer, const NamedStore::Finding& found);
  std::string copy(Database& writer, StoreChange change);
  void log(const std::string& line) const;

  const std::filesystem::path file_;
  ReaderPool& readers_;
  const std::function<void(std::string_view)> log_;
  NamedStore named_;   // of the writer's thread, as is saved_
  std::string saved_;  // what was saved, and what to do
  mutable std::mutex mutex_;
  std::string trouble_;  // guarded by mutex_
};

}  // namespace kinship::store
