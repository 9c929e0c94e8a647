#pragma once

#include <malloc.h>

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <ctime>
#include <functional>
#include <numeric>
#include <vector>

namespace kinship::bench {

inline double clock_s(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

inline double wall_s() { return clock_s(CLOCK_MONOTONIC); }
inline double thread_cpu_s() { return clock_s(CLOCK_THREAD_CPUTIME_ID); }
inline double process_cpu_s() { return clock_s(CLOCK_PROCESS_CPUTIME_ID); }

/// \param share  0 the least, 0.5 the median, 1 the greatest.
inline double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  return values.at(static_cast<std::size_t>(share * static_cast<double>(values.size() - 1)));
}

/// 0 of none.
inline double mean(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0) /
         static_cast<double>(std::max<std::size_t>(values.size(), 1));
}

inline double median(std::vector<double> values) { return percentile(std::move(values), 0.5); }

/// The least seconds of several calls: others may use the machine.
inline double least_s(int calls, double (*now_s)(), const std::function<void()>& call) {
  std::vector<double> times_s;
  for (int i = 0; i < calls; ++i) {
    const double start_s = now_s();
    call();
    times_s.push_back(now_s() - start_s);
  }
  return percentile(std::move(times_s), 0);
}

/// What this process has taken from the heap and not given back, MB.
inline double heap_mb() {
  const auto heap = mallinfo2();
  return 1e-6 * static_cast<double>(heap.uordblks + heap.hblkhd);
}

}  // namespace kinship::bench
