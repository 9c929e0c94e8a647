// The processes beside the server are this program again, with a role as its first argument.

#include <gtest/gtest.h>

#include <exception>
#include <functional>
#include <iostream>
#include <map>
#include <string>
#include <vector>

#include "tests/faults/captured_packets.hpp"
#include "tests/faults/fleet_reporter.hpp"
#include "tests/faults/neighbours.hpp"
#include "tests/faults/short_lived_clients.hpp"

int main(int argc, char** argv) {
  using Role = std::function<int(const std::vector<std::string>&)>;
  const std::map<std::string, Role> roles = {
      {"captured", kinship::test::run_captured_client},
      {"neighbour", kinship::test::run_neighbour},
      {"report", kinship::test::run_reporting_client},
      {"short-lived", kinship::test::run_short_lived_clients}};
  const auto role = argc > 1 ? roles.find(argv[1]) : roles.end();
  if (role == roles.end()) {
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
  }
  try {
    return role->second({argv + 2, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << role->first << ": " << error.what() << std::endl;
    return 1;
  }
}
