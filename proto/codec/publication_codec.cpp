#include "proto/codec/publication_codec.hpp"

#include <algorithm>
#include <string>
#include <string_view>

#include "proto/codec/fields.hpp"
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

}  // namespace

std::optional<Error> validate(const Event& event) {
  Rules rules;
  check_fields(event, rules);
  for (const auto& [what, text] :
       {std::pair("task", &event.task), {"robot", &event.robot}, {"text", &event.text}})
    rules.that(std::none_of(text->begin(), text->end(), is_line_break),
               std::string(what) + ": has more than one line");
  return rules.broken();
}

Result<Message<kinship_wire_Announcement>> encode(const Announcement& announcement) {
  return encode_fields(announcement, Message<kinship_wire_Announcement>());
}

Result<Announcement> decode(const kinship_wire_Announcement& wire) {
  return decode_fields<Announcement>(wire);
}

Result<Message<kinship_wire_Event>> encode(const Event& event) {
  Event sent = event;
  sent.task = one_line(event.task, kMaxTaskBytes);
  sent.robot = one_line(event.robot, kMaxLabelBytes);
  sent.text = one_line(event.text, kMaxEventBytes);
  return encode_fields(sent, Message<kinship_wire_Event>(), validate);
}

Result<Event> decode(const kinship_wire_Event& wire) {
  return decode_fields<Event>(wire, validate);
}

}  // namespace kinship::codec
