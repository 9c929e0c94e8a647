#include "proto/codec/publication_codec.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "proto/codec/reader.hpp"
#include "proto/codec/writer.hpp"
#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"

namespace kinship::codec {
namespace {

bool is_line_break(char c) { return c == '\n' || c == '\r'; }

/// The start of a text, on one line.
std::string one_line(std::string_view text, std::size_t max_bytes) {
  std::string line = cut_text(text, max_bytes);
  std::replace_if(line.begin(), line.end(), is_line_break, ' ');
  return line;
}

void check_line(std::string_view what, std::string_view text, std::size_t limit, Rules& rules) {
  rules.text(what, text, limit)
      .that(std::none_of(text.begin(), text.end(), is_line_break),
            std::string(what) + ": has more than one line");
}

}  // namespace

std::optional<Error> validate(const Announcement& announcement) {
  return Rules().name(check_task(announcement.task)).broken();
}

std::optional<Error> validate(const Event& event) {
  Rules rules;
  check_line("task", event.task, kMaxTaskBytes, rules);
  check_line("robot", event.robot, kMaxLabelBytes, rules);
  check_line("text", event.text, kMaxEventBytes, rules);
  return rules.broken();
}

Result<Message<kinship_wire_Announcement>> encode(const Announcement& announcement) {
  if (const auto error = validate(announcement))
    return *error;
  Message<kinship_wire_Announcement> message;
  auto& wire = message.wire;
  write_digest(announcement.distribution_id, wire.distribution_id);
  wire.revision = announcement.revision;
  write_uuid(announcement.store_epoch, wire.store_epoch);
  write_digest(announcement.robot, wire.robot);
  wire.task = message.arena->text(announcement.task);
  return message;
}

Result<Announcement> decode(const kinship_wire_Announcement& wire) {
  Reader reader;
  Announcement announcement;
  announcement.distribution_id = read_digest(wire.distribution_id);
  announcement.revision = wire.revision;
  announcement.store_epoch = read_uuid(wire.store_epoch);
  announcement.robot = read_digest(wire.robot);
  announcement.task = reader.text("task", wire.task, kMaxTaskBytes);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(announcement))
    return *error;
  return announcement;
}

Result<Message<kinship_wire_Event>> encode(const Event& event) {
  Message<kinship_wire_Event> message;
  auto& wire = message.wire;
  wire.kind = static_cast<std::uint32_t>(event.kind);
  wire.time_ms = event.time_ms;
  wire.task = message.arena->text(one_line(event.task, kMaxTaskBytes));
  wire.robot = message.arena->text(one_line(event.robot, kMaxLabelBytes));
  wire.text = message.arena->text(one_line(event.text, kMaxEventBytes));
  return message;
}

Result<Event> decode(const kinship_wire_Event& wire) {
  Reader reader;
  Event event;
  event.kind = reader.enumerator("kind", wire.kind, EventKind::Administration);
  event.time_ms = wire.time_ms;
  event.task = reader.text("task", wire.task, kMaxTaskBytes);
  event.robot = reader.text("robot", wire.robot, kMaxLabelBytes);
  event.text = reader.text("text", wire.text, kMaxEventBytes);
  if (reader.rules.broken())
    return *reader.rules.broken();
  if (const auto error = validate(event))
    return *error;
  return event;
}

}  // namespace kinship::codec
