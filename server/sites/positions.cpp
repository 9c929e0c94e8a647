#include "server/sites/positions.hpp"

#include <charconv>
#include <string_view>
#include <utility>

namespace kinship::sites {
namespace {

constexpr std::string_view kPrefix = "sites.";
constexpr std::string_view kTask = "sites.down.task.";
constexpr std::string_view kRefused = "sites.refused.";
constexpr std::string_view kRefusedWays[] = {"sites.refused.down.", "sites.refused.up."};

std::string hex(const ConsistencyToken& token) {
  constexpr std::string_view kDigits = "0123456789abcdef";
  std::string text;
  for (const std::uint8_t byte : token) {
    text += kDigits[byte >> 4U];
    text += kDigits[byte & 15U];
  }
  return text;
}

ConsistencyToken token_of(std::string_view text) {
  ConsistencyToken token;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2) {
    std::uint8_t byte = 0;
    std::from_chars(text.data() + i, text.data() + i + 2, byte, 16);
    token.push_back(byte);
  }
  return token;
}

/// "number text": the two of them; 0 if there is no number.
template <typename Number>
std::pair<Number, std::string> numbered(const std::string& text) {
  Number number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  const std::size_t blank = text.find(' ');
  return {number, blank == std::string::npos ? std::string() : text.substr(blank + 1)};
}

std::string text_of(const std::map<std::string, std::string>& texts, std::string_view name) {
  const auto found = texts.find(std::string(kPrefix) + std::string(name));
  return found == texts.end() ? std::string() : found->second;
}

}  // namespace

Positions::Positions(store::ReplicationStore& site) : site_(&site), saved_(site.notes(kPrefix)) {
  epochs_ = text_of(saved_, "epochs");
  token = token_of(text_of(saved_, "token"));
  up_retired = text_of(saved_, "up.retired");
  down_retired = text_of(saved_, "down.retired");
  std::tie(passed, up) = numbered<std::uint64_t>(text_of(saved_, "up"));
  for (const auto& [name, text] : saved_) {
    if (name.starts_with(kTask)) {
      const auto [used_ms, cursor] = numbered<std::int64_t>(text);
      tasks[name.substr(kTask.size())] = {cursor, used_ms};
    } else if (name.starts_with(kRefused)) {
      const auto [is_put_off, why] = numbered<int>(text);
      for (const bool is_up : {false, true})
        if (name.starts_with(kRefusedWays[is_up]))
          if (const auto report = Uuid::parse(name.substr(kRefusedWays[is_up].size())))
            refuse({*report, why, is_put_off != 0}, is_up);
    }
  }
  refusals_.clear();  // they are saved
  std::erase_if(saved_, [](const auto& note) { return note.first.starts_with(kRefused); });
}

bool Positions::begin(const Uuid& site_epoch, const Uuid& memory_epoch) {
  std::string epochs = site_epoch.text() + " " + memory_epoch.text();
  if (epochs == epochs_)
    return false;
  epochs_ = std::move(epochs);
  up.clear();
  up_retired.clear();
  down_retired.clear();
  passed = 0;
  token.clear();
  for (const bool is_up : {false, true})
    while (!refused_[is_up].empty())
      accept(Uuid(refused_[is_up].begin()->first), is_up);
  for (auto& [name, task] : tasks)
    task.cursor.clear();
  save();
  return true;
}

void Positions::want(const std::set<std::string>& names, std::int64_t now_ms) {
  constexpr std::int64_t kHour_ms = 3'600'000;
  for (const std::string& name : names) {
    Task& task = tasks[name];
    if (now_ms - task.used_ms > kHour_ms)
      task.used_ms = now_ms;
  }
}

bool Positions::refuse(const RefusedReport& report, bool is_up) {
  std::map<Uuid, Refused>& of_way = refused_[is_up];
  const auto before = of_way.find(report.report_uuid);
  if (before == of_way.end() && kept_[report.is_put_off] >= kMaxRefused)
    return false;
  if (before != of_way.end()) {
    if (before->second.is_put_off == report.is_put_off && before->second.why == report.why)
      return true;
    --kept_[before->second.is_put_off];
  }
  ++kept_[report.is_put_off];
  of_way[report.report_uuid] = {report.why, report.is_put_off};
  refusals_[std::string(kRefusedWays[is_up]) + report.report_uuid.text()] =
      std::string(report.is_put_off ? "1 " : "0 ") + report.why;
  return true;
}

void Positions::accept(const Uuid& report, bool is_up) {
  const auto found = refused_[is_up].find(report);
  if (found == refused_[is_up].end())
    return;
  --kept_[found->second.is_put_off];
  refused_[is_up].erase(found);
  refusals_[std::string(kRefusedWays[is_up]) + report.text()] = std::nullopt;
}

std::map<std::string, std::string> Positions::texts() const {
  std::map<std::string, std::string> texts;
  const auto put = [&texts](std::string_view name, std::string text) {
    texts.emplace(std::string(kPrefix) + std::string(name), std::move(text));
  };
  put("epochs", epochs_);
  put("token", hex(token));
  put("up", std::to_string(passed) + " " + up);
  put("up.retired", up_retired);
  put("down.retired", down_retired);
  for (const auto& [name, task] : tasks)
    texts.emplace(std::string(kTask) + name, std::to_string(task.used_ms) + " " + task.cursor);
  return texts;
}

std::map<std::string, std::optional<std::string>> Positions::changes() const {
  const std::map<std::string, std::string> now = texts();
  std::map<std::string, std::optional<std::string>> changes = refusals_;
  for (const auto& [name, text] : now)
    if (const auto before = saved_.find(name); before == saved_.end() || before->second != text)
      changes[name] = text;
  for (const auto& [name, text] : saved_)
    if (!now.contains(name))
      changes[name] = std::nullopt;
  return changes;
}

void Positions::save() {
  const std::map<std::string, std::optional<std::string>> changed = changes();
  if (changed.empty())
    return;
  site_->put_notes(changed);
  saved_ = texts();
  refusals_.clear();
}

}  // namespace kinship::sites
