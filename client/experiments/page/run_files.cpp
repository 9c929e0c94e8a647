#include "client/experiments/page/run_files.hpp"

#include <algorithm>
#include <array>
#include <set>
#include <sstream>
#include <string_view>

#include "proto/types/failure.hpp"

namespace kinship::experiments {
namespace {

namespace fs = std::filesystem;

constexpr std::string_view kProblems = ".problems.jsonl";
constexpr std::string_view kResults = ".results.jsonl";
constexpr std::string_view kUniform = "-uniform";
constexpr std::string_view kGuided = "-guided";
constexpr std::string_view kSearches = ".searches.jsonl";

/// Looks for the files of one folder.
class Folder {
 public:
  explicit Folder(fs::path folder) : folder_(std::move(folder)) {
    if (folder_.empty())
      return;
    if (!fs::is_directory(folder_))
      throw Failure(ErrorCode::NotFound, "--run '" + folder_.string() + "' is no folder");
    for (const auto& entry : fs::directory_iterator(folder_))
      names_.insert(entry.path().filename().string());
  }

  bool has(const std::string& name) const { return names_.contains(name); }

  /// A file that is there; else empty.
  fs::path find(const std::string& name) const { return has(name) ? folder_ / name : fs::path(); }

  /// Beginnings of names, each of which has all of the endings.
  std::vector<std::string> with_all(const std::vector<std::string>& endings) const {
    std::vector<std::string> beginnings;
    for (const std::string& name : names_) {
      if (!name.ends_with(endings.front()))
        continue;
      const std::string beginning = name.substr(0, name.size() - endings.front().size());
      if (!beginning.empty() && std::ranges::all_of(endings, [&](const std::string& ending) {
            return has(beginning + ending);
          }))
        beginnings.push_back(beginning);
    }
    return beginnings;
  }

 private:
  fs::path folder_;
  std::set<std::string> names_;
};

std::string named_file(std::string_view a, std::string_view b) {
  return std::string(a) + std::string(b);
}

std::string robot_of(const RunLocation& options, const Folder& folder) {
  if (!options.robot.empty() || options.folder.empty())
    return options.robot;
  const auto robots =
      folder.with_all({named_file(kUniform, kResults), named_file(kGuided, kResults)});
  if (robots.size() > 1) {
    std::string names;
    for (const std::string& robot : robots)
      names += (names.empty() ? "" : ", ") + robot;
    throw Failure(ErrorCode::InvalidInput, "--run '" + options.folder.string() +
                                               "' has runs of several robots: say --robot (" +
                                               names + ")");
  }
  return robots.empty() ? "" : robots.front();
}

void fill_in(fs::path& file, const fs::path& found) {
  if (file.empty())
    file = found;
}

std::vector<TeacherFiles> find_teachers(const RunLocation& options, const Folder& folder,
                                        const std::string& robot) {
  std::vector<TeacherFiles> teachers = options.files.teachers;
  const bool is_asked = !options.teachers.empty();
  const auto names = is_asked ? options.teachers
                              : folder.with_all({std::string(kProblems), std::string(kResults)});
  for (const std::string& name : names) {
    if (!is_asked && (name == robot || options.models.empty()))
      continue;
    TeacherFiles teacher;
    teacher.robot.source = options.models / name;
    teacher.problems = options.folder / named_file(name, kProblems);
    teacher.results = options.folder / named_file(name, kResults);
    teachers.push_back(teacher);
  }
  return teachers;
}

/// Of one guide alone, in the order in which a page tells them.
std::vector<AlsoFile> find_alone(const Folder& folder, const std::string& robot) {
  std::vector<AlsoFile> alone;
  for (const char* const guide : {"mixture", "ways", "retreat"}) {
    const fs::path file = folder.find(robot + "-" + guide + std::string(kResults));
    if (!file.empty())
      alone.push_back({std::string(guide) + " alone", file});
  }
  return alone;
}

/// A file without which there is no page.
struct Needed {
  const fs::path& file;
  std::string_view what, option, name;
};

void require(const RunFiles& files, const fs::path& folder) {
  const std::array needed = {
      Needed{files.robot.source, "the robot's model", "--model", "(--models)/ROBOT"},
      Needed{files.problems, "its problems", "--problems", "ROBOT.problems.jsonl"},
      Needed{files.uniform, "results of uniform sampling", "--uniform",
             "ROBOT-uniform.results.jsonl"},
      Needed{files.guided, "results of guided sampling", "--guided", "ROBOT-guided.results.jsonl"},
      Needed{files.distribution, "the distribution", "--distribution", "distribution.json"}};
  std::ostringstream missing;
  for (const Needed& each : needed) {
    if (each.file.empty())
      missing << "\n  " << each.what << ": name it with " << each.option
              << (folder.empty()
                      ? ""
                      : ", or call it " + std::string(each.name) + " in '" + folder.string() + "'");
    else if (!fs::exists(each.file))
      missing << "\n  " << each.what << ": there is no '" << each.file.string() << "'";
  }
  for (const TeacherFiles& teacher : files.teachers)
    for (const fs::path& file : {teacher.robot.source, teacher.problems, teacher.results})
      if (!fs::exists(file))
        missing << "\n  of a teacher: there is no '" << file.string() << "'";
  for (const fs::path& file : {files.advice, files.uniform_searches, files.guided_searches})
    if (!file.empty() && !fs::exists(file))
      missing << "\n  there is no '" << file.string() << "'";
  for (const AlsoFile& also : files.also)
    if (!fs::exists(also.results))
      missing << "\n  of '" << also.name << "': there is no '" << also.results.string() << "'";
  if (!missing.str().empty())
    throw Failure(ErrorCode::NotFound, "this run lacks what a page tells of:" + missing.str());
}

}  // namespace

RunFiles find_run(const RunLocation& options) {
  const Folder folder(options.folder);
  const std::string robot = robot_of(options, folder);
  RunFiles files = options.files;
  if (!robot.empty()) {
    fill_in(files.problems, folder.find(named_file(robot, kProblems)));
    fill_in(files.uniform, folder.find(robot + named_file(kUniform, kResults)));
    fill_in(files.guided, folder.find(robot + named_file(kGuided, kResults)));
    fill_in(files.uniform_searches, folder.find(robot + named_file(kUniform, kSearches)));
    fill_in(files.guided_searches, folder.find(robot + named_file(kGuided, kSearches)));
    if (files.also.empty())
      files.also = find_alone(folder, robot);
    if (!options.models.empty())
      fill_in(files.robot.source, options.models / robot);
  }
  fill_in(files.distribution, folder.find("distribution.json"));
  fill_in(files.advice, folder.find("advice.json"));
  files.teachers = find_teachers(options, folder, robot);
  require(files, options.folder);
  return files;
}

TeacherFiles parse_teacher(const std::string& text) {
  std::istringstream stream(text);
  std::vector<std::string> parts;
  for (std::string part; std::getline(stream, part, ',');)
    parts.push_back(part);
  if (parts.size() != 3 || std::ranges::count(parts, std::string()) > 0)
    throw Failure(ErrorCode::InvalidInput,
                  "--teacher '" + text + "' is not MODEL,PROBLEMS,RESULTS");
  TeacherFiles teacher;
  teacher.robot.source = parts[0];
  teacher.problems = parts[1];
  teacher.results = parts[2];
  return teacher;
}

AlsoFile parse_also(const std::string& text) {
  const std::size_t equals = text.find('=');
  if (equals == std::string::npos || equals == 0 || equals + 1 == text.size())
    throw Failure(ErrorCode::InvalidInput, "--also '" + text + "' is not NAME=FILE");
  return {text.substr(0, equals), text.substr(equals + 1)};
}

}  // namespace kinship::experiments
