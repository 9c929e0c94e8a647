#include "server/app/configuration_text.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdlib>
#include <iterator>

#include "server/app/password.hpp"

namespace kinship::app {
namespace {

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
  // The file precedes the environment, so the two are told apart by their values.
  const bool has_file = file != nullptr && file->count() > 0;
  if (value != nullptr && (!has_file || option.as<std::string>() == value))
    return variable;
  return file->as<std::string>();
}

/// A number, true or false as it is, else a string of TOML.
std::string toml_value(const std::string& value) {
  double number = 0;
  if (value == "true" || value == "false" || CLI::detail::lexical_cast(value, number))
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
    const bool is_flag = option->get_expected_max() == 0;
    const std::string value = option->count() > 0 ? option->as<std::string>()
                              : is_flag           ? "false"
                                                  : option->get_default_str();
    const std::string shown = without_password(value);
    text += "\n# " + option->get_description() + " [" + origin(app, *option, arguments) +
            (shown == value ? "" : "; its password is not shown") + "]\n" +
            (shown.empty() ? "# " : "") + option->get_lnames().front() + " = " + toml_value(shown) +
            '\n';
  }
  return text;
}

std::vector<std::string> option_names(const CLI::App& app) {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app.get_options())
    std::ranges::copy(option->get_lnames(), std::back_inserter(names));
  return names;
}

}  // namespace kinship::app
