#pragma once

#include <cstddef>

/// Limits of all input from outside; proto/CONTRACT.md lists them for other languages.
namespace kinship {

inline constexpr std::size_t kMaxDof = 32;
inline constexpr std::size_t kMaxWaypoints = 16384;
inline constexpr std::size_t kMaxUrdfBytes = 1'000'000;
inline constexpr std::size_t kMaxTaskBytes = 128;
inline constexpr std::size_t kMaxLabelBytes = 64;
inline constexpr std::size_t kMaxWordBytes = 64;   ///< of an enumerator's word, or a job's id
inline constexpr std::size_t kMaxProofBytes = 96;  ///< of an admin request: 48 bytes in hex
inline constexpr std::size_t kMaxProfileBytes = 256;
inline constexpr std::size_t kMaxLinkNameBytes = 128;
inline constexpr std::size_t kMaxMachineBytes = 128;
inline constexpr std::size_t kMaxPlannerBytes = 128;
inline constexpr std::size_t kMaxPlannerOptionsBytes = 1024;
inline constexpr std::size_t kMaxHeldJoints = 64;
inline constexpr std::size_t kMaxCollisionPairs = 4096;
inline constexpr std::size_t kMaxMeshSolids = 1024;                     ///< of one robot
inline constexpr std::size_t kMaxLinkMeshes = 256;                      ///< of one robot
inline constexpr std::size_t kMaxCanonicalMeshBytes = 4 * 1024 * 1024;  ///< of one, not compressed
inline constexpr std::size_t kMaxMeshZlibBytes = 512 * 1024;            ///< of one, compressed
inline constexpr std::size_t kMaxRobotMeshBytes = 16 * 1024 * 1024;     ///< of a robot, compressed
inline constexpr std::size_t kMaxContentsARequest = 64;                 ///< of meshes
inline constexpr std::size_t kMaxVisualTriangles = 10'000;  ///< of one, for pictures alone
inline constexpr std::size_t kMaxAttemptsPerBatch = 256;
inline constexpr std::size_t kMaxBatchBytes = 512 * 1024;   ///< of waypoints, search records
inline constexpr std::size_t kMaxSceneBytes = 256 * 1024;   ///< of a scene, and of a batch
inline constexpr std::size_t kMaxSearchBytes = 128 * 1024;  ///< of a search record
inline constexpr std::size_t kMaxSearchGoals = 64, kMaxBlockers = 32, kMaxGoalContacts = 256;
inline constexpr std::size_t kMaxSearchTrees = 2;
inline constexpr std::size_t kMaxWhyBytes = 512;
inline constexpr std::size_t kMaxSceneObjects = 2048;
inline constexpr std::size_t kMaxHeldObjects = 64;
inline constexpr std::size_t kMaxAllowedPairs = 1024;          ///< of a recorded scene
inline constexpr double kMinVoxel_m = 0.001, kMaxVoxel_m = 1;  ///< of a point cloud
inline constexpr std::size_t kMaxComponents = 1024;
inline constexpr std::size_t kMaxKernels = 4000;  ///< components that share one covariance
inline constexpr std::size_t kMaxComponentScores = 64;
inline constexpr std::size_t kMaxSources = 1024;
inline constexpr std::size_t kMaxJudgedAttempts = 256;  ///< in an advice
inline constexpr std::size_t kMaxPageBytes = 512 * 1024;
inline constexpr std::size_t kMaxPageRows = 1000;
inline constexpr std::size_t kMaxCursorBytes = 512;
inline constexpr std::size_t kMaxMessageBytes = 2048;
inline constexpr std::size_t kMaxSampleBytes = 1'200'000;  ///< of one DDS sample
inline constexpr std::size_t kMaxFetchDeadline_ms = 3'600'000;
inline constexpr std::size_t kMaxRetryAfter_ms = 60'000;  ///< maximum wait in a reply
inline constexpr std::size_t kMaxFollow_s = 86'400;
inline constexpr std::size_t kMaxEventBytes = 512;  ///< of an event's text
inline constexpr std::size_t kMaxBackupNameBytes = 128;
inline constexpr std::size_t kMaxBackupChunkBytes = 384 * 1024;  ///< 512 KB in base64
inline constexpr std::size_t kMaxTargetBytes = 1024;  ///< of an audit entry; argument of a job
inline constexpr std::size_t kMaxSelectedSources = 256;
inline constexpr std::size_t kMaxSameArms = 1024;
inline constexpr std::size_t kMaxConsistencyTokenBytes = 64;
inline constexpr std::size_t kMaxStatusRows = 64;  ///< of a list in a status
inline constexpr double kMaxJointValue = 1e4;      ///< joint units, of joints without limits
inline constexpr double kMaxPlacement_m = 1000.0;  ///< largest coordinate of a placement or pose

}  // namespace kinship
