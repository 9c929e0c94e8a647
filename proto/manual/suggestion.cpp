#include "proto/manual/suggestion.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <iterator>
#include <ostream>
#include <vector>

#include "proto/types/exit_code.hpp"
#include "proto/types/nearest_name.hpp"

namespace kinship::manual {

namespace {

/// The deepest verb that was recognised.
const CLI::App& last_verb(const CLI::App& app) {
  const CLI::App* verb = &app;
  while (!verb->get_subcommands().empty())
    verb = verb->get_subcommands().front();
  return *verb;
}

/// For a long name that does not exist: the short option that begins alike, as in `--output`, `-o`.
std::string short_option_for(const CLI::App& verb, const std::string& word) {
  for (const CLI::Option* const option : verb.get_options())
    for (const std::string& letter : option->get_snames())
      if (word.substr(2, 1) == letter)
        return " (did you mean '-" + letter + "'?)";
  return "";
}

}  // namespace

std::string suggestion_for(const CLI::App& app, const std::string& word) {
  std::vector<std::string> candidates;
  const CLI::App& last = last_verb(app);
  if (!word.starts_with("--")) {
    for (const CLI::App* const other : last.get_subcommands([](const CLI::App*) { return true; }))
      if (!other->get_group().empty())  // not a hidden one
        candidates.push_back(other->get_name());
    return suggestion(word, candidates);
  }
  for (const CLI::App* verb = &last; verb != nullptr; verb = verb->get_parent())
    for (const CLI::Option* const option : verb->get_options())
      std::ranges::transform(option->get_lnames(), std::back_inserter(candidates),
                             [](const std::string& name) { return "--" + name; });
  const std::string near = suggestion(word.substr(0, word.find('=')), candidates);
  return near.empty() ? short_option_for(last, word) : near;
}

int explain(const CLI::App& app, const CLI::ParseError& error, std::ostream& out,
            std::ostream& err) {
  const std::vector<std::string> unknown = app.remaining(true);
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr && !unknown.empty()) {
    err << app.get_name() << ": unknown command or argument '" << unknown.front() << "'"
        << suggestion_for(app, unknown.front()) << " (see: " << app.get_name() << " --help)\n";
    return kWrongUsage;
  }
  if (dynamic_cast<const CLI::RequiredError*>(&error) != nullptr &&
      last_verb(app).get_require_subcommand_min() > 0) {
    err << app.help();
    return kWrongUsage;
  }
  const bool is_option_unknown =
      error.get_exit_code() != 0 &&  // --help is an answer all the same
      std::ranges::any_of(unknown, [](const std::string& word) { return word.starts_with("-"); });
  if (is_option_unknown || dynamic_cast<const CLI::ExtrasError*>(&error) != nullptr) {
    bool is_value = false;  // of an option that is told already
    for (const std::string& word : unknown) {
      if (!is_value || word.starts_with("-"))
        err << app.get_name() << ": unknown argument '" << word << "'" << suggestion_for(app, word)
            << '\n';
      is_value = word.starts_with("--") && word.find('=') == std::string::npos;
    }
    return kWrongUsage;
  }
  return app.exit(error, out, err) == 0 ? kDone : kWrongUsage;
}

}  // namespace kinship::manual
