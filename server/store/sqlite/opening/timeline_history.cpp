#include "server/store/sqlite/opening/timeline_history.hpp"

#include <algorithm>
#include <sstream>

namespace kinship::store {
namespace {

constexpr std::size_t kMaxRuns = 256;

}  // namespace

void TimelineHistory::begin(const Uuid& run, std::uint64_t position) {
  // The first of an epoch names the position at which that began.
  if (runs_.size() > 1 && runs_.back().start == position)
    runs_.pop_back();
  runs_.push_back({run, position});
  if (runs_.size() > kMaxRuns) {
    runs_.erase(runs_.begin());
    forgotten_until_ = runs_.front().start;
  }
}

LogPosition TimelineHistory::at(std::uint64_t position) const {
  auto run = runs_.rbegin();
  while (run != runs_.rend() && run->start >= position && run + 1 != runs_.rend())
    ++run;
  return run == runs_.rend() ? LogPosition{} : LogPosition{run->id, position};
}

bool TimelineHistory::contains(const LogPosition& point, std::uint64_t position) const {
  const auto run = std::ranges::find(runs_, point.run, &Run::id);
  if (run == runs_.end())
    return point.position <= forgotten_until_;
  const bool is_last = run + 1 == runs_.end();
  return point.position <= (is_last ? position : (run + 1)->start);
}

std::string TimelineHistory::text() const {
  std::string text = epoch_.text() + "\n" + std::to_string(forgotten_until_) + "\n";
  for (const Run& run : runs_)
    text += run.id.text() + " " + std::to_string(run.start) + "\n";
  return text;
}

std::optional<TimelineHistory> TimelineHistory::parse(std::string_view text) {
  std::istringstream stream{std::string(text)};
  std::string word;
  stream >> word;
  const std::optional<Uuid> epoch = Uuid::parse(word);
  if (!epoch)
    return std::nullopt;
  TimelineHistory log(*epoch);
  if (!(stream >> log.forgotten_until_))
    return std::nullopt;
  while (stream >> word) {
    const std::optional<Uuid> id = Uuid::parse(word);
    Run run;
    if (!id || !(stream >> run.start) || log.runs_.size() == kMaxRuns)
      return std::nullopt;
    run.id = *id;
    log.runs_.push_back(run);
  }
  return log;
}

}  // namespace kinship::store
