#pragma once

#include <chrono>
#include <filesystem>
#include <functional>
#include <future>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <string_view>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/database/writer.hpp"
#include "server/store/sqlite/files/named_store.hpp"
#include "server/store/sqlite/files/store_lock.hpp"
#include "server/store/sqlite/opening/history.hpp"
#include "server/store/sqlite/opening/reader_pool.hpp"
#include "server/store/sqlite/upkeep/content_watch.hpp"
#include "server/store/sqlite/upkeep/rescue.hpp"

namespace kinship::store {

/// Watches that what is written is the file that is named, and that it stays as written. Once it is
/// not, nothing more is read or written until the file is back, or, if its content is what changed,
/// until another one is opened. What the lost connection still reads is saved on a thread of its
/// own (rescue()), tried again every few seconds until there is room. May be shared between
/// threads, except methods of the writer's thread.
class FileWatch {
 public:
  /// \param lock, readers, history  outlive the watch.
  /// \param log  takes a line when the file is gone, saved, and back, from any thread; may be
  ///             empty.
  FileWatch(std::filesystem::path file, const StoreLock& lock, ReaderPool& readers,
            const History& history, std::function<void(std::string_view)> log);
  FileWatch(const FileWatch&) = delete;
  FileWatch& operator=(const FileWatch&) = delete;
  ~FileWatch();  ///< a last try to save

  /// On the writer's thread: the store is open for writing, as new or again.
  void note_opened(Database& writing);
  /// On the writer's thread.
  /// \throws NotTheFile once a name leads elsewhere, or the content is not what was written; then
  ///         the connection is for keep().
  void require_named(Database& writing, LookAt what);
  /// Takes a connection that shall write no more, and makes no checkpoint when it closes.
  void keep(std::unique_ptr<Database> lost);
  /// The same before the store is opened again, once what the connection has is saved.
  void require_named_closed();

  /// Empty while all is well; else the sentence that status and log say.
  std::string trouble() const;

 private:
  NamedStore::Finding find();
  void tell(const NamedStore::Finding& found, const std::string& saved);
  void begin_saving(const NamedStore::Finding& found);
  void take_saved();
  [[noreturn]] void refuse();
  void log(const std::string& line) const;

  const std::filesystem::path file_;
  ReaderPool& readers_;
  const History& history_;
  const std::function<void(std::string_view)> log_;
  // Of the writer's thread; the saving reads named_ and lost_, which nothing changes meanwhile:
  NamedStore named_;
  ContentWatch content_;
  std::optional<NamedStore::Finding> spoilt_;         // the content, which no name brings back
  std::string saved_;                                 // what was saved, and what to do
  std::unique_ptr<Database> lost_;                    // until what it has is saved
  std::chrono::steady_clock::time_point next_try_{};  // to save it
  mutable std::mutex mutex_;
  std::string trouble_;         // guarded by mutex_
  std::future<Rescue> saving_;  // ends before all that it uses
};

}  // namespace kinship::store
