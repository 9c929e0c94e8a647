#pragma once

#include <sys/types.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

namespace kinship::test {

/// What a process takes of the machine.
struct ProcessFigures {
  double resident_mb = 0;
  int threads = 0;
  int descriptors = 0;
};

/// What a program of this build may keep of what it has freed: AddressSanitizer's quarantine.
#if defined(__SANITIZE_ADDRESS__)
inline constexpr double kQuarantine_mb = 800;
#else
inline constexpr double kQuarantine_mb = 0;
#endif

/// Those of a process of this user, now.
/// \throws std::runtime_error if it has ended.
inline ProcessFigures figures_of(pid_t process) {
  const std::filesystem::path folder = "/proc/" + std::to_string(process);
  ProcessFigures figures;
  std::ifstream status(folder / "status");
  for (std::string line; std::getline(status, line);) {
    const std::size_t colon = line.find(':');
    if (line.starts_with("VmRSS:"))
      figures.resident_mb = std::stod(line.substr(colon + 1)) / 1000;
    else if (line.starts_with("Threads:"))
      figures.threads = std::stoi(line.substr(colon + 1));
  }
  if (figures.resident_mb == 0)
    throw std::runtime_error("process " + std::to_string(process) + " has ended");
  for ([[maybe_unused]] const auto& entry : std::filesystem::directory_iterator(folder / "fd"))
    ++figures.descriptors;
  return figures;
}

}  // namespace kinship::test
