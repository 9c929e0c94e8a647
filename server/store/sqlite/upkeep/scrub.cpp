#include "server/store/sqlite/upkeep/scrub.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <map>
#include <utility>

#include "server/store/sqlite/database/call_item.hpp"
#include "server/store/sqlite/database/page_scan.hpp"
#include "server/store/values/clock.hpp"

namespace kinship::store {
namespace {

constexpr std::uint64_t kPagesOfARead = 32;        // for so long a reader is taken
constexpr std::chrono::milliseconds kLookUp{500};  // a reader is taken for so long
constexpr std::chrono::seconds kBetweenLines{60};
constexpr std::chrono::milliseconds kIdle{1000};
constexpr std::chrono::milliseconds kRest{10'000};  // between two passes

std::string describe(const std::map<std::uint64_t, PageOwner>& owners, std::size_t all) {
  constexpr std::size_t kNamed = 8;
  std::string words;
  std::size_t named = 0;
  for (const auto& [page, owner] : owners) {
    if (named++ == kNamed)
      break;
    words +=
        (words.empty() ? "page " : ", page ") + std::to_string(page) + " (" + owner.words + ")";
  }
  if (all > kNamed)
    words += " and " + std::to_string(all - kNamed) + " more";
  return words;
}

}  // namespace

Scrub::Scrub(ReaderPool& readers, Writer& writer, std::shared_ptr<PageDamage> damage,
             ScrubOptions options)
    : readers_(&readers),
      writer_(&writer),
      damage_(std::move(damage)),
      options_(std::move(options)),
      thread_([this] { run(); }) {}

Scrub::~Scrub() {
  {
    const std::lock_guard lock(mutex_);
    stopping_ = true;
  }
  wake_.notify_all();
  thread_.join();
}

ScrubProgress Scrub::progress() const {
  const std::lock_guard lock(mutex_);
  return progress_;
}

std::string Scrub::findings() const {
  const std::lock_guard lock(mutex_);
  return findings_;
}

void Scrub::run() {
  constexpr int kNiceness = 15;
  setpriority(PRIO_PROCESS, 0, kNiceness);  // of this thread; refused, it runs as others do
  while (true) {
    std::chrono::milliseconds pause = kIdle;
    try {
      pause = step();
    } catch (const Failure&) {
      // The store is being opened again, or cannot be read at all, which its readers say.
    }
    std::unique_lock lock(mutex_);
    if (wake_.wait_for(lock, pause, [this] { return stopping_; }))
      return;
  }
}

std::chrono::milliseconds Scrub::step() {
  const std::size_t bytes = options_.bytes_per_s > 0 ? read_pages() : 0;
  if (damage_->pages() != named_)
    name_pages();
  log_news();
  if (bytes == 0)
    return kIdle;
  if (next_page_ == 1)
    return kRest;
  return std::chrono::milliseconds(1 + 1000 * bytes / options_.bytes_per_s);
}

/// \return how many bytes were read.
std::size_t Scrub::read_pages() {
  std::vector<std::uint64_t> suspects;
  std::size_t bytes = 0;
  std::uint64_t count = 0;
  {
    const ReaderPool::Lease database = readers_->lease();
    PageReader reader(*database);
    count = reader.count();
    for (std::uint64_t read = 0; read < kPagesOfARead && next_page_ <= count;
         ++read, ++next_page_, bytes += reader.page_size())
      if (!reader.read(next_page_))
        suspects.push_back(next_page_);
  }
  confirm(suspects);
  const std::lock_guard lock(mutex_);
  progress_.part =
      count == 0 ? 1
                 : std::min(1.0, static_cast<double>(next_page_ - 1) / static_cast<double>(count));
  if (next_page_ > count) {
    next_page_ = 1;
    progress_.ended_ms = now_ms();
  }
  return bytes;
}

/// Between two batches, where no page is written.
void Scrub::confirm(const std::vector<std::uint64_t>& suspects) {
  if (suspects.empty())
    return;
  const auto read_again = [&](Database& database) {
    PageReader reader(database);
    for (const std::uint64_t page : suspects)
      if (reader.read(page))
        damage_->forget(page);
    return true;
  };
  auto item = std::make_unique<AfterCommitItem<decltype(read_again)>>(read_again);
  auto done = item->result();
  writer_->submit(std::move(item));
  done.get();
}

void Scrub::name_pages() {
  named_ = damage_->pages();
  std::string words;
  if (!named_.empty()) {
    const ReaderPool::Lease database = readers_->lease();
    words = describe(owners_of(*database, named_, std::chrono::steady_clock::now() + kLookUp),
                     named_.size());
  }
  is_news_ = !words.empty();
  const std::lock_guard lock(mutex_);
  findings_ = std::move(words);
}

/// Once for a burst: damage found soon after waits for the next line.
void Scrub::log_news() {
  const auto now = std::chrono::steady_clock::now();
  if (!is_news_ || now < next_line_)
    return;
  is_news_ = false;
  next_line_ = now + kBetweenLines;
  if (options_.log)
    options_.log("damaged: " + findings());
}

}  // namespace kinship::store
