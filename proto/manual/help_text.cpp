#include "proto/manual/help_text.hpp"

#include <CLI/CLI.hpp>
#include <sstream>
#include <string>

#include "proto/manual/usage.hpp"

namespace kinship::manual {
namespace {

constexpr std::size_t kWidth = 80;

std::string wrapped(const std::string& text, std::size_t width) {
  std::string lines;
  std::size_t used = 0;
  std::istringstream words(text);
  for (std::string word; words >> word;) {
    if (used > 0 && used + 1 + word.size() > width) {
      lines += '\n';
      used = 0;
    }
    lines += (used > 0 ? " " : "") + word;
    used += (used > 0 ? 1 : 0) + word.size();
  }
  return lines;
}

class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override {
    if (is_positional)
      return option->get_name(true, false);
    std::string names;
    for (const std::string& name : option->get_snames())
      names += (names.empty() ? "-" : ",-") + name;
    for (const std::string& name : option->get_lnames())
      names += (names.empty() ? "--" : ",--") + name;
    return names;
  }

  std::string make_option_opts(const CLI::Option* option) const override {
    std::string text;
    if (option->get_type_size() != 0) {
      text = " " + value_usage(option->get_type_name()).name;
      if (!option->get_default_str().empty())
        text += "=" + option->get_default_str();
      if (option->get_expected_max() == CLI::detail::expected_max_vector_size)
        text += " ...";
      if (option->get_required())
        text += " REQUIRED";
    }
    if (!option->get_envname().empty())
      text += " (Env:" + option->get_envname() + ")";
    return text;
  }

  std::string make_option_desc(const CLI::Option* option) const override {
    return wrapped(option->get_description(), kWidth - column_width_);
  }

  std::string make_subcommand(const CLI::App* command) const override {
    std::ostringstream out;
    CLI::detail::format_help(out, command->get_name(),
                             wrapped(command->get_description(), kWidth - column_width_),
                             column_width_);
    return out.str();
  }
};

}  // namespace

std::shared_ptr<CLI::FormatterBase> help_formatter() { return std::make_shared<HelpFormatter>(); }

}  // namespace kinship::manual
