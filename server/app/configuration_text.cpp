#include "server/app/configuration_text.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstddef>
#include <cstdlib>
#include <numeric>

namespace kinship::app {
namespace {

/// Number of letters that are put in, taken out or changed to make one word of another.
/// Source: Wagner and Fischer, The String-to-String Correction Problem (1974).
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 1; i <= a.size(); ++i) {
    std::size_t diagonal = row[0];
    row[0] = i;
    for (std::size_t j = 1; j <= b.size(); ++j) {
      const std::size_t changed = diagonal + (a[i - 1] == b[j - 1] ? 0 : 1);
      diagonal = row[j];
      row[j] = std::min({row[j] + 1, row[j - 1] + 1, changed});
    }
  }
  return row.back();
}

bool belongs_into_a_file(const CLI::Option& option) {
  return option.get_configurable() && !option.get_lnames().empty();
}

/// "command line", "KINSHIP_DOMAIN", "default", or else the file.
std::string origin(const CLI::App& app, const CLI::Option& option,
                   const std::vector<std::string>& arguments) {
  const std::string flag = "--" + option.get_lnames().front();
  const bool is_on_command_line = std::ranges::any_of(arguments, [&](const std::string& argument) {
    return argument == flag || argument.starts_with(flag + "=");
  });
  if (is_on_command_line)
    return "command line";
  if (option.count() == 0)
    return "default";
  const CLI::Option* const file = app.get_config_ptr();
  const std::string variable = option.get_envname();
  // NOLINTNEXTLINE(concurrency-mt-unsafe): before any thread
  const char* const value = variable.empty() ? nullptr : std::getenv(variable.c_str());
  // What the file says goes before the environment, so the two are told apart by their values.
  const bool has_file = file != nullptr && file->count() > 0;
  if (value != nullptr && (!has_file || option.as<std::string>() == value))
    return variable;
  return file->as<std::string>();
}

/// A number as it is, else a string of TOML.
std::string toml_value(const std::string& value) {
  double number = 0;
  if (CLI::detail::lexical_cast(value, number))
    return value;
  std::string text = "\"";
  for (const char letter : value) {
    if (letter == '"' || letter == '\\')
      text += '\\';
    text += letter;
  }
  return text + '"';
}

}  // namespace

std::string configuration_text(const CLI::App& app, const std::vector<std::string>& arguments) {
  std::string text =
      "# Configuration of kinshipd. The command line goes before this file, and that before "
      "KINSHIP_DOMAIN.\n";
  for (const CLI::Option* const option : app.get_options()) {
    if (!belongs_into_a_file(*option))
      continue;
    const std::string value =
        option->count() > 0 ? option->as<std::string>() : option->get_default_str();
    text += "\n# " + option->get_description() + " [" + origin(app, *option, arguments) + "]\n" +
            (value.empty() ? "# " : "") + option->get_lnames().front() + " = " + toml_value(value) +
            '\n';
  }
  return text;
}

std::string suggestion(const CLI::App& app, std::string_view name) {
  constexpr std::size_t kFar = 3;  // beyond it one word is not a misspelt other one
  std::string nearest;
  std::size_t least = kFar;
  for (const CLI::Option* const option : app.get_options())
    for (const std::string& candidate : option->get_lnames())
      if (const std::size_t distance = edit_distance(name, candidate); distance < least) {
        least = distance;
        nearest = candidate;
      }
  return nearest.empty() ? "" : " (did you mean '" + nearest + "'?)";
}

}  // namespace kinship::app
