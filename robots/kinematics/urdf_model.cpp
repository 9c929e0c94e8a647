#include "robots/kinematics/urdf_model.hpp"

#include <console_bridge/console.h>
#include <urdf_model/model.h>
#include <urdf_parser/urdf_parser.h>

#include <exception>
#include <string_view>
#include <utility>
#include <vector>

#include "proto/types/limits.hpp"
#include "proto/types/names.hpp"
#include "robots/kinematics/urdf_markup.hpp"

namespace kinship::kinematics {
namespace {

constexpr std::size_t kMaxComplaintBytes = 400;

// Where this thread collects urdfdom's messages; null: it does not.
thread_local std::string* collected_errors = nullptr;

/// Takes the messages of console_bridge, which is one per process, and sorts them by thread: to a
/// collector if the thread has one, else to the handler before it.
class MessagesByThread : public console_bridge::OutputHandler {
 public:
  MessagesByThread() : previous_(console_bridge::getOutputHandler()) {
    console_bridge::useOutputHandler(this);
  }
  ~MessagesByThread() override { console_bridge::useOutputHandler(previous_); }
  MessagesByThread(const MessagesByThread&) = delete;
  MessagesByThread& operator=(const MessagesByThread&) = delete;

  void log(const std::string& text, console_bridge::LogLevel level, const char* file,
           int line) override {
    if (collected_errors == nullptr) {
      if (previous_ != nullptr)
        previous_->log(text, level, file, line);
    } else if (level >= console_bridge::CONSOLE_BRIDGE_LOG_ERROR &&
               collected_errors->size() < kMaxComplaintBytes) {
      if (!collected_errors->empty())
        *collected_errors += "; ";
      *collected_errors += text.substr(0, kMaxComplaintBytes - collected_errors->size());
    }
  }

 private:
  console_bridge::OutputHandler* previous_;
};

class CollectErrors {
 public:
  explicit CollectErrors(std::string& errors) {
    static const MessagesByThread messages;
    collected_errors = &errors;
  }
  ~CollectErrors() { collected_errors = nullptr; }
  CollectErrors(const CollectErrors&) = delete;
  CollectErrors& operator=(const CollectErrors&) = delete;
};

Error invalid_urdf(const std::string& message) {
  return {ErrorCode::InvalidInput, cut_text("URDF: " + message, kMaxMessageBytes)};
}

template <typename Map>
std::optional<Error> check_names(std::string_view what, const Map& named) {
  for (const auto& [name, value] : named)
    if (const auto error = check_part_name(what, name))
      return invalid_urdf(error->message);
  return std::nullopt;
}

/// urdfdom lets a link have two parents and lets links go in circles apart from the root.
std::optional<Error> check_tree(const urdf::ModelInterface& model) {
  if (model.joints_.size() + 1 != model.links_.size())
    return invalid_urdf(std::to_string(model.joints_.size()) + " joints for " +
                        std::to_string(model.links_.size()) + " links do not form a tree");
  std::vector<urdf::LinkConstSharedPtr> reached = {model.getRoot()};
  for (std::size_t i = 0; i < reached.size() && reached.size() <= model.links_.size(); ++i) {
    const auto children = reached[i]->child_links;
    reached.insert(reached.end(), children.begin(), children.end());
  }
  if (reached.size() != model.links_.size())
    return invalid_urdf("links do not form a tree below '" + model.getRoot()->name + "'");
  return std::nullopt;
}

}  // namespace

Result<UrdfModel> parse_urdf(const std::string& text) {
  if (const auto error = check_markup(text))
    return *error;
  std::string errors;
  urdf::ModelInterfaceSharedPtr model;
  try {
    const CollectErrors collect(errors);
    model = urdf::parseURDF(normalize_attributes(text));
  } catch (const std::exception& exception) {
    errors += errors.empty() ? exception.what() : std::string("; ") + exception.what();
  }
  errors = on_one_line(std::move(errors));  // the parser cites names before they are checked
  if (model == nullptr || model->getRoot() == nullptr)
    return invalid_urdf(errors.empty() ? "not understood" : errors);
  if (const auto error = check_names("link", model->links_))
    return *error;
  if (const auto error = check_names("joint", model->joints_))
    return *error;
  if (const auto error = check_tree(*model))
    return *error;
  return UrdfModel{std::move(model), std::move(errors)};
}

}  // namespace kinship::kinematics
