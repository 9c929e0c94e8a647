// On a terminal of 80 columns nothing that `kinship` tells is wider.

#include <fcntl.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <sstream>
#include <string>
#include <string_view>
#include <vector>

#include "proto/types/characters.hpp"
#include "tests/integration/admin_commands.hpp"
#include "tests/support/places.hpp"

namespace kinship::admin_commands_test {
namespace {

constexpr unsigned short kColumns = 80;

struct Shown {
  std::string text;  ///< both streams
  int code = -1;     ///< of its exit
};

/// A program on a terminal of its own.
Shown on_terminal(const std::string& program, std::vector<std::string> words) {
  winsize size{.ws_row = 25, .ws_col = kColumns, .ws_xpixel = 0, .ws_ypixel = 0};
  words.insert(words.begin(), program);
  std::vector<char*> argv;
  for (std::string& word : words)
    argv.push_back(word.data());
  argv.push_back(nullptr);
  int terminal = -1;
  const pid_t child = forkpty(&terminal, nullptr, nullptr, &size);
  if (child == 0) {
    execv(program.c_str(), argv.data());
    _exit(127);
  }
  std::string text;
  std::array<char, 4096> part{};
  for (ssize_t got = 0; (got = read(terminal, part.data(), part.size())) > 0;)
    text.append(part.data(), static_cast<std::size_t>(got));
  close(terminal);
  int status = 0;
  waitpid(child, &status, 0);
  constexpr std::string_view kBeginAgain =
      "\033[K";  // a line of progress takes the place of another
  for (std::size_t at = 0; (at = text.find(kBeginAgain, at)) != std::string::npos;)
    text.replace(at, kBeginAgain.size(), "\n");
  std::erase(text, '\r');
  return {text, WIFEXITED(status) ? WEXITSTATUS(status) : -1};
}

class TerminalWidth : public AdminCommands {
 protected:
  void expect_fits(int code, const std::string& line) const {
    const Shown shown = on_terminal(test::bin_dir() + "/kinship", server_.with_domain(line, "60"));
    EXPECT_EQ(shown.code, code) << line << ": " << shown.text;
    EXPECT_FALSE(shown.text.empty()) << line;
    std::istringstream lines(shown.text);
    for (std::string each; std::getline(lines, each);)
      EXPECT_LE(character_count(each), std::size_t{kColumns}) << line << ": " << each;
  }
};

TEST_F(TerminalWidth, NoLineIsWiderThanTheTerminal) {
  teach(server_);
  const Digest distribution = fetch_rehearsed(server_).distribution.value().id;
  const std::string uuid = attempts_.front().report_uuid.text();
  for (const char* const listing :
       {"status", "status --clients", "robots list", "tasks list", "paths list", "attempts list",
        "distributions list", "jobs list", "backup list", "audit"})
    expect_fits(0, listing);
  for (const std::string& told :
       {std::string("robots show panda"), std::string("tasks show sweep"), "paths show " + uuid,
        "attempts show " + uuid, "distributions show " + distribution.hex(),
        "distributions explain --distribution " + distribution.hex(),
        std::string("tasks experience sweep"),
        std::string("robots compare --task sweep --targets panda")})
    expect_fits(0, told);
  for (const std::string& unconfirmed : {"paths retire " + uuid, std::string("tasks remove sweep"),
                                         std::string("robots remove panda")})
    expect_fits(2, unconfirmed);
  expect_fits(3, "tasks show swep");
}

}  // namespace
}  // namespace kinship::admin_commands_test
