#include "client/link/put_off_tries.hpp"

#include <algorithm>
#include <sstream>
#include <utility>

#include "client/link/durable_file.hpp"
#include "proto/types/failure.hpp"

namespace kinship::link {
namespace {

constexpr std::size_t kMaxTriesBytes = 16'000'000;

}  // namespace

PutOffTries::PutOffTries(const std::filesystem::path& outbox, SetAsideRule rule)
    : file_(outbox / "put_off"), rule_(std::move(rule)) {}

void PutOffTries::load() {
  std::istringstream lines;
  try {
    lines.str(read_file(file_, kMaxTriesBytes));
  } catch (const Failure&) {
    return;  // missing, or damaged: counted from the beginning
  }
  std::string uuid;
  Tries tries;
  while (lines >> uuid >> tries.count >> tries.age_ms >> tries.last_ms)
    if (const std::optional<Uuid> report = Uuid::parse(uuid))
      tries_[*report] = tries;
}

void PutOffTries::save() {
  if (!std::exchange(has_changed_, false))
    return;
  std::string text;
  for (const auto& [uuid, tries] : tries_)
    text += uuid.text() + " " + std::to_string(tries.count) + " " + std::to_string(tries.age_ms) +
            " " + std::to_string(tries.last_ms) + "\n";
  try {
    write_whole(file_, text);
  } catch (const Failure&) {
    has_changed_ = true;
  }
}

void PutOffTries::forget(const Uuid& report_uuid) {
  has_changed_ = tries_.erase(report_uuid) > 0 || has_changed_;
}

std::string PutOffTries::put_off(const Uuid& report_uuid, const std::string& why) {
  constexpr std::int64_t kLongestStep_ms =
      std::chrono::milliseconds(SetAsideRule::kLongestStep).count();
  Tries& tries = tries_[report_uuid];
  const std::int64_t now_ms = rule_.unix_ms();
  if (tries.count++ > 0)
    tries.age_ms += std::clamp<std::int64_t>(now_ms - tries.last_ms, 0, kLongestStep_ms);
  tries.last_ms = now_ms;
  has_changed_ = true;
  const std::chrono::milliseconds age(tries.age_ms);
  if (tries.count < rule_.tries || age < rule_.age)
    return "";
  return "put off " + std::to_string(tries.count) + " times in " +
         std::to_string(std::chrono::duration_cast<std::chrono::hours>(age).count()) +
         " h while others were taken: " + why;
}

}  // namespace kinship::link
