#pragma once

#include <cstdint>
#include <string>
#include <string_view>

/// What a document is, as its first member says: `"format": "kinship.problem/1"`.
namespace kinship::json {

/// The name of a kind of document, and the version of its members. A member that readers may
/// ignore leaves the version; a member that is gone, or means something else, raises it.
struct Format {
  std::string_view name;  ///< e.g. "problem"; spaces count as dashes
  std::uint32_t version = 1;
  std::string_view ending = {};  ///< of the name: "-list" of a listing
};

// The documents that programs read or write; those of single rows and listings follow from
// kAdminRows (admin_rows_json.hpp). Each has a schema in proto/json/schemas.
inline constexpr Format kAttemptFormat{"attempt"};
inline constexpr Format kBackupDownloadFormat{"backup-download"};
inline constexpr Format kCredentialListFormat{"credential-list"};
inline constexpr Format kDistributionFormat{"distribution"};
inline constexpr Format kEventFormat{"event"};
inline constexpr Format kExperienceRobotFormat{"experience-robot"};
inline constexpr Format kForwardKinematicsFormat{"forward-kinematics"};
inline constexpr Format kInverseKinematicsFormat{"inverse-kinematics"};
inline constexpr Format kOutboxListFormat{"outbox-list"};
inline constexpr Format kPathImportFormat{"path-import"};
inline constexpr Format kProblemFormat{"problem"};
inline constexpr Format kResultFormat{"result"};
inline constexpr Format kRobotCheckFormat{"robot-check"};
inline constexpr Format kRobotComparisonFormat{"robot-comparison"};
inline constexpr Format kRobotDescriptionFormat{"robot-description"};
inline constexpr Format kRobotDetailsFormat{"robot-details"};
inline constexpr Format kRobotFramesFormat{"robot-frames"};
inline constexpr Format kRobotLinksFormat{"robot-links"};
inline constexpr Format kRobotRegistrationFormat{"robot-registration"};
inline constexpr Format kSearchFormat{"search"};
inline constexpr Format kSrdfSuggestionFormat{"srdf-suggestion"};
inline constexpr Format kStoreCheckFormat{"store-check"};
inline constexpr Format kTaskExperienceFormat{"task-experience"};

std::string to_text(const Format& format);  ///< e.g. "kinship.problem/1"

/// \param document  the text of an object; one that begins with its format, and what is no object,
///                  stays as it is.
/// \return the object with its format as the first member.
std::string in_format(const Format& format, std::string_view document);

}  // namespace kinship::json
