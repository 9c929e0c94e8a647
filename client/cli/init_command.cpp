#include "client/cli/init_command.hpp"

#include <algorithm>
#include <functional>
#include <istream>
#include <optional>
#include <ostream>
#include <set>
#include <sstream>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "client/cli/cell_text.hpp"
#include "client/cli/offline_robot.hpp"
#include "client/cli/terminal.hpp"
#include "proto/files/output_file.hpp"
#include "proto/tables/table.hpp"
#include "proto/types/names.hpp"
#include "robots/geometry/geometry_doubts.hpp"
#include "robots/models/loaded_robot.hpp"
#include "robots/models/mesh_files.hpp"
#include "robots/models/ros_packages.hpp"
#include "robots/models/suggested_ends.hpp"
#include "robots/models/text_file.hpp"

namespace kinship::cli {
namespace {

namespace fs = std::filesystem;

constexpr const char* kInit = "robots init";
constexpr const char* kGiven = "given";
constexpr const char* kAnswered = "answered";

/// A field of the file and its origin.
struct Choice {
  std::string field, value, why;
};

/// Asks a person, if there is one.
class Dialogue {
 public:
  Dialogue(std::istream* answers, std::ostream& err) : answers_(answers), err_(err) {}

  bool asks() const { return answers_ != nullptr; }

  /// The answer to a question; again until `fault` finds none, which is empty then.
  /// \return the proposal for an empty answer, at the end of the answers and if nobody is asked.
  std::string ask(const std::string& question, const std::string& proposal,
                  const std::function<std::string(const std::string&)>& fault) {
    std::string answer;
    while (answers_ != nullptr) {
      err_ << question << " [" << proposal << "]: " << std::flush;
      if (!std::getline(*answers_, answer)) {
        answers_ = nullptr;
        err_ << '\n';
        break;
      }
      if (answer.empty())
        break;
      const std::string wrong = fault(answer);
      if (wrong.empty())
        return answer;
      err_ << "  " << wrong << '\n';
    }
    return proposal;
  }

 private:
  std::istream* answers_;
  std::ostream& err_;
};

template <typename T>
std::string fault_of(const Result<T>& result) {
  return result ? std::string() : result.error().message;
}

/// Why arguments make no robot.
std::string robot_fault(const models::RobotArguments& arguments) {
  auto described = models::describe_robot(arguments);
  return described ? fault_of(models::read_model(*std::move(described))) : fault_of(described);
}

/// NAME of each package://NAME/ in a URDF.
std::set<std::string> named_packages(const std::string& urdf) {
  constexpr std::string_view kPackage = "package://";
  std::set<std::string> names;
  for (std::size_t at = urdf.find(kPackage); at != std::string::npos;
       at = urdf.find(kPackage, at + 1)) {
    const std::size_t begin = at + kPackage.size(), end = urdf.find_first_of("/\"'", begin);
    if (end != std::string::npos && urdf[end] == '/' && end > begin)
      names.insert(urdf.substr(begin, end - begin));
  }
  return names;
}

/// SRDF files beside a URDF, and where packages have them.
std::vector<fs::path> find_srdfs(const fs::path& urdf_folder) {
  std::vector<fs::path> found;
  for (const char* place : {".", "../srdf", "../config"}) {
    std::error_code unreadable;
    for (fs::directory_iterator entry(urdf_folder / place, unreadable), end;
         !unreadable && entry != end; entry.increment(unreadable))
      if (entry->path().extension() == ".srdf")
        found.push_back(entry->path().lexically_normal());
  }
  std::ranges::sort(found);
  return found;
}

/// A file or folder as it is written into a file of `folder`: relative to it, unless they have
/// nothing but the root in common.
fs::path relative_to(const fs::path& folder, const fs::path& file) {
  const fs::path from = fs::weakly_canonical(fs::absolute(folder));
  const fs::path to = fs::weakly_canonical(fs::absolute(file));
  const auto second = [](const fs::path& path) {
    return path.begin() == path.end() ? fs::path() : *std::next(path.begin());
  };
  return second(from) == second(to) ? to.lexically_relative(from) : to;
}

/// Chooses what the options do not say.
class Chooser {
 public:
  Chooser(models::RobotArguments arguments, Dialogue& dialogue)
      : arguments_(std::move(arguments)), dialogue_(dialogue) {}

  /// \throws Failure with the fault.
  void choose(const fs::path& folder) {
    choose_ends();
    choose_label(folder);
    choose_packages();
    choose_srdf();
    choose_transfer();
  }

  const models::RobotArguments& arguments() const { return arguments_; }
  const std::vector<Choice>& choices() const { return choices_; }

 private:
  void choose_ends() {
    const bool has_base = !arguments_.base_link.empty(), has_tip = !arguments_.tip_link.empty();
    models::RobotArguments likely = arguments_;
    models::LinksOfFile links = models::complete_ends(likely).value_or_throw();
    const std::string base =
        choose_end("base link", "--base", has_base, likely.base_link, [&](const std::string& name) {
          models::RobotArguments other = arguments_;
          other.base_link = name;
          return fault_of(models::complete_ends(other));
        });
    arguments_.base_link = base;
    likely = arguments_;
    links = models::complete_ends(likely).value_or_throw();
    const std::string tip =
        choose_end("tip link", "--tip", has_tip, likely.tip_link, [&](const std::string& name) {
          models::RobotArguments other = arguments_;
          other.tip_link = name;
          return robot_fault(other);
        });
    arguments_.tip_link = tip;
    std::string possible;
    for (const kinematics::ChainEnds& ends : links.ends)
      possible +=
          (possible.empty() ? "" : "; or ") + listed(ends.bases) + " to " + listed(ends.tips);
    if (!has_base || !has_tip)
      choices_.push_back({"", "", "possible: " + possible});
  }

  std::string choose_end(const std::string& what, const std::string& option, bool is_given,
                         const std::string& likely,
                         const std::function<std::string(const std::string&)>& fault) {
    const std::string name = is_given ? likely : dialogue_.ask(what, likely, fault);
    add(option.substr(2), name,
        is_given         ? kGiven
        : name == likely ? "the likeliest (" + option + " names another)"
                         : kAnswered);
    return name;
  }

  /// The URDF's name; that of the folder if the URDF has the name that all have.
  void choose_label(const fs::path& folder) {
    std::string why = kGiven;
    if (arguments_.label.empty()) {
      const std::string of_file = models::label_of(arguments_.source);
      const std::string of_folder = fs::weakly_canonical(fs::absolute(folder)).filename().string();
      const bool takes_folder =
          (of_file == "robot" || check_label(of_file)) && !check_label(of_folder);
      arguments_.label = takes_folder ? of_folder : check_label(of_file) ? "robot" : of_file;
      why = takes_folder ? "the folder's name" : "the URDF's name";
      const std::string label = dialogue_.ask("label", arguments_.label, [](const auto& name) {
        const auto error = check_label(name);
        return error ? error->message : std::string();
      });
      if (label != arguments_.label)
        why = kAnswered;
      arguments_.label = label;
    }
    add("label", arguments_.label, why);
  }

  void choose_packages() {
    models::PackageFolders known = models::parse_packages(arguments_.packages).value_or_throw();
    for (const auto& [name, folder] : known)
      add("packages", name + " = " + folder.string(), kGiven);
    const std::string urdf = models::describe_robot(arguments_).value_or_throw().description.urdf;
    const fs::path beside = arguments_.source.parent_path();
    for (const std::string& name : named_packages(urdf)) {
      if (known.contains(name))
        continue;
      models::PackageSearch search = models::find_ros_package(name, beside);
      if (search.folder) {
        add_package(name, *search.folder, "found as ROS finds it");
        continue;
      }
      const std::string folder =
          arguments_.mesh_folders.empty()
              ? dialogue_.ask("folder of package '" + name + "', which is not found", "none",
                              [&](const std::string& text) {
                                return fault_of(models::parse_packages({name + "=" + text}));
                              })
              : "none";
      if (folder != "none")
        add_package(name, folder, kAnswered);
      else
        add("packages", name + " = ?",
            arguments_.mesh_folders.empty()
                ? "not found: give --package " + name + "=DIR. Searched: " + search.places
                : "its meshes are looked for in the mesh folders");
    }
  }

  void add_package(const std::string& name, const fs::path& folder, const std::string& why) {
    arguments_.packages.push_back(name + "=" + folder.string());
    add("packages", name + " = " + folder.string(), why);
  }

  std::string srdf_fault(const std::string& file) const {
    models::RobotArguments other = arguments_;
    other.srdf = file;
    return fault_of(models::describe_robot(other));
  }

  void choose_srdf() {
    if (!arguments_.srdf.empty()) {
      add("srdf", arguments_.srdf.string(), kGiven);
      return;
    }
    std::vector<std::string> fit;
    for (const fs::path& file : find_srdfs(arguments_.source.parent_path()))
      if (srdf_fault(file.string()).empty())
        fit.push_back(file.string());
    const std::string proposal = fit.size() == 1 ? fit.front() : "none";
    std::string srdf = proposal;
    if (!fit.empty())
      srdf = dialogue_.ask("SRDF beside the URDF (" + listed(fit) + "), or none", proposal,
                           [&](const std::string& file) {
                             return file == "none" ? std::string() : srdf_fault(file);
                           });
    if (srdf == "none") {
      add("srdf", "-",
          fit.empty() ? "none found beside the URDF; 'kinship robots suggest-srdf' makes one"
                      : "several beside the URDF, --srdf names one: " + listed(fit));
      return;
    }
    arguments_.srdf = srdf;
    add("srdf", srdf, srdf == proposal ? "found beside the URDF" : kAnswered);
  }

  void choose_transfer() {
    constexpr const char* kTip = "0 0 0 0 0 0 1";
    if (!arguments_.transfer.empty()) {
      add("transfer", arguments_.transfer, kGiven);
      return;
    }
    const std::string transfer = dialogue_.ask(
        "transfer frame (TCP) in '" + arguments_.tip_link + "', x y z (m) qx qy qz qw", kTip,
        [&](const std::string& text) {
          models::RobotArguments other = arguments_;
          other.transfer = text;
          return robot_fault(other);
        });
    arguments_.transfer = transfer;
    add("transfer", transfer,
        transfer == kTip ? "the tip link itself; --transfer says where a tool is in it"
                         : kAnswered);
  }

  void add(const std::string& field, const std::string& value, const std::string& why) {
    choices_.push_back({field, value, why});
  }

  models::RobotArguments arguments_;
  Dialogue& dialogue_;
  std::vector<Choice> choices_;
};

/// What is written: files are relative to the folder.
models::ChainFile chain_file_of(const models::RobotArguments& arguments,
                                const RobotDescription& description, const fs::path& folder) {
  models::ChainFile chain;
  chain.label = description.label;
  chain.base_link = description.base_link;
  chain.tip_link = description.tip_link;
  chain.T_tip_transfer = description.T_tip_transfer;
  chain.task_axes = description.task_axes;
  chain.held = description.held_joints;
  chain.urdf = relative_to(folder, arguments.source);
  if (!arguments.srdf.empty())
    chain.srdf = relative_to(folder, arguments.srdf);
  for (const auto& [name, package] : models::parse_packages(arguments.packages).value_or_throw())
    chain.packages.emplace(name, relative_to(folder, package));
  for (const fs::path& meshes : arguments.mesh_folders)
    chain.mesh_folders.push_back(relative_to(folder, meshes));
  chain.xacro = arguments.xacro;
  chain.collision_from_visual = arguments.collision_from_visual;
  chain.without_collision = arguments.without_collision;
  chain.limit_slack = arguments.limit_slack;
  return chain;
}

/// Warns of what hinders planning. \throws Failure for a robot that cannot be meant.
void look_at(const models::RobotArguments& arguments, const kinematics::RobotModel& robot,
             std::ostream& err) {
  const auto geometry = read_geometry(kInit, arguments, robot, err);
  if (!geometry)
    return;
  if (const auto error = geometry::find_impossible_solids(robot.chain, *geometry))
    throw Failure(*error);
  for (const std::string& doubt : geometry::find_doubts(robot.chain, *geometry))
    err << kInit << ": warning: " << doubt << '\n';
}

void print_choices(const std::vector<Choice>& choices, std::ostream& out) {
  tables::Table table({"FIELD", "VALUE", "WHY"});
  for (const Choice& choice : choices)
    if (choice.field.empty())
      table.add_row({"", "", choice.why});
    else
      table.add_row({choice.field, choice.value, choice.why});
  table.print(out);
}

/// \throws Failure with the fault.
void write_text(const std::string& text, const fs::path& file) {
  std::error_code error;
  fs::create_directories(file.parent_path(), error);
  if (error)
    throw Failure(ErrorCode::Storage,
                  "'" + file.parent_path().string() + "' cannot be made: " + error.message());
  std::ostringstream unused;
  files::OutputFile output(file, unused);
  output.stream() << text;
  output.keep();
}

/// Leaves the file as it was if it does not say the robot that is meant.
/// \throws Failure with the fault.
void write_chain_file(const models::ChainFile& chain, const kinematics::RobotModel& robot,
                      const fs::path& file) {
  constexpr std::size_t kMaxBytes = 1'000'000;
  std::error_code error;
  std::optional<std::string> before;
  if (fs::exists(file, error))
    before = models::read_text(file, kMaxBytes);
  write_text(models::chain_file_text(chain), file);
  try {
    auto read = models::describe_robot({.source = file.parent_path()}).value_or_throw();
    const auto again = models::read_model(std::move(read)).value_or_throw();
    if (again.chain.digest() != robot.chain.digest())
      throw Failure(ErrorCode::Internal, "'" + file.string() + "' says robot " +
                                             again.chain.digest().short_hex() + ", meant is " +
                                             robot.chain.digest().short_hex());
  } catch (const Failure&) {
    if (before)
      write_text(*before, file);
    else
      fs::remove(file, error);
    throw;
  }
}

}  // namespace

int init_robot(const InitOptions& options, std::istream* answers, std::ostream& out,
               std::ostream& err) {
  try {
    const fs::path& urdf = options.robot.source;
    if (models::is_model_folder(urdf))
      return refuse(kInit, invalid_input("'" + urdf.string() + "' is a folder: name its URDF file"),
                    err);
    fs::path folder = options.folder.empty() ? urdf.parent_path() : options.folder;
    folder = folder.empty() ? "." : folder;
    const fs::path file = folder / models::kChainFile;
    std::error_code unreadable;
    if (!options.force && fs::exists(file, unreadable))
      return refuse(kInit,
                    invalid_input("'" + file.string() +
                                  "' is there already; --force replaces it, -o DIR writes another"),
                    err);
    Dialogue dialogue(answers, err);
    Chooser chooser(options.robot, dialogue);
    chooser.choose(folder);
    auto described = models::describe_robot(chooser.arguments()).value_or_throw();
    print_warnings(kInit, described.warnings, err);
    const auto robot = models::read_model(std::move(described)).value_or_throw();
    look_at(chooser.arguments(), robot, err);
    write_chain_file(chain_file_of(chooser.arguments(), robot.description, folder), robot, file);
    out << "wrote '" << file.string() << "' of robot " << robot.chain.digest().short_hex() << ": '"
        << folder.string() << "' is all that commands need now ('kinship robots check "
        << folder.string() << "')\n\n";
    print_choices(chooser.choices(), out);
    return kDone;
  } catch (const Failure& failure) {
    return refuse(kInit, failure.error(), err);
  }
}

}  // namespace kinship::cli
