#include <pybind11/pybind11.h>

#include "client/python/administration.hpp"
#include "client/python/bindings.hpp"
#include "client/python/errors.hpp"

PYBIND11_MODULE(_kinship, module) {
  using namespace kinship::python;  // NOLINT(google-build-using-namespace): its functions alone
  module.attr("__version__") = KINSHIP_VERSION;
  module.doc() = "The C++ libraries of Kinship; import kinship instead.";
  translate_failures();
  bind_robots(module);
  bind_scenes(module);
  bind_worlds(module);
  bind_distributions(module);
  bind_attempts(module);
  bind_experience(module);
  bind_planning(module);
  bind_events(module);
  bind_client(module);
}
