#include "server/runtime/memory_reserve.hpp"

#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <csignal>
#include <cstddef>
#include <new>
#include <string_view>

namespace kinship::runtime {
namespace {

constexpr std::size_t kReserve = std::size_t{8} << 20U;

std::atomic<std::uint64_t> refusals{0};
std::atomic<void*> reserve{nullptr};

/// Of address space: pages that nobody touches are no memory.
void* take_room(std::size_t bytes) {
  void* const room =
      mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  return room == MAP_FAILED ? nullptr : room;
}

[[noreturn]] void refuse() {
  ++refusals;
  if (void* const room = reserve.exchange(nullptr))
    munmap(room, kReserve);
  throw std::bad_alloc();
}

/// A process that aborts says so itself: Cyclone DDS and SQLite are refused memory without a word.
void tell_end(int /*signal*/) {
  constexpr std::string_view kWords =
      "kinshipd: ended by itself (SIGABRT), as when the system refuses it memory that it cannot do "
      "without; every report with a receipt is in the store; start it again, with more memory\n";
  static_cast<void>(write(STDERR_FILENO, kWords.data(), kWords.size()));
}

}  // namespace

void keep_memory_reserve() {
  reserve = take_room(kReserve);
  std::set_new_handler(refuse);
  std::signal(SIGABRT, tell_end);
}

void renew_memory_reserve() {
  if (reserve != nullptr || std::get_new_handler() != refuse)
    return;
  void* const room = take_room(2 * kReserve);
  if (room == nullptr)
    return;
  munmap(static_cast<char*>(room) + kReserve, kReserve);
  void* none = nullptr;
  if (!reserve.compare_exchange_strong(none, room))
    munmap(room, kReserve);
}

std::uint64_t take_memory_refusals() { return refusals.exchange(0); }

}  // namespace kinship::runtime
