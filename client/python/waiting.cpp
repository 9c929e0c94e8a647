#include "client/python/waiting.hpp"

#include <pybind11/pybind11.h>

namespace kinship::python {

void hear_signals() {
  if (PyErr_CheckSignals() != 0)
    throw pybind11::error_already_set();
}

void wait_until(const std::function<bool(std::chrono::milliseconds)>& wait) {
  for (bool is_there = false; !is_there;) {
    {
      const pybind11::gil_scoped_release unlocked;
      is_there = wait(kSignalInterval);
    }
    if (!is_there)  // else the awaited value would be lost
      hear_signals();
  }
}

}  // namespace kinship::python
