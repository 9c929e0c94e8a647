// A client as a process, to be killed: reports one attempt after the other and writes the UUID of
// each that report() returned for, in a line of its own. After the last one it waits for the
// receipts, writes "acknowledged", and goes on without reporting.
//
// reporting_client DOMAIN OUTBOX FIRST COUNT: the numbers of its attempts; COUNT 0: for ever.

#include <unistd.h>

#include <chrono>
#include <cstdint>
#include <exception>
#include <iostream>
#include <string>
#include <thread>

#include "client/link/client.hpp"
#include "tests/support/panda_experience.hpp"
#include "tests/support/robots.hpp"

namespace kinship {
namespace {

using namespace std::chrono_literals;

int report(std::uint32_t domain, const std::string& outbox, std::uint64_t first,
           std::uint64_t count) {
  const Digest panda = test::model_chain("panda").digest();
  link::Client client({.domain = domain, .outbox = outbox});
  for (std::uint64_t number = first; count == 0 || number < first + count; ++number) {
    Attempt attempt = test::panda_attempt(panda, "sweep", number);
    attempt.record.sampling_mode = SamplingMode::Control;
    client.report(attempt);
    const std::string line = attempt.report_uuid.text() + "\n";
    if (write(STDOUT_FILENO, line.data(), line.size()) < 0)
      return 1;
    if (count == 0)
      std::this_thread::sleep_for(2ms);  // so that the test has thousands to look at, not millions
  }
  while (client.flush(60s).pending > 0)
    continue;
  std::cout << "acknowledged" << std::endl;
  while (true)
    pause();
}

}  // namespace
}  // namespace kinship

int main(int argc, char** argv) {
  try {
    if (argc == 5)
      return kinship::report(static_cast<std::uint32_t>(std::stoul(argv[1])), argv[2],
                             std::stoull(argv[3]), std::stoull(argv[4]));
  } catch (const std::exception& exception) {
    std::cerr << exception.what() << '\n';
  }
  return 2;
}
