#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <memory>
#include <mutex>
#include <string>
#include <string_view>
#include <vector>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/files/named_store.hpp"
#include "server/store/sqlite/files/store_lock.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"

namespace kinship::store {

/// Watches that what is written is the file that is named. Once it is not, nothing more is read or
/// written until the file is back, and what the lost connection still reads is saved: in the file
/// itself if that has a name, else as FILE.rescued-<time> beside the store, tried again every few
/// seconds until there is room. May be shared between threads, except methods of the
/// writer's thread.
class FileWatch {
 public:
  /// \param lock, readers  outlive the watch.
  /// \param log  takes a line when the file is gone, saved, and back; may be empty.
  FileWatch(std::filesystem::path file, const StoreLock& lock, ReaderPool& readers,
            std::function<void(std::string_view)> log);
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;
  ~FileWatch();  ///< a last try to save

  /// On the writer's thread: the store is open for writing, as new or again.
  void note_opened();
  /// On the writer's thread.
  /// \throws NotTheFile once a name leads elsewhere; then the connection is for keep().
  void require_named();
  /// Takes a connection that shall write no more, and makes no checkpoint when it closes.
  void keep(std::unique_ptr<Database> lost);
  /// The same before the store is opened again; saves first what the connection has.
  void require_named_closed();

  /// Empty while all is well; else the sentence that status and log say.
  std::string trouble() const;

 private:
  void tell(const NamedStore::Finding& found, const std::string& saved);
  void save_lost(const NamedStore::Finding& found);
  std::string save(const NamedStore::Finding& found);
  std::string copy(StoreChange change);
  std::string copy_into(const std::vector<std::filesystem::path>& folders, StoreChange change);
  void log(const std::string& line) const;

  const std::filesystem::path file_;
  ReaderPool& readers_;
  const std::function<void(std::string_view)> log_;
  NamedStore named_;                                  // of the writer's thread, as is saved_
  std::string saved_;                                 // what was saved, and what to do
  std::unique_ptr<Database> lost_;                    // until what it has is saved
  std::chrono::steady_clock::time_point next_try_{};  // to save it
  mutable std::mutex mutex_;
  std::string trouble_;  // guarded by mutex_
};

}  // namespace kinship::store
