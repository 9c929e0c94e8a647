#include "server/app/port_holder.hpp"

#include <charconv>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string_view>
#include <system_error>

namespace kinship::app {
namespace {

namespace fs = std::filesystem;

/// A socket of the port in a table like /proc/net/udp: number, local and remote address as
/// HEX:PORT, state, queues, timer, retransmissions, user, timeout, inode.
std::optional<PortHolder> find_socket(const char* table, std::uint16_t port) {
  std::ifstream stream(table);
  std::string line;
  std::getline(stream, line);  // the names of the columns
  while (std::getline(stream, line)) {
    std::istringstream words(line);
    std::string skipped, local;
    PortHolder holder;
    words >> skipped >> local;
    for (int column = 2; column < 7; ++column)
      words >> skipped;
    words >> holder.user >> skipped >> holder.inode;
    unsigned local_port = 0;
    const char* const begin = local.data() + local.rfind(':') + 1;
    std::from_chars(begin, local.data() + local.size(), local_port, 16);
    if (words && local_port == port)
      return holder;
  }
  return std::nullopt;
}

bool holds(const fs::path& process, const std::string& socket) {
  std::error_code error;  // the files of others, or of one that ends just now
  for (fs::directory_iterator file(process / "fd", error), end; !error && file != end;
       file.increment(error)) {
    std::error_code unread;
    if (fs::read_symlink(*file, unread) == socket)
      return true;
  }
  return false;
}

void find_process(PortHolder& holder) {
  const std::string socket = "socket:[" + std::to_string(holder.inode) + "]";
  std::error_code error;
  for (fs::directory_iterator entry("/proc", error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename();
    pid_t process = 0;
    const auto [rest, mistake] = std::from_chars(name.data(), name.data() + name.size(), process);
    if (mistake != std::errc{} || *rest != '\0' || !holds(entry->path(), socket))
      continue;
    holder.process = process;
    std::ifstream stream(entry->path() / "comm");
    std::getline(stream, holder.program);
    return;
  }
}

}  // namespace

std::optional<PortHolder> find_port_holder(std::uint16_t port) {
  for (const char* const table : {"/proc/net/udp", "/proc/net/udp6"})
    if (auto holder = find_socket(table, port)) {
      find_process(*holder);
      return holder;
    }
  return std::nullopt;
}

}  // namespace kinship::app
