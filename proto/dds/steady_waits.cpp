#include "proto/dds/steady_waits.hpp"

#include <dds/dds.h>
#include <dds/ddsrt/sync.h>
#include <dds/security/core/dds_security_timed_cb.h>
#include <dlfcn.h>
#include <pthread.h>

#include <algorithm>
#include <cerrno>
#include <chrono>
#include <cstdint>
#include <cstdlib>
#include <ctime>

#include "proto/dds/binding.hpp"

namespace kinship::dds {
namespace {

template <typename Clock>
dds_time_t now_of() {
  return std::chrono::nanoseconds(Clock::now().time_since_epoch()).count();
}
dds_time_t wall_now() { return now_of<std::chrono::system_clock>(); }

/// The wall clock less the steady one, as first read.
dds_time_t steady_origin() {
  static const dds_time_t kOrigin = wall_now() - now_of<std::chrono::steady_clock>();
  return kOrigin;
}
dds_time_t steady_now() { return steady_origin() + now_of<std::chrono::steady_clock>(); }

/// Whether code is of Cyclone DDS's library, so of none of its plugins.
bool is_of_cyclone(const void* code) {
  static const dl_find_object kLibrary = [] {
    dl_find_object found{};
    _dl_find_object(dlsym(RTLD_NEXT, "dds_time"), &found);
    return found;
  }();
  return code >= kLibrary.dlfo_map_start && code < kLibrary.dlfo_map_end;
}

}  // namespace
}  // namespace kinship::dds

/// In front of the functions of these names in Cyclone DDS: a program's own symbols come before
/// those of libraries.
extern "C" __attribute__((visibility("default"))) dds_time_t dds_time() {
  return kinship::dds::is_of_cyclone(__builtin_return_address(0)) ? kinship::dds::steady_now()
                                                                  : kinship::dds::wall_now();
}

extern "C" __attribute__((visibility("default"))) bool ddsrt_cond_waituntil(ddsrt_cond_t* condition,
                                                                            ddsrt_mutex_t* mutex,
                                                                            dds_time_t until) {
  if (until == DDS_NEVER) {
    ddsrt_cond_wait(condition, mutex);
    return true;
  }
  const dds_time_t steady = std::max<dds_time_t>(until - kinship::dds::steady_origin(), 0);
  const timespec end{steady / DDS_NSECS_IN_SEC, steady % DDS_NSECS_IN_SEC};
  // The C library's own: ThreadSanitizer is told to leave out what Cyclone DDS locks, and would
  // miss the lock that its own wait opens.
  static const auto kWait = reinterpret_cast<decltype(&pthread_cond_clockwait)>(
      dlsym(RTLD_NEXT, "pthread_cond_clockwait"));  // NOLINT: what dlsym is for
  const int result = kWait(&condition->cond, &mutex->mutex, CLOCK_MONOTONIC, &end);
  if (result != 0 && result != ETIMEDOUT)
    std::abort();
  return result == 0;
}

/// Called by plugins, with a time of the wall clock.
extern "C" __attribute__((visibility("default"))) dds_security_time_event_handle_t
dds_security_timed_dispatcher_add(dds_security_timed_dispatcher* dispatcher,
                                  dds_security_timed_cb_t callback, dds_time_t when,
                                  void* argument) {
  static const auto kBehind = reinterpret_cast<decltype(&dds_security_timed_dispatcher_add)>(
      dlsym(RTLD_NEXT, "dds_security_timed_dispatcher_add"));  // NOLINT: what dlsym is for
  const dds_time_t behind = kinship::dds::steady_now() - kinship::dds::wall_now();
  const bool is_never = when >= DDS_NEVER - std::max<dds_time_t>(behind, 0);
  return kBehind(dispatcher, callback, is_never ? DDS_NEVER : when + behind, argument);
}

bool kinship::dds::are_waits_steady() {
  const auto is_in_front = [](const char* name, auto* function) {
    return is_in_front_of_cyclone(name, reinterpret_cast<void*>(function));  // NOLINT: as above
  };
  return is_in_front("dds_time", &dds_time) &&
         is_in_front("ddsrt_cond_waituntil", &ddsrt_cond_waituntil);
}
