#include "server/access/withheld_sources.hpp"

#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include "server/access/access.hpp"

namespace kinship::access {
namespace {

/// Of one answer.
class Withholding {
 public:
  /// \param own  a robot that is the caller's, whatever it is called now.
  Withholding(const Caller& caller, const Digest& own) : caller_(caller), own_{own} {}

  void apply(Distribution& distribution) {
    for (Source& source : distribution.sources) {
      if (own_.contains(source.robot) || may_see(caller_, "", source.label)) {
        own_.insert(source.robot);
        continue;
      }
      others_.push_back("'" + source.label + "'");  // as server/fitting quotes it
      source.robot = {};
      source.label = kOtherRobot;
    }
    apply(distribution.reason);
    apply(distribution.filters);
  }

  void apply(std::string& text) const {
    if (std::ranges::any_of(others_, [&](const std::string& other) {
          return text.find(other) != std::string::npos;
        }))
      text = "not told: it names robots that the certificate is not for";
  }

  void apply(TaskExperience& experience) const {
    for (PosePath& path : experience.paths)
      if (!own_.contains(path.source))
        path.source = {};
  }

  /// What the server planned for the robot was recorded by others.
  static void apply(RecallLibrary& library) {
    for (RecallQuery& query : library.queries)
      if (query.is_synthetic)
        query.report = {};
  }

 private:
  const Caller& caller_;
  std::set<Digest> own_;
  std::vector<std::string> others_;
};

}  // namespace

bool withholds_sources(const Caller& caller) noexcept { return !caller.robots.empty(); }

void withhold_sources(const Caller& caller, Distribution& distribution) {
  if (withholds_sources(caller))
    Withholding(caller, distribution.robot).apply(distribution);
}

void withhold_sources(const Caller& caller, const Digest& fetched_for, FetchReply& reply) {
  if (!withholds_sources(caller))
    return;
  Withholding withholding(caller, fetched_for);
  if (reply.distribution)
    withholding.apply(*reply.distribution);
  withholding.apply(reply.message);
  if (reply.rehearsal)
    withholding.apply(reply.rehearsal->message);
  if (reply.experience)
    withholding.apply(*reply.experience);
  if (reply.recall)
    Withholding::apply(*reply.recall);
}

}  // namespace kinship::access
