#include "client/cli/exchange_commands.hpp"

#include <cstdint>
#include <map>
#include <optional>
#include <ostream>
#include <string>
#include <utility>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/terminal.hpp"
#include "client/link/admin_rows.hpp"
#include "client/link/robot_names.hpp"
#include "proto/files/lines.hpp"
#include "proto/files/output_file.hpp"
#include "proto/json/experience_line.hpp"
#include "proto/types/limits.hpp"

namespace kinship::cli {
namespace {

/// Where rows go.
struct RowsTarget {
  const std::filesystem::path& file;  ///< empty: a stream
  files::OutputFile& output;          ///< to it
  bool progress;                      ///< is told
};

/// Writes rows as lines; the file has its name only if all came.
int write_rows(link::Client& server, const AdminRequest& request, const RowsTarget& target,
               std::string_view command, std::ostream& err) {
  constexpr std::size_t kLinesAtOnce = 100;
  StatusLine progress(err, target.progress);
  std::size_t lines = 0;
  const auto error = link::for_each_row(server, request, [&](const std::string& row) {
    target.output.stream() << row << '\n';
    if (++lines % kLinesAtOnce == 0)
      progress.show(std::string(command) + ": " + count_text(lines, "line"));
    return target.output.stream().good();
  });
  progress.clear();
  if (error)
    return refuse(command, *error, err);
  target.output.keep();
  if (!target.file.empty())
    err << count_text(lines, "line") << " in '" << target.file.string() << "'\n";
  return kDone;
}

constexpr const char* kImport = "paths import";
constexpr std::size_t kHeldBytes = 8 * kMaxBatchBytes;  // before they are handed over

struct Counts {
  std::uint64_t robots = 0, stored = 0, known = 0, recorded = 0, refused = 0;
};

/// An import under way.
class Import {
 public:
  Import(link::Client& server, const ImportOptions& options, std::ostream& err)
      : server_(server), err_(err), progress_(err, options.progress) {}

  const Counts& counts() const noexcept { return counts_; }
  const std::optional<Error>& end() const noexcept { return end_; }  ///< why it cannot go on

  /// \return false if it cannot go on.
  bool take(const files::Line& line) {
    if (!line.text) {
      refuse_line(line.number, line.text.error().message);
      return true;
    }
    Result<json::ExperienceLine> parsed = json::experience_line_from_json(*line.text);
    if (!parsed)
      refuse_line(line.number, parsed.error().message);
    else if (const auto* robot = std::get_if<RobotDescription>(&*parsed))
      register_robot(line.number, *robot);
    else
      hold(line.number, std::get<json::NamedAttempt>(std::move(parsed).value()));
    return !end_;
  }

  /// Hands over the held attempts.
  void deliver() {
    if (attempts_.empty() || end_)
      return;
    const Result<std::vector<Receipt>> receipts = server_.deliver(std::exchange(attempts_, {}));
    const std::vector<std::size_t> numbers = std::exchange(numbers_, {});
    bytes_ = 0;
    if (!receipts) {
      end_ = Error{receipts.error().code,
                   receipts.error().message + "; lines from " + std::to_string(numbers.front()) +
                       " on may be missing: import the file again, what is there is known"};
      return;
    }
    for (std::size_t i = 0; i < receipts->size(); ++i)
      count((*receipts)[i], numbers[i]);
    show_progress(numbers.back());
  }

  void clear_progress() { progress_.clear(); }

 private:
  void refuse_line(std::size_t number, const std::string& why) {
    clear_progress();
    err_ << kImport << ": line " << number << ": " << why << '\n';
    ++counts_.refused;
  }

  void register_robot(std::size_t number, const RobotDescription& description) {
    const Result<RegisterReply> reply = server_.register_robot(description);
    if (!reply && reply.error().code == ErrorCode::Unavailable) {
      end_ = reply.error();
      return;
    }
    if (!reply || reply->status == RegisterStatus::Refused) {
      refuse_line(number, "robot '" + description.label +
                              "': " + (reply ? reply->message : reply.error().message));
      return;
    }
    ++counts_.robots;
    labels_.insert_or_assign(description.label, reply->robot);
    if (!reply->message.empty()) {
      clear_progress();
      err_ << kImport << ": line " << number << ": " << reply->message << '\n';
    }
  }

  void hold(std::size_t number, json::NamedAttempt named) {
    if (!named.label.empty()) {
      const Result<Digest> robot = find_robot(named.label);
      if (!robot && robot.error().code == ErrorCode::Unavailable) {
        end_ = robot.error();
        return;
      }
      if (!robot) {
        refuse_line(number, robot.error().message);
        return;
      }
      named.attempt.robot = *robot;
    }
    const BatchBytes size = batch_bytes(named.attempt);
    bytes_ += size.waypoints + size.scenes + size.searches;
    attempts_.push_back(std::move(named.attempt));
    numbers_.push_back(number);
    if (attempts_.size() == kMaxAttemptsPerBatch || bytes_ > kHeldBytes)
      deliver();
  }

  /// By its name in the file, or at the server.
  Result<Digest> find_robot(const std::string& label) {
    if (const auto known = labels_.find(label); known != labels_.end())
      return known->second;
    const auto robots = link::resolve_robots(server_, {label});
    if (!robots)
      return robots.error();
    labels_.emplace(label, robots->front());
    return robots->front();
  }

  void count(const Receipt& receipt, std::size_t number) {
    switch (receipt.status) {
      case ReceiptStatus::Stored:
        ++counts_.stored;
        break;
      case ReceiptStatus::Duplicate:
        ++counts_.known;
        break;
      case ReceiptStatus::Recorded:
        ++counts_.recorded;
        break;
      case ReceiptStatus::TryAgain:
        refuse_line(number, "not stored: " + receipt.message + "; import it again later");
        break;
      default:
        refuse_line(number, receipt.message);
    }
  }

  void show_progress(std::size_t number) { progress_.show("line " + std::to_string(number)); }

  link::Client& server_;
  std::ostream& err_;
  StatusLine progress_;
  Counts counts_;
  std::optional<Error> end_;
  std::map<std::string, Digest> labels_;
  std::vector<Attempt> attempts_;     // held until there are enough
  std::vector<std::size_t> numbers_;  // of their lines
  std::size_t bytes_ = 0;             // of their waypoints and scenes
};

void print(const Counts& counts, bool json, std::ostream& out) {
  if (json)
    out << R"({"robots":)" << counts.robots << R"(,"stored":)" << counts.stored << R"(,"known":)"
        << counts.known << R"(,"recorded":)" << counts.recorded << R"(,"refused":)"
        << counts.refused << "}\n";
  else
    out << count_text(counts.stored, "path") << " stored, "
        << count_text(counts.recorded, "unsolved attempt") << " recorded, " << counts.known
        << " known already, " << count_text(counts.refused, "line") << " refused; "
        << count_text(counts.robots, "robot") << '\n';
}

}  // namespace

int export_configurations(link::Client& server, const ConfigurationsOptions& options,
                          std::ostream& out, std::ostream& err) {
  constexpr const char* kCommand = "configurations export";
  files::OutputFile output(options.output, out);  // refuses before the server has worked for it
  int code = kDone;
  AdminRequest begin;
  begin.verb = AdminVerb::ExportConfigurations;
  begin.argument = id_of_query(server, options.query, kCommand, false, err, code);
  if (code != kDone)
    return code;
  return run_job(server, begin, options.waiting, kCommand, err, [&](const Job& job) {
    AdminRequest rows;
    rows.verb = AdminVerb::JobRows;
    rows.argument = job.id;
    const bool progress = options.waiting.progress && !(options.output.empty() && is_terminal(out));
    return write_rows(server, rows, {options.output, output, progress}, kCommand, err);
  });
}

int import_paths(link::Client& server, const ImportOptions& options, std::istream& standard_input,
                 std::ostream& out, std::ostream& err) {
  std::ifstream file;
  const bool is_standard_input = options.file == "-";
  if (!is_standard_input)
    file = files::open_input(options.file);
  Import import(server, options, err);
  files::for_each_line(is_standard_input ? standard_input : file,
                       is_standard_input ? "standard input" : options.file.string(),
                       [&](const files::Line& line) { return import.take(line); });
  import.deliver();
  import.clear_progress();
  print(import.counts(), options.json, out);
  if (import.end())
    return refuse(kImport, *import.end(), err);
  return import.counts().refused > 0 ? kFailed : kDone;
}

}  // namespace kinship::cli
