#include "proto/manual/suggestion.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <ostream>
#include <vector>

#include "proto/types/exit_code.hpp"
#include "proto/types/nearest_name.hpp"

namespace kinship::manual {

std::string suggestion_for(const CLI::App& app, const std::string& word) {
  std::vector<std::string> candidates;
  const CLI::App* verb = &app;
  for (;;) {
    if (word.starts_with("--"))
      for (const CLI::Option* const option : verb->get_options())
        std::ranges::transform(option->get_lnames(), std::back_inserter(candidates),
                               [](const std::string& name) { return "--" + name; });
    const auto understood = verb->get_subcommands();
    if (understood.empty())
      break;
    verb = understood.front();
  }
  if (!word.starts_with("--"))
    for (const CLI::App* const other : verb->get_subcommands([](const CLI::App*) { return true; }))
      if (!other->get_group().empty())  // not a hidden one
        candidates.push_back(other->get_name());
  return suggestion(word.substr(0, word.find('=')), candidates);
}

int explain(const CLI::App& app, const CLI::ParseError& error, std::ostream& out,
            std::ostream& err) {
  const std::vector<std::string> unknown = app.remaining(true);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !unknown.empty()) {
    err << app.get_name() << ": unknown command or argument '" << unknown.front() << "'"
        << suggestion_for(app, unknown.front()) << " (see: " << app.get_name() << " --help)\n";
    return kWrongUsage;
  }
  const int code = app.exit(error, out, err);
  if (dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr)
    for (const std::string& word : unknown)
      if (const std::string near = suggestion_for(app, word); !near.empty())
        err << word << near << '\n';
  return code == 0 ? kDone : kWrongUsage;
}

}  // namespace kinship::manual
