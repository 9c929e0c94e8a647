// A message of ROS 2 in a database that somebody brings: a document with the members of the
// message, or a refusal in words.

#include <array>
#include <string_view>

#include "client/moveit/cdr_message.hpp"
#include "client/moveit/message_members.hpp"
#include "tests/fuzz/demand.hpp"

namespace kinship::fuzz {
namespace {

Result<moveit::YamlValue> read(std::string_view bytes, const char* message) {
  try {
    return moveit::YamlValue::of_document(moveit::read_cdr(bytes, message), "fuzz");
  } catch (const Failure& failure) {
    return failure.error();
  }
}

}  // namespace
}  // namespace kinship::fuzz

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  constexpr std::array<const char*, 3> kMessages = {"RobotTrajectory", "PlanningScene",
                                                    "MotionPlanRequest"};
  if (size == 0)
    return 0;
  const char* message = kMessages.at(data[0] % kMessages.size());
  const auto document = kinship::fuzz::read(
      std::string_view(reinterpret_cast<const char*>(data) + 1, size - 1), message);
  kinship::fuzz::demand_words(document);
  if (document)
    kinship::moveit::check_members(*document, message);  // throws if it is no such message
  return 0;
}
