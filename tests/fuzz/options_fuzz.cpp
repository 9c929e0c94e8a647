// A configuration file of kinshipd: options within their bounds, or an exit code after a message.

#include <sys/mman.h>
#include <unistd.h>

#include <sstream>

#include "server/app/options.hpp"
#include "tests/fuzz/demand.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  namespace app = kinship::app;
  using kinship::fuzz::demand;
  const int file = memfd_create("kinshipd.ini", 0);
  demand(file >= 0 && write(file, data, size) == static_cast<ssize_t>(size), "a file in memory");
  const std::string name = "/proc/self/fd/" + std::to_string(file);
  const char* const arguments[] = {"kinshipd", "--config", name.c_str()};
  std::ostringstream out, err;
  const app::Options options = app::parse_arguments(3, arguments, out, err);
  if (const auto* const server = std::get_if<app::ServerOptions>(&options)) {
    demand(server->fit_niceness >= 0 && server->fit_niceness <= 19, "a niceness from 0 to 19");
    demand(server->rehearsal_fraction >= 0 && server->rehearsal_fraction <= 1,
           "a fraction from 0 to 1");
    demand(server->workers >= 1 && server->workers <= 256, "1 to 256 workers");
  } else if (const int* const exit_code = std::get_if<int>(&options)) {
    demand(*exit_code == 0 || !err.str().empty(), "a failure says something");
  }
  close(file);
  return 0;
}
