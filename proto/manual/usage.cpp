#include "proto/manual/usage.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <sstream>
#include <string_view>

namespace kinship::manual {
namespace {

constexpr std::array<std::string_view, 5> kFromServer = {"ROBOT", "TASK", "DISTRIBUTION", "PATH",
                                                         "JOB"};

OptionUsage option_usage(const CLI::Option& option) {
  OptionUsage usage;
  for (const std::string& name : option.get_snames())
    usage.names.push_back("-" + name);
  for (const std::string& name : option.get_lnames())
    usage.names.push_back("--" + name);
  if (option.get_positional())
    usage.argument = option.get_name(true, false);
  usage.description = option.get_description();
  usage.environment = option.get_envname();
  usage.default_text = option.get_default_str();
  usage.takes_value = option.get_type_size() != 0;
  usage.is_required = option.get_required();
  usage.is_repeatable = option.get_expected_max() >= CLI::detail::expected_max_vector_size;
  if (usage.takes_value)
    usage.value = value_usage(option.get_type_name());
  return usage;
}

void add_options(const CLI::App& app, CommandUsage& command) {
  for (const CLI::Option* const option : app.get_options()) {
    if (option->get_group().empty())
      continue;
    OptionUsage usage = option_usage(*option);
    if (!usage.argument.empty())
      command.arguments.push_back(usage);
    if (!usage.names.empty())
      command.options.push_back(std::move(usage));
  }
}

CommandUsage usage_below(const CLI::App& app, const CommandUsage* above) {
  CommandUsage command;
  command.name = app.get_name();
  command.path = above == nullptr ? "" : above->path + "/" + app.get_name();
  command.description = app.get_description();
  const bool is_from_above = above != nullptr && app.get_parent()->get_footer() == app.get_footer();
  command.footer = is_from_above ? std::string() : app.get_footer();  // CLI11 hands it down
  add_options(app, command);
  if (above != nullptr && app.get_fallthrough()) {
    command.inherited = above->inherited;
    for (const OptionUsage& option : above->options)
      if (std::ranges::find(option.names, "--help") == option.names.end())
        command.inherited.push_back(option);
  }
  for (const CLI::App* const below : app.get_subcommands([](const CLI::App*) { return true; })) {
    if (below->get_name().empty())  // a group of options
      add_options(*below, command);
    else if (!below->get_group().empty())
      command.commands.push_back(usage_below(*below, &command));
  }
  return command;
}

}  // namespace

CommandUsage usage_of(const CLI::App& app) { return usage_below(app, nullptr); }

std::vector<const CommandUsage*> with_all_below(const CommandUsage& command) {
  std::vector<const CommandUsage*> all{&command};
  for (const CommandUsage& below : command.commands)
    for (const CommandUsage* const one : with_all_below(below))
      all.push_back(one);
  return all;
}

ValueUsage value_usage(const std::string& type_name) {
  ValueUsage value;
  const std::size_t begin = type_name.find('{');
  const std::size_t end = type_name.find('}');
  if (begin != std::string::npos && end != std::string::npos && begin < end) {
    value.kind = ValueKind::Words;
    std::istringstream list(type_name.substr(begin + 1, end - begin - 1));
    for (std::string word; std::getline(list, word, ',');) {
      value.words.push_back(word);
      value.name += (value.name.empty() ? "" : "|") + word;
    }
    return value;
  }
  const std::string type = type_name.substr(0, type_name.find(':'));
  const std::string check =
      type.size() < type_name.size() ? type_name.substr(type.size() + 1) : std::string();
  value.name = check.empty() ? type : check;
  if (type == "FILE" || check == "FILE") {
    value.kind = ValueKind::File;
    value.name = "FILE";
  } else if (type == "FOLDER" || check == "DIR") {
    value.kind = ValueKind::Folder;
    value.name = "FOLDER";
  } else if (std::ranges::find(kFromServer, type) != kFromServer.end()) {
    value.kind = ValueKind::FromServer;
    value.name = type;
  }
  return value;
}

}  // namespace kinship::manual
