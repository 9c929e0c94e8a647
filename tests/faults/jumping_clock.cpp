#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/mman.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <cerrno>
#include <cstdint>
#include <cstdlib>
#include <ctime>

/// For LD_PRELOAD (JumpingClock): in front of functions of the C library, so that the wall clock of
/// the process is ahead by the seconds that the file KINSHIP_CLOCK holds as a number of 8 bytes, at
/// once. As with the system's clock, a wait until a time goes by it as it is by then; the steady
/// clock and the times of files are the machine's.
namespace {

constexpr std::int64_t kSecond_ns = 1'000'000'000;

std::int64_t ahead_ns() {
  static const auto* const kSeconds = []() -> const std::atomic<std::int64_t>* {
    const char* const name = std::getenv("KINSHIP_CLOCK");
    const int file = name == nullptr ? -1 : ::open(name, O_RDONLY | O_CLOEXEC);
    if (file < 0)
      std::abort();
    void* const mapped = ::mmap(nullptr, sizeof(std::int64_t), PROT_READ, MAP_SHARED, file, 0);
    ::close(file);
    if (mapped == MAP_FAILED)
      std::abort();
    return static_cast<const std::atomic<std::int64_t>*>(mapped);
  }();
  return kSeconds->load() * kSecond_ns;
}

std::int64_t ns_of(const timespec& time) { return time.tv_sec * kSecond_ns + time.tv_nsec; }
timespec time_of(std::int64_t ns) { return {ns / kSecond_ns, ns % kSecond_ns}; }

std::int64_t machine_ns(clockid_t clock) {
  timespec now{};
  ::syscall(SYS_clock_gettime, clock, &now);
  return ns_of(now);
}
std::int64_t wall_ns() { return machine_ns(CLOCK_REALTIME) + ahead_ns(); }

/// How often a condition was signalled, or another of the same place.
std::atomic<std::uint32_t>& signals_of(const pthread_cond_t* condition) {
  static std::array<std::atomic<std::uint32_t>, 1024> counts;
  return counts[reinterpret_cast<std::uintptr_t>(condition) / 16 % counts.size()];  // NOLINT
}

using Signal = int (*)(pthread_cond_t*);
Signal behind(const char* name) {
  return reinterpret_cast<Signal>(dlsym(RTLD_NEXT, name));  // NOLINT: what dlsym is for
}

bool is_steady(const pthread_cond_t& condition) {
  constexpr unsigned kSteady = 2;  // as glibc keeps pthread_condattr_setclock()
  return (condition.__data.__wrefs & kSteady) != 0;
}

}  // namespace

extern "C" {

int clock_gettime(clockid_t clock, timespec* now) noexcept {
  const auto result = static_cast<int>(::syscall(SYS_clock_gettime, clock, now));
  if (result == 0 && (clock == CLOCK_REALTIME || clock == CLOCK_REALTIME_COARSE))
    *now = time_of(ns_of(*now) + ahead_ns());
  return result;
}

int gettimeofday(timeval* now, void* /*zone*/) noexcept {
  const timespec time = time_of(wall_ns());
  *now = {time.tv_sec, time.tv_nsec / 1000};
  return 0;
}

time_t time(time_t* now) noexcept {
  const time_t seconds = wall_ns() / kSecond_ns;
  if (now != nullptr)
    *now = seconds;
  return seconds;
}

int pthread_cond_signal(pthread_cond_t* condition) noexcept {
  static const Signal kBehind = behind("pthread_cond_signal");
  ++signals_of(condition);
  return kBehind(condition);
}

int pthread_cond_broadcast(pthread_cond_t* condition) noexcept {
  static const Signal kBehind = behind("pthread_cond_broadcast");
  ++signals_of(condition);
  return kBehind(condition);
}

/// In slices, after each of which it looks at the clock; a signal between two is seen after the
/// second.
int pthread_cond_timedwait(pthread_cond_t* condition, pthread_mutex_t* mutex,
                           const timespec* until) {
  constexpr std::int64_t kSlice_ns = 20'000'000;
  if (is_steady(*condition))
    return pthread_cond_clockwait(condition, mutex, CLOCK_MONOTONIC, until);
  const std::uint32_t signals = signals_of(condition);
  while (true) {
    const std::int64_t left = ns_of(*until) - wall_ns();
    const timespec slice =
        time_of(machine_ns(CLOCK_MONOTONIC) + std::clamp<std::int64_t>(left, 0, kSlice_ns));
    const int result = pthread_cond_clockwait(condition, mutex, CLOCK_MONOTONIC, &slice);
    if (result != ETIMEDOUT || left <= kSlice_ns)
      return result;
    if (signals_of(condition) != signals)
      return 0;
  }
}

}  // extern "C"
