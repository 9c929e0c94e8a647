#include <iostream>

#include "client/cli/commands.hpp"

int main(int argc, char** argv) { return kinship::cli::run(argc, argv, std::cout, std::cerr); }
