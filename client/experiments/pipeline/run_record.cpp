#include "client/experiments/pipeline/run_record.hpp"

#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

/// The first line that a command writes; empty if it fails.
std::string first_line(const char* command) {
  struct Close {
    void operator()(FILE* stream) const noexcept { pclose(stream); }
  };
  const std::unique_ptr<FILE, Close> stream(popen(command, "r"));
  std::array<char, 256> text{};
  if (!stream || std::fgets(text.data(), text.size(), stream.get()) == nullptr)
    return "";
  const std::string line = text.data();
  return line.substr(0, line.find('\n'));
}

std::string find_commit() {
  const std::string commit = first_line("git rev-parse --short=12 HEAD 2>/dev/null");
  if (commit.empty())
    return "unknown";
  const bool changed =
      !first_line("git status --porcelain --untracked-files=no 2>/dev/null").empty();
  return commit + (changed ? "+" : "");
}

std::string find_machine() {
  std::string name = "unknown processor";
  std::ifstream stream("/proc/cpuinfo");
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with("model name") && line.find(": ") != std::string::npos) {
      name = line.substr(line.find(": ") + 2);
      break;
    }
  return name + ", " + std::to_string(std::thread::hardware_concurrency()) + " cores";
}

}  // namespace

RunRecord begin_run(const std::string& study, const std::string& side) {
  using namespace std::chrono;
  const auto now = duration_cast<seconds>(system_clock::now().time_since_epoch());
  return {now.count(), find_commit(), find_machine(), study, side, 0, 0};
}

void append_run(const std::filesystem::path& file, const RunRecord& record) {
  nlohmann::ordered_json line;
  line["begun_s"] = record.begun_s;
  line["commit"] = record.commit;
  line["machine"] = record.machine;
  line["study"] = record.study;
  if (!record.side.empty())
    line["side"] = record.side;
  line["planned"] = record.planned;
  line["duration_s"] = record.duration_s;
  std::ofstream stream(file, std::ios::app);
  stream << line.dump() << std::endl;
  if (!stream)
    throw Failure(ErrorCode::Storage, "'" + file.string() + "' cannot be written");
}

}  // namespace kinship::experiments
