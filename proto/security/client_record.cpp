#include "proto/security/client_record.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <limits>

#include "proto/security/access_role.hpp"
#include "proto/security/credentials.hpp"
#include "proto/types/names.hpp"
#include "proto/types/time_text.hpp"

namespace kinship::security {
namespace {

constexpr std::size_t kMaxNameBytes = 56;
constexpr std::size_t kMaxPatternBytes = 128;

bool is_letter_or_digit(char letter) {
  return (letter >= 'a' && letter <= 'z') || (letter >= 'A' && letter <= 'Z') ||
         (letter >= '0' && letter <= '9');
}

/// Whether 1 to `max_bytes` letters, digits and `others` make up the text.
bool consists_of(std::string_view text, std::size_t max_bytes, std::string_view others) {
  return !text.empty() && text.size() <= max_bytes &&
         std::all_of(text.begin(), text.end(), [&](char letter) {
           return is_letter_or_digit(letter) || others.find(letter) != std::string_view::npos;
         });
}

std::string list_text(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words)
    text += (text.empty() ? "\"" : ", \"") + word + "\"";
  return "[" + text + "]";
}

std::optional<std::chrono::sys_seconds> to_time(const std::optional<toml::date_time>& value) {
  if (!value || !value->offset)
    return std::nullopt;
  const std::chrono::sys_days day{std::chrono::year(value->date.year) /
                                  std::chrono::month(value->date.month) /
                                  std::chrono::day(value->date.day)};
  return day + std::chrono::hours(value->time.hour) + std::chrono::minutes(value->time.minute) +
         std::chrono::seconds(value->time.second) - std::chrono::minutes(value->offset->minutes);
}

/// The fields of a record; each method throws Failure that names text and field.
class RecordFields {
 public:
  RecordFields(std::string_view text, const std::string& what) : what_(what) {
    try {
      table_ = toml::parse(text);
    } catch (const toml::parse_error& error) {
      throw Failure(ErrorCode::InvalidInput, what + ": line " +
                                                 std::to_string(error.source().begin.line) + ": " +
                                                 std::string(error.description()));
    }
  }

  std::string text(std::string_view field) const {
    const auto value = table_[field].value<std::string>();
    if (!value)
      refuse(field, "must be there, as text");
    return *value;
  }

  std::vector<std::string> texts(std::string_view field,
                                 std::optional<Error> (*check)(std::string_view)) const {
    const toml::node* const node = table_.get(field);
    if (node == nullptr || !node->is_array())  // absent would read as narrowed to nothing: all
      refuse(field, "must be there, as a list of texts");
    std::vector<std::string> words;
    for (const toml::node& item : *node->as_array()) {
      words.push_back(item.value<std::string>().value_or(""));
      if (const auto error = check(words.back()))
        refuse(field, error->message);
    }
    return words;
  }

  std::chrono::sys_seconds time(std::string_view field) const {
    const auto value = to_time(table_[field].value<toml::date_time>());
    if (!value)
      refuse(field, "must be there, as a time with offset");
    return *value;
  }

  std::uint32_t generation(std::string_view field) const {
    const auto value = table_[field].value<std::int64_t>();
    if (!value || *value < 1 || *value > std::numeric_limits<std::uint32_t>::max())
      refuse(field, "must be there, as a number from 1 on");
    return static_cast<std::uint32_t>(*value);
  }

  bool has(std::string_view field) const { return table_.get(field) != nullptr; }

  [[noreturn]] void refuse(std::string_view field, const std::string& reason) const {
    throw Failure(ErrorCode::InvalidInput,
                  what_ + ": field '" + std::string(field) + "': " + reason);
  }

 private:
  std::string what_;
  toml::table table_;
};

std::optional<Error> check_fingerprint(std::string_view text) {
  if (consists_of(text, kMaxNameBytes, ""))
    return std::nullopt;
  return invalid_input("'" + cut_text(text, kMaxNameBytes) + "' is no fingerprint");
}

}  // namespace

std::optional<Error> check_client_name(std::string_view name) {
  if (!consists_of(name, kMaxNameBytes, "_-"))
    return invalid_input("name '" + cut_text(name, kMaxNameBytes) +
                         "' is not 1 to 56 of letters, digits, _ and -");
  if (name == kServerName)
    return invalid_input("name 'server' is the server's own");
  return std::nullopt;
}

std::optional<Error> check_task_pattern(std::string_view pattern) {
  if (!consists_of(pattern, kMaxPatternBytes, "_.:-*?"))
    return invalid_input("task pattern '" + cut_text(pattern, kMaxPatternBytes) +
                         "' is not 1 to 128 of letters, digits, _ . : - and the wildcards * ?");
  return std::nullopt;
}

std::string record_text(const ClientRecord& record) {
  std::string text = "# A client of kinshipd; written by `kinshipd secure`.\n";
  text += "name = \"" + record.name + "\"\n";
  text += "role = \"" + role_name(record.role) + "\"\n";
  text += "tasks = " + list_text(record.tasks) + "\n";
  text += "robots = " + list_text(record.robots) + "\n";
  text += "serial = \"" + record.serial + "\"\n";
  text += "generation = " + std::to_string(record.generation) + "\n";
  text += "oldest_accepted = " + std::to_string(record.oldest_accepted) + "\n";
  text += "authority = \"" + record.authority + "\"\n";
  text += "trusted = " + list_text(record.trusted) + "\n";
  text += "expires = " + time_text(record.expires) + "\n";
  if (record.revoked)
    text += "revoked = " + time_text(*record.revoked) + "\n";
  return text;
}

Result<ClientRecord> read_record(std::string_view text, const std::string& what) {
  try {
    const RecordFields fields(text, what);
    ClientRecord record;
    record.name = fields.text("name");
    if (const auto error = check_client_name(record.name))
      fields.refuse("name", error->message);
    const Result<AccessRole> role = read_role(fields.text("role"));
    if (!role)
      fields.refuse("role", role.error().message);
    record.role = *role;
    record.tasks = fields.texts("tasks", check_task_pattern);
    record.robots = fields.texts("robots", check_label);
    record.serial = fields.text("serial");
    record.generation = fields.generation("generation");
    record.oldest_accepted = fields.generation("oldest_accepted");
    record.authority = fields.text("authority");
    record.trusted = fields.texts("trusted", check_fingerprint);
    record.expires = fields.time("expires");
    if (fields.has("revoked"))
      record.revoked = fields.time("revoked");
    return record;
  } catch (const Failure& failure) {
    return failure.error();
  }
}

Caller caller_of(const ClientRecord& record) {
  return {.client = record.name,
          .name = record.name,
          .role = record.role,
          .tasks = record.tasks,
          .robots = record.robots,
          .is_local = false};
}

}  // namespace kinship::security
