#pragma once

#include <cstdio>
#include <memory>
#include <stdexcept>
#include <string>
#include <variant>
#include <vector>

#include "proto/json/experience_line.hpp"
#include "tests/support/places.hpp"

namespace kinship::bench {

/// What a robot of the study `cobots` learned from: 500 queries of its own, as they were recorded.
struct LearningSet {
  RobotDescription robot;
  std::vector<Attempt> solved;
};

inline const std::vector<std::string>& cobots() {
  static const std::vector<std::string> kRobots = {"iiwa14", "panda", "sara_like", "sawyer",
                                                   "ur10e"};
  return kRobots;
}

/// Reads the learning set of a robot of client/experiments/results with the program zstd.
/// \throws std::runtime_error if it is not there or not what it should be.
inline LearningSet read_learning_set(const std::string& robot) {
  const std::string file = kinship::test::source_dir() +
                           "/client/experiments/results/cobots/learning/" + robot + ".jsonl.zst";
  const std::unique_ptr<std::FILE, int (*)(std::FILE*)> pipe(
      popen(("zstd -dcq '" + file + "'").c_str(), "r"), pclose);
  if (!pipe)
    throw std::runtime_error("zstd cannot be started");
  std::string text;
  std::vector<char> buffer(1U << 20U);
  while (const std::size_t count = std::fread(buffer.data(), 1, buffer.size(), pipe.get()))
    text.append(buffer.data(), count);
  LearningSet set;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find('\n', begin), text.size());
    auto line =
        json::experience_line_from_json({text.data() + begin, end - begin}).value_or_throw();
    if (auto* description = std::get_if<RobotDescription>(&line))
      set.robot = std::move(*description);
    else if (auto& attempt = std::get<json::NamedAttempt>(line).attempt; attempt.path)
      set.solved.push_back(std::move(attempt));
    begin = end + 1;
  }
  if (set.solved.empty() || set.robot.urdf.empty())
    throw std::runtime_error(file + ": no robot, or no solved attempt");
  return set;
}

}  // namespace kinship::bench
