#include "proto/manual/usage.hpp"

#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <sstream>
#include <string>
#include <vector>

#include "proto/manual/manual.hpp"
#include "proto/manual/suggestion.hpp"

namespace kinship::manual::usage_test {
namespace {

/// A program with a group of verbs, whose options are also those of the program.
class Usage : public testing::Test {
 protected:
  Usage() {
    add_manual(app_);
    app_.fallthrough();
    app_.require_subcommand(1);
    app_.add_option("--server", text_, "host")->envname("SERVER");
    CLI::App* const paths = app_.add_subcommand("paths", "Reported paths");
    paths->require_subcommand(1);
    CLI::App* const show = paths->add_subcommand("show", "One path");
    show->footer("Of one.\nExample:\n  tool paths show 7");
    show->add_option("id", text_, "UUID")->required()->type_name("PATH");
    show->add_option("-o", text_, "form")->check(CLI::IsMember({"table", "json"}));
    CLI::Option* const wait = show->add_option("--wait", text_, "seconds");
    show->add_flag("!--no-wait", flag_, "leave it")->excludes(wait);
    app_.add_subcommand("inner", "for scripts")->group("");
  }
  /// \return exit code; what was printed is in out_ and err_.
  int parse(const std::vector<std::string>& words) {
    std::vector<std::string> reversed(words.rbegin(), words.rend());
    out_.str("");
    err_.str("");
    try {
      app_.parse(reversed);
    } catch (const CLI::ParseError& error) {
      return explain(app_, error, out_, err_);
    }
    return 0;
  }

  CLI::App app_{"A tool.", "tool"};
  std::string text_;
  bool flag_ = true;
  std::ostringstream out_, err_;
};

TEST_F(Usage, IsWhatTheTreeOfTheCommandLineSays) {
  const CommandUsage usage = usage_of(app_);
  ASSERT_EQ(usage.commands.size(), 1U) << "what is of no group is hidden";
  const CommandUsage& show = usage.commands[0].commands[0];
  EXPECT_EQ(show.path, "/paths/show");
  ASSERT_EQ(show.arguments.size(), 1U);
  EXPECT_EQ(show.arguments[0].argument, "id");
  EXPECT_TRUE(show.arguments[0].is_required);
  EXPECT_EQ(show.arguments[0].value.kind, ValueKind::FromServer);
  const auto option = [&](const std::vector<OptionUsage>& options, const std::string& name) {
    return std::ranges::any_of(options, [&](const OptionUsage& candidate) {
      return std::ranges::find(candidate.names, name) != candidate.names.end();
    });
  };
  EXPECT_TRUE(option(show.options, "--no-wait"));
  EXPECT_TRUE(option(show.inherited, "--server"));
  EXPECT_FALSE(option(show.options, "--server"));
  EXPECT_FALSE(option(show.inherited, "--help")) << "it has its own";
}

TEST_F(Usage, AnOptionsTypeNameSaysWhatItsValueIs) {
  EXPECT_EQ(value_usage("TEXT:{gmm,kde}").kind, ValueKind::Words);
  EXPECT_EQ(value_usage("TEXT:{gmm,kde}").words, (std::vector<std::string>{"gmm", "kde"}));
  EXPECT_EQ(value_usage("TEXT:{gmm,kde}").name, "gmm|kde");
  EXPECT_EQ(value_usage("FILE").kind, ValueKind::File);
  EXPECT_EQ(value_usage("TEXT:DIR").kind, ValueKind::Folder);
  EXPECT_EQ(value_usage("ROBOT").kind, ValueKind::FromServer);
  EXPECT_EQ(value_usage("TEXT:PATH(existing)").kind, ValueKind::Anything);
  EXPECT_EQ(value_usage("UINT:0 to 230").name, "0 to 230");
}

TEST_F(Usage, HelpFitsEightyColumnsAndSaysNothingOfHowOptionsAreChecked) {
  EXPECT_EQ(parse({"paths", "show", "--help"}), 0);
  EXPECT_NE(out_.str().find("  -o table|json"), std::string::npos) << out_.str();
  EXPECT_EQ(out_.str().find("Excludes"), std::string::npos) << out_.str();
  EXPECT_EQ(out_.str().find("{false}"), std::string::npos) << out_.str();
  EXPECT_EQ(parse({"--help"}), 0);
  std::istringstream lines(out_.str());
  for (std::string line; std::getline(lines, line);)
    EXPECT_LE(line.size(), 80U) << line;
}

TEST_F(Usage, AMisspeltWordIsExplained) {
  EXPECT_EQ(parse({"pahts"}), 2);
  EXPECT_EQ(err_.str(),
            "tool: unknown command or argument 'pahts' (did you mean 'paths'?) (see: tool "
            "--help)\n");
  EXPECT_EQ(parse({"paths", "show", "7", "--wiat", "3"}), 2);
  EXPECT_EQ(err_.str(), "tool: unknown argument '--wiat' (did you mean '--wait'?)\n");
  EXPECT_EQ(parse({"paths", "show", "7", "8", "9"}), 2);
  EXPECT_EQ(err_.str(), "tool: unknown argument '8'\ntool: unknown argument '9'\n");
  EXPECT_EQ(parse({"innr"}), 2);
  EXPECT_EQ(err_.str().find("did you mean"), std::string::npos) << "a hidden one: " << err_.str();
}

TEST_F(Usage, ManualAndCompletionNeedNoFurtherWords) {
  EXPECT_EQ(parse({"--man-page"}), 0);
  EXPECT_TRUE(out_.str().starts_with(".\\\" Made from the command line of tool.\n.TH \"TOOL\" 1 "))
      << out_.str();
  EXPECT_NE(out_.str().find(".EX\n  tool paths show 7\n.EE"), std::string::npos) << out_.str();
  EXPECT_EQ(parse({"--completion", "bash"}), 0);
  EXPECT_NE(out_.str().find("complete -F _tool tool\n"), std::string::npos) << out_.str();
  EXPECT_EQ(parse({"--completion", "tcsh"}), 2);
}

}  // namespace
}  // namespace kinship::manual::usage_test
