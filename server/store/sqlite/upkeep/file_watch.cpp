#include "server/store/sqlite/upkeep/file_watch.hpp"

#include <exception>
#include <utility>

namespace kinship::store {
FileWatch::FileWatch(std::filesystem::path file, const StoreLock& lock, ReaderPool& readers,
                     const History& history, std::function<void(std::string_view)> log)
    : file_(std::move(file)),
      readers_(readers),
      history_(history),
      log_(std::move(log)),
      named_(file_, lock.file().value()) {}

FileWatch::~FileWatch() {
  try {
    if (saving_.valid())
      take_saved();
    if (!lost_)
      return;
    if (const NamedStore::Finding found = find(); found.change != StoreChange::None) {
      begin_saving(found);
      take_saved();
    }
  } catch (const std::exception&) {
    // The log has what could not be saved, as of the try before.
  }
}

std::string FileWatch::trouble() const {
  const std::lock_guard lock(mutex_);
  return trouble_;
}

void FileWatch::log(const std::string& line) const {
  if (log_)
    log_(line);
}

void FileWatch::tell(const NamedStore::Finding& found, const std::string& saved) {
  std::string trouble =
      "'" + file_.string() + "' is not the file any more: " + found.text + "; " + saved;
  {
    const std::lock_guard lock(mutex_);
    if (trouble == trouble_)
      return;
    trouble_ = trouble;
  }
  log("not writable: " + trouble);
}

void FileWatch::refuse() {
  readers_.refuse(trouble());
  throw NotTheFile(trouble());
}

void FileWatch::note_opened(Database& writing) {
  named_.note_opened();
  content_.begin();
  content_.look(writing, named_, LookAt::Ends);
}

void FileWatch::require_named(Database& writing, LookAt what) {
  NamedStore::Finding found = named_.look();
  if (found.change == StoreChange::None)
    found = content_.look(writing, named_, what);
  if (found.change == StoreChange::None)
    return;
  if (is_of_content(found.change))
    spoilt_ = found;
  tell(found, "what can be saved of it is being saved");
  refuse();
}

void FileWatch::keep(std::unique_ptr<Database> lost) {
  lost_ = std::move(lost);
  next_try_ = {};
}

/// A file that is back has all itself, unless its content is what changed.
NamedStore::Finding FileWatch::find() {
  if (spoilt_)
    return *spoilt_;
  return lost_ ? named_.look() : named_.look_closed();
}

void FileWatch::require_named_closed() {
  constexpr std::chrono::milliseconds kShort{100};  // most savings end within it
  if (const NamedStore::Finding found = find(); lost_ && !saving_.valid() &&
                                                found.change != StoreChange::None &&
                                                std::chrono::steady_clock::now() >= next_try_)
    begin_saving(found);
  if (saving_.valid() && saving_.wait_for(kShort) == std::future_status::timeout)
    refuse();
  if (saving_.valid())
    take_saved();
  if (const NamedStore::Finding found = find(); found.change != StoreChange::None) {
    tell(found, saved_.empty() ? "it was closed before, so that nothing could be saved" : saved_);
    refuse();
  }
  lost_.reset();
  saved_.clear();
  {
    const std::lock_guard lock(mutex_);
    if (trouble_.empty())
      return;
    trouble_.clear();
  }
  log("'" + file_.string() + "' is the file again");
}

void FileWatch::begin_saving(const NamedStore::Finding& found) {
  const LostStore store{file_, named_, found.change, content_.index(), history_.position()};
  // Without a thread, on the one that takes what was saved.
  saving_ = std::async(std::launch::async | std::launch::deferred, [this, found, store] {
    Rescue saved = rescue(*lost_, store);
    tell(found, saved.text);
    return saved;
  });
}

void FileWatch::take_saved() {
  constexpr std::chrono::seconds kPause{3};
  next_try_ = std::chrono::steady_clock::now() + kPause;
  const Rescue saved = saving_.get();
  saved_ = saved.text;
  if (!saved.is_saved)
    return;
  lost_.reset();
  if (saved.is_in_file && spoilt_ && spoilt_->change == StoreChange::WalSpent)
    spoilt_.reset();
}

}  // namespace kinship::store
