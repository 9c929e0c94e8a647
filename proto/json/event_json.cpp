#include "proto/json/event_json.hpp"

#include <nlohmann/json.hpp>

#include "proto/json/writer.hpp"
#include "proto/types/enum_text.hpp"

namespace kinship::json {

std::string to_json(const Event& event) {
  OrderedJson object;
  object["time_ms"] = event.time_ms;
  object["kind"] = to_text(event.kind);
  object["task"] = event.task;
  object["robot"] = event.robot;
  object["text"] = event.text;
  return write(kEventFormat, object);
}

}  // namespace kinship::json
