#include "tests/support/twins.hpp"

#include <cstdio>
#include <random>
#include <regex>
#include <sstream>

namespace kinship::test {
namespace {

std::string with_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.12f", value);
  return text;
}

/// What `change` makes of each match of `pattern`; the rest as it is.
template <typename Change>
std::string replaced(const std::string& text, const std::regex& pattern, Change change) {
  std::string result;
  auto rest = text.begin();
  for (std::sregex_iterator match(text.begin(), text.end(), pattern), end; match != end; ++match) {
    result.append(rest, (*match)[0].first);
    result += change(match->str());
    rest = (*match)[0].second;
  }
  return result.append(rest, text.end());
}

}  // namespace

RobotDescription calibrated_twin(RobotDescription robot, const std::string& label, double size,
                                 std::uint64_t seed) {
  std::mt19937_64 generator(seed);
  std::uniform_real_distribution<double> noise(-size, size);
  const auto moved = [&](const std::string& attribute) {  // xyz="1 2 3"
    const std::size_t quote = attribute.find_first_of("\"'");
    std::istringstream numbers(attribute.substr(quote + 1));
    std::string result = attribute.substr(0, quote) + '"';
    double value = 0;
    for (int i = 0; i < 3 && numbers >> value; ++i)
      result += (i > 0 ? " " : "") + with_digits(value + noise(generator));
    return result + '"';
  };
  const std::regex origin("<origin[^>]*>"), three(R"((xyz|rpy)=["'][^"']*["'])");
  robot.label = label;
  if (size > 0)
    robot.urdf = replaced(robot.urdf, origin, [&](const std::string& element) {
      return replaced(element, three, moved);
    });
  return robot;
}

RobotDescription limited_twin(RobotDescription robot, const std::string& label, double limit_rad) {
  robot.label = label;
  const std::regex side(R"((lower|upper)=["'][^"']*["'])");
  robot.urdf = replaced(robot.urdf, side, [limit_rad](const std::string& attribute) {
    return attribute.substr(0, 5) + (attribute[0] == 'l' ? "=\"-" : "=\"") +
           with_digits(limit_rad) + '"';
  });
  return robot;
}

}  // namespace kinship::test
