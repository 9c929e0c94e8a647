// Every JSON document as it is written, and what reading says of each way to spoil a member.

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <functional>
#include <nlohmann/json.hpp>

#include "proto/json/admin_rows_json.hpp"
#include "proto/json/attempt_json.hpp"
#include "proto/json/credential_list_json.hpp"
#include "proto/json/distribution_json.hpp"
#include "proto/json/event_json.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/json/problem_json.hpp"
#include "proto/json/robot_answers_json.hpp"
#include "proto/json/robot_description_json.hpp"
#include "proto/json/store_check_json.hpp"
#include "proto/types/sha256.hpp"
#include "tests/golden/every_value.hpp"
#include "tests/golden/pins.hpp"

namespace kinship::json::json_pins_test {
namespace {

/// A document, and what reading and writing makes of a text.
struct Case {
  std::string name;
  std::string text;
  std::function<std::string(const std::string&)> again = nullptr;  ///< empty: it is never read
  bool has_faults = true;  ///< false: those of another document are the same
};

template <typename Value>
std::string error_or(const Result<Value>& value,
                     const std::function<std::string(const Value&)>& write) {
  if (value)
    return write(*value);
  return "error " + std::to_string(static_cast<int>(value.error().code)) + ": " +
         value.error().message;
}

template <typename Value>
Case readable(const std::string& name, const Value& value, Result<Value> (*read)(std::string_view),
              bool has_faults = true) {
  const auto again = [read](const std::string& text) {
    return error_or<Value>(read(text), [](const Value& back) { return to_json(back); });
  };
  return {name, to_json(value), again, has_faults};
}

/// The rows of admin verbs that a table of fields describes.
void add_rows(std::vector<Case>& cases) {
  // Numbers of pins that were written before; a later row has a thousand of its own.
  constexpr std::array<std::uint64_t, 14> kFirst = {900, 1000, 1100, 1150, 1200, 1600, 0,
                                                    500, 1400, 1450, 1500, 1550, 1580, 1650};
  std::size_t place = 0;
  const auto add = [&]<typename Row>(const RowName<Row>& row) {
    const std::uint64_t first = place < kFirst.size() ? kFirst.at(place) : 1000 * place;
    ++place;
    if constexpr (Described<Row>) {
      std::string name(row.name);
      std::ranges::replace(name, ' ', '_');
      cases.push_back(
          readable("rows/" + name, test::Distinct(first).described<Row>(), row_from_json<Row>));
    }
  };
  std::apply([&](const auto&... row) { (add(row), ...); }, kAdminRows);
}

std::string attempt_again(const std::string& text) {
  return error_or<NamedAttempt>(attempt_from_json(text), [](const NamedAttempt& named) {
    return named.label + to_json(named.attempt);
  });
}

std::string experience_again(const std::string& text) {
  return error_or<ExperienceLine>(experience_line_from_json(text), [](const ExperienceLine& line) {
    return std::holds_alternative<RobotDescription>(line)
               ? to_experience_line(std::get<RobotDescription>(line))
               : to_json(std::get<NamedAttempt>(line).attempt);
  });
}

std::vector<Case> cases() {
  using namespace kinship::test;
  std::vector<Case> all = {
      {"attempt", to_json(every_attempt()), attempt_again},
      {"attempt_unsolved", to_json(every_unsolved_attempt()), attempt_again, false},
      {"experience_line", to_experience_line(every_robot_description()), experience_again},
      readable("robot_description", every_robot_description(), robot_description_from_json),
      readable("distribution", every_distribution(), distribution_from_json),
      readable("distribution_kernels", every_kernels(), distribution_from_json, false),
      readable("distribution_failed", every_failure(), distribution_from_json),
      readable("explanation", every_explanation(), row_from_json<Explanation>),
      readable("problem", every_problem(), problem_from_json),
      readable("problem_to_pose", every_pose_problem(), problem_from_json, false),
      readable("problem_from_pose", every_problem_from_pose(), problem_from_json, false),
      readable("problem_result", every_problem_result(), problem_result_from_json),
      {"event", to_json(every_event())},
      {"store_check", to_json(Distinct(1700).described<StoreCheck>())},
      {"credential_list", to_json(Distinct(3300).described<CredentialList>())},
      {"inverse_answer", to_json(every_inverse_answer())},
      {"robot_check", to_json(every_robot_check())},
      {"register_reply", to_json(every_register_reply(), "label")},
  };
  add_rows(all);
  return all;
}

using Pointer = nlohmann::json::json_pointer;

/// The places of a document: of a list the first element alone.
void collect_places(const nlohmann::json& value, const Pointer& here,
                    std::vector<Pointer>& places) {
  if (!here.empty())
    places.push_back(here);
  if (value.is_object())
    for (const auto& [key, member] : value.items())
      collect_places(member, here / key, places);
  if (value.is_array() && !value.empty())
    collect_places(value[0], here / 0, places);
}

/// What a reader may meet instead of a value.
const std::vector<std::pair<std::string, nlohmann::json>>& wrong_values() {
  static const std::vector<std::pair<std::string, nlohmann::json>> kValues = {
      {"null", nullptr},
      {"text", "?"},
      {"long text", std::string(70'000, 'x')},
      {"-1.5", -1.5},
      {"-1", -1},
      {"2^53", std::uint64_t{1} << 53U},
      {"empty object", nlohmann::json::object()},
      {"empty list", nlohmann::json::array()},
      {"long list", nlohmann::json::array_t(5000, nlohmann::json(0))}};
  return kValues;
}

/// Digest of what is written again, in short.
std::string shortened(const std::string& outcome, const std::string& unspoiled) {
  if (outcome.starts_with("error"))
    return outcome;
  return outcome == unspoiled
             ? "as before"
             : "reads as " + Sha256().add(std::string_view(outcome)).finish().short_hex();
}

/// A line for each place and each way to spoil it; neighbours with the same outcome share one.
std::string faults_of(const Case& document) {
  const std::string unspoiled = document.again(document.text);
  const nlohmann::json original = nlohmann::json::parse(document.text);
  std::vector<Pointer> places;
  collect_places(original, Pointer(), places);
  std::string lines;
  for (const Pointer& place : places) {
    std::string ways, last;
    const auto add = [&](const std::string& way, const std::string& outcome) {
      if (!ways.empty() && outcome != last)
        lines += place.to_string() + " [" + ways + "] " + last + "\n";
      ways = ways.empty() || outcome != last ? way : ways + ", " + way;
      last = outcome;
    };
    nlohmann::json spoiled = original;
    nlohmann::json& parent = spoiled[place.parent_pointer()];
    if (parent.is_object())
      parent.erase(place.back());
    else
      parent.erase(0);
    add("missing", shortened(document.again(spoiled.dump()), unspoiled));
    for (const auto& [way, value] : wrong_values()) {
      spoiled = original;
      spoiled[place] = value;
      add(way, shortened(document.again(spoiled.dump()), unspoiled));
    }
    lines += place.to_string() + " [" + ways + "] " + last + "\n";
  }
  return lines;
}

TEST(JsonPins, DocumentsAreWrittenAndFaultsToldAsPinned) {
  for (const Case& document : cases())
    test::expect_pinned(
        "json/" + document.name + ".txt",
        document.text + "\n" + (document.again && document.has_faults ? faults_of(document) : ""));
}

TEST(JsonPins, DocumentsAreReadAndWrittenAgain) {
  for (const Case& document : cases())
    if (document.again)
      EXPECT_EQ(document.again(document.text), document.text) << document.name;
}

}  // namespace
}  // namespace kinship::json::json_pins_test
