// The processes beside the database are this program again, with a role as its first argument.

#include <gtest/gtest.h>

#include <exception>
#include <iostream>
#include <string_view>

#include "tests/faults/store_clients.hpp"

int main(int argc, char** argv) {
  if (argc < 2 || std::string_view(argv[1]) != "clients") {
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
  }
  try {
    return kinship::test::run_store_clients({argv + 2, argv + argc});
  } catch (const std::exception& error) {
    std::cerr << "clients: " << error.what() << std::endl;
    return 1;
  }
}
