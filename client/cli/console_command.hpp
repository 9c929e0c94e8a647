#pragma once

#include <filesystem>
#include <iosfwd>

#include "client/link/client.hpp"

namespace kinship::cli {

/// `console`: prints the link that lets a browser into the server's console, from the file that the
/// server keeps beside its store.
/// \param file  of the link; empty: that of the store that the server names.
/// \return      kNotFound if the server serves no console, or its file is not on this machine.
int print_console_link(link::Client& server, std::filesystem::path file, std::ostream& out,
                       std::ostream& err);

}  // namespace kinship::cli
