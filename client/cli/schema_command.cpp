#include <algorithm>
#include <filesystem>
#include <fstream>
#include <ostream>
#include <vector>

#include "client/cli/session.hpp"
#include "proto/files/installed_place.hpp"
#include "proto/types/exit_code.hpp"

namespace kinship::cli {
namespace {

constexpr std::string_view kSchemaEnding = ".schema.json";

/// "problem-1" of "problem", "problem/1", "kinship.problem/1" and "problem-1".
std::string schema_name(std::string format) {
  constexpr std::string_view kPrefix = "kinship.";
  if (format.starts_with(kPrefix))
    format.erase(0, kPrefix.size());
  std::ranges::replace(format, '/', '-');
  const bool has_version =
      !format.empty() && format.find_last_not_of("0123456789") != format.size() - 1;
  return has_version ? format : format + "-1";
}

int list_schemas(const std::filesystem::path& folder, std::ostream& out) {
  std::vector<std::string> formats;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::string format = entry.path().filename().string();
    format.erase(format.size() - std::min(format.size(), kSchemaEnding.size()));
    if (const std::size_t dash = format.rfind('-'); dash != std::string::npos)
      format[dash] = '/';
    formats.push_back("kinship." + format);
  }
  std::ranges::sort(formats);
  for (const std::string& format : formats)
    out << format << '\n';
  return kDone;
}

int print_schema(const std::string& format, std::ostream& out, std::ostream& err) {
  const std::filesystem::path folder = files::installed_place("schemas", KINSHIP_SCHEMAS_DIR);
  if (format.empty())
    return list_schemas(folder, out);
  const std::string name = schema_name(format);
  std::ifstream file(folder / (name + std::string(kSchemaEnding)));
  if (!file) {
    err << "schema: no format '" << format << "' (see: kinship schema)\n";
    return kNotFound;
  }
  out << file.rdbuf();
  return kDone;
}

}  // namespace

void add_schema(CLI::App& app, Session& session) {
  CLI::App* command = add_command(
      app, "schema", "The JSON Schema of a document; without a name, the formats there are",
      "kinship schema\n  kinship schema problem > problem.schema.json");
  const auto format = std::make_shared<std::string>();
  command->add_option("format", *format, "Its format, e.g. problem or kinship.problem/1")
      ->type_name("FORMAT");
  on_run(*command, session,
         [&session, format] { return print_schema(*format, session.out, session.err); });
}

}  // namespace kinship::cli
