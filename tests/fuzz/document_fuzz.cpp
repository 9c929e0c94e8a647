// Text as any of the JSON documents that files and standard input bring: a value that writes itself
// so that it reads itself again, or a refusal in words.

#include <array>
#include <string_view>

#include "proto/json/attempt_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/types/profile_text.hpp"
#include "tests/fuzz/demand.hpp"

namespace kinship::fuzz {
namespace {

template <typename Read>
void try_document(Read read, std::string_view text) {
  const auto value = read(text);
  demand_words(value);
  if (!value)
    return;
  const std::string written = json::to_json(*value);
  const auto again = read(written);
  demand(again.has_value(), "what was written can be read: " + written);
}

void try_named_attempt(std::string_view text) {
  const auto named = json::attempt_from_json(text);
  demand_words(named);
  if (named)
    demand(json::attempt_from_json(json::to_json(named->attempt)).has_value(),
           "an attempt can be read again");
}

void try_line(std::string_view text) { demand_words(json::experience_line_from_json(text)); }

void try_profile(std::string_view text) { demand_words(profile_from_text(text)); }

}  // namespace
}  // namespace kinship::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace fuzz = kinship::fuzz;
  namespace json = kinship::json;
  if (size == 0)
    return 0;
  const std::string_view text(reinterpret_cast<const char*>(data) + 1, size - 1);
  switch (data[0]) {
    case 'a':
      fuzz::try_named_attempt(text);
      break;
    case 'd':
      fuzz::try_document(json::distribution_from_json, text);
      break;
    case 'l':
      fuzz::try_line(text);
      break;
    case 'p':
      fuzz::try_document(json::problem_from_json, text);
      break;
    case 'r':
      fuzz::try_document(json::robot_description_from_json, text);
      break;
    case 's':
      fuzz::try_document(json::problem_result_from_json, text);
      break;
    default:
      fuzz::try_profile(text);
  }
  return 0;
}
