#pragma once

#include "proto/json/attempt_json.hpp"
#include "proto/json/reader.hpp"
#include "proto/json/writer.hpp"
#include "proto/types/distribution.hpp"
#include "proto/types/robot_description.hpp"

/// Documents that are also parts of other documents; for this library's sources only. Reading
/// throws the exceptions of Reader.
namespace kinship::json {

NamedAttempt read_attempt(const Reader& reader);

OrderedJson robot_description_object(const RobotDescription& description);
RobotDescription read_robot_description(const Reader& reader);

enum class MixturePart { Required, MayBeMissing };

OrderedJson distribution_object(const Distribution& distribution);

/// \param mixture  whether a ready distribution may come without it.
Distribution read_distribution(const Reader& reader, MixturePart mixture);

}  // namespace kinship::json
