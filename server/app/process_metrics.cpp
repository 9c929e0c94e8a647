#include "server/app/process_metrics.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>

namespace kinship::app {
namespace {

using metrics::Exposition;

/// Of /proc/self/stat, proc(5): fields 3 to 24, which follow the program's name.
std::optional<std::array<double, 22>> read_stat() {
  std::ifstream stream("/proc/self/stat");
  std::string text;
  std::getline(stream, text);
  const std::size_t name_end = text.rfind(')');
  if (name_end == std::string::npos)
    return std::nullopt;
  std::istringstream words(text.substr(name_end + 1));
  std::string state;
  words >> state;
  std::array<double, 22> fields{};
  for (std::size_t i = 1; i < fields.size(); ++i)
    words >> fields[i];
  return words ? std::optional(fields) : std::nullopt;
}

/// When this machine was started, Unix time, s.
std::optional<double> boot_time_s() {
  std::ifstream stream("/proc/stat");
  for (std::string word; stream >> word;)
    if (double time_s = 0; word == "btime" && stream >> time_s)
      return time_s;
  return std::nullopt;
}

std::optional<std::uint64_t> open_descriptors() {
  std::error_code error;
  std::uint64_t count = 0;
  for (std::filesystem::directory_iterator file("/proc/self/fd", error), end; !error && file != end;
       file.increment(error))
    ++count;
  return error ? std::nullopt : std::optional(count);
}

}  // namespace

void expose_process(Exposition& page) {
  constexpr std::size_t kFirst = 3, kThreads = 20 - kFirst, kStart = 22 - kFirst,
                        kVirtual = 23 - kFirst, kResident = 24 - kFirst;
  if (rusage usage{}; getrusage(RUSAGE_SELF, &usage) == 0) {
    const auto seconds = [](const timeval& time) {
      return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_usec) * 1e-6;
    };
    page.counter("process_cpu_seconds_total", "Processor time of the process.",
                 seconds(usage.ru_utime) + seconds(usage.ru_stime));
  }
  if (const auto stat = read_stat()) {
    page.gauge("process_threads", "Threads of the process.", (*stat)[kThreads]);
    page.gauge("process_virtual_memory_bytes", "Address space of the process.", (*stat)[kVirtual]);
    page.gauge("process_resident_memory_bytes", "Memory of the process.",
               (*stat)[kResident] * static_cast<double>(sysconf(_SC_PAGESIZE)));
    if (const auto boot_s = boot_time_s())
      page.gauge("process_start_time_seconds", "When the process was started, Unix time.",
                 *boot_s + (*stat)[kStart] / static_cast<double>(sysconf(_SC_CLK_TCK)));
  }
  if (const auto count = open_descriptors())
    page.gauge("process_open_fds", "File descriptors of the process.", *count);
  if (rlimit limit{}; getrlimit(RLIMIT_NOFILE, &limit) == 0)
    page.gauge("process_max_fds", "File descriptors that it may have.",
               std::uint64_t{limit.rlim_cur});
}

}  // namespace kinship::app
