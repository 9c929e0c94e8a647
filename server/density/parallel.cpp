#include "server/density/parallel.hpp"

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <system_error>
#include <thread>
#include <vector>

namespace kinship::density {

void for_each_part(int threads, int parts, const std::function<void(int)>& part) {
  std::atomic<int> next = 0;
  std::vector<std::exception_ptr> failures(static_cast<std::size_t>(std::max(parts, 0)));
  const auto work = [&] {
    for (int i = next++; i < parts; i = next++) {
      try {
        part(i);
      } catch (...) {
        failures[static_cast<std::size_t>(i)] = std::current_exception();
      }
    }
  };
  {
    std::vector<std::jthread> others;
    try {
      for (int i = 1; i < std::min(threads, parts); ++i)
        others.emplace_back(work);
    } catch (const std::system_error&) {  // no more threads to be had: fewer do the same
    }
    work();
  }
  for (const std::exception_ptr& failure : failures)
    if (failure)
      std::rethrow_exception(failure);
}

}  // namespace kinship::density
