#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

/// Who may use whom. A new edge is decided here first, then in the code.
namespace kinship::architecture {

/// What one folder's sources may include besides their own headers and the standard library.
struct AllowedEdges {
  std::set<std::string> libraries;  ///< folders of this repository
  std::set<std::string> external;   ///< names of `kExternalLibraries`
};

/// External libraries by the beginning of their include paths.
inline const std::map<std::string, std::set<std::string>> kExternalLibraries = {
    {"Eigen", {"Eigen/", "unsupported/Eigen/"}},
    {"libcrypto", {"openssl/"}},
    {"Boost.Random", {"boost/random/"}},
    {"Boost.CRC", {"boost/crc.hpp"}},
    {"Boost.Beast", {"boost/asio/", "boost/beast/"}},
    {"Cyclone DDS", {"dds/"}},
    {"nlohmann-json", {"nlohmann/"}},
    {"urdfdom",
     {"urdf_parser/", "urdf_model/", "urdf_world/", "urdf_exception/", "console_bridge/"}},
    {"toml", {"toml.hpp", "toml/", "toml++/"}},
    {"FCL", {"fcl/"}},
    {"OctoMap", {"octomap/"}},
    {"OMPL", {"ompl/"}},
    {"SQLite", {"sqlite3.h"}},
    {"libpq", {"libpq-fe.h"}},
    {"zlib", {"zlib.h"}},
    {"zstd", {"zstd.h", "zstd_errors.h"}},
    {"zlib", {"zlib.h"}},
    {"CLI11", {"CLI/"}},
    {"spdlog", {"spdlog/"}},
    {"assimp", {"assimp/"}},
    {"tinyxml2", {"tinyxml2.h"}},
    {"pybind11", {"pybind11/"}},
    {"yaml-cpp", {"yaml-cpp/"}},
};

inline const std::map<std::string, AllowedEdges> kAllowedEdges = [] {
  const std::string types = "proto/types";
  const std::string idl = "proto/idl";
  const std::string mixture = "proto/mixture";
  const std::string evidence = "proto/evidence";
  const std::string codec = "proto/codec";
  const std::string json = "proto/json";
  const std::string dds = "proto/dds";
  const std::string manual = "proto/manual";
  const std::string security = "proto/security";
  const std::string tables = "proto/tables";
  const std::string files = "proto/files";
  const std::string kinematics = "robots/kinematics";
  const std::string models = "robots/models";
  const std::string inverse = "robots/inverse";
  const std::string geometry = "robots/geometry";
  const std::string collision = "robots/collision";
  const std::string planning = "robots/planning";
  const std::string recall = "robots/recall";
  const std::string page = "pages/page";
  const std::string plots = "pages/plots";
  const std::string mcap = "pages/mcap";
  const std::string access = "server/access";
  const std::string metrics = "server/metrics";
  const std::string http = "server/http";
  const std::string store = "server/store";
  const std::string transfer = "server/transfer";
  const std::string density = "server/density";
  const std::string runtime = "server/runtime";
  const std::string quotas = "server/quotas";
  const std::string fitting = "server/fitting";
  const std::string catalog = "server/catalog";
  const std::string rehearsal = "server/rehearsal";
  const std::string sites = "server/sites";
  const std::string service = "server/service";
  const std::string ros2_wire = "proto/ros2";
  const std::string ros2 = "server/ros2";
  const std::string console = "server/console";
  const std::string arguments = "client/arguments";
  const std::string link = "client/link";
  const std::string ompl = "client/ompl";
  const std::string guided = "client/guided";
  const std::string planner = "client/planner";
  const std::string moveit = "client/moveit";
  const std::string results = "client/results";
  const std::set<std::string> planner_programs = {
      guided,    link,     arguments,  files,  planning, ompl, evidence, inverse,
      collision, geometry, kinematics, models, mixture,  json, manual,   types};
  std::set<std::string> experiments = planner_programs;
  experiments.insert(results);
  return std::map<std::string, AllowedEdges>{
      {types, {{}, {"Eigen", "libcrypto", "zlib"}}},
      {idl, {{}, {"Cyclone DDS"}}},
      {mixture, {{types}, {"Eigen", "Boost.Random"}}},
      {evidence, {{types}, {}}},
      {codec, {{types, idl}, {"Eigen"}}},
      {json, {{types}, {"Eigen", "nlohmann-json"}}},
      {dds, {{types, security, codec, idl}, {"Cyclone DDS"}}},
      {ros2_wire, {{dds, codec, idl, types}, {"Eigen", "Cyclone DDS"}}},
      {manual, {{types}, {"CLI11"}}},
      {security, {{files, types}, {"libcrypto", "toml"}}},
      {tables, {{types}, {}}},
      {files, {{types}, {}}},
      {kinematics, {{types}, {"Eigen", "urdfdom"}}},
      {models, {{files, geometry, kinematics, types}, {"Eigen", "toml", "tinyxml2"}}},
      {inverse, {{kinematics, types}, {"Eigen"}}},
      {geometry, {{kinematics, types}, {"Eigen", "urdfdom", "assimp", "tinyxml2"}}},
      {collision, {{geometry, kinematics, types}, {"Eigen", "FCL", "OctoMap"}}},
      {planning, {{inverse, collision, geometry, kinematics, mixture, types}, {"Eigen"}}},
      {recall, {{planning, inverse, collision, kinematics, types}, {"Eigen"}}},
      {page, {{geometry, kinematics, models, types}, {"Eigen"}}},
      {plots,
       {{page, evidence, inverse, collision, geometry, kinematics, models, mixture, json, types},
        {"Eigen"}}},
      {mcap, {{page, geometry, kinematics, types}, {"Eigen", "Boost.CRC", "zstd"}}},
      {access, {{types}, {}}},
      {metrics, {{}, {}}},
      {http, {{types}, {"Boost.Beast", "zlib"}}},
      {store, {{files, types}, {"Eigen", "SQLite", "libpq", "zstd"}}},
      {transfer, {{inverse, collision, geometry, kinematics, types}, {"Eigen"}}},
      {density, {{mixture, types}, {"Eigen"}}},
      {runtime, {{store, inverse, geometry, kinematics, types}, {"Eigen"}}},
      {quotas, {{runtime, types}, {}}},
      {fitting, {{runtime, store, transfer, density, inverse, kinematics, types}, {"Eigen"}}},
      {catalog, {{fitting, runtime, store, evidence, types}, {"Eigen"}}},
      {rehearsal,
       {{catalog, fitting, runtime, store, transfer, recall, planning, collision, kinematics,
         types},
        {"Eigen"}}},
      {sites, {{runtime, store, types}, {}}},
      {service,
       {{access, quotas, rehearsal, sites, catalog, fitting, runtime, store, metrics, density,
         inverse, evidence, types},
        {"Eigen"}}},
      {console, {{service, runtime, http, page, plots, evidence, json, types}, {}}},
      {ros2, {{ros2_wire, dds, service, quotas, runtime, types}, {"Eigen"}}},
      {"server/app",
       {{console, ros2, service, access, quotas, runtime, metrics, http, security, dds, codec, json,
         manual, sites, tables, types, store},
        {"CLI11", "spdlog"}}},
      {arguments, {{models, geometry, kinematics, manual, types}, {"Eigen", "CLI11"}}},
      {ompl, {{guided, recall, planning, kinematics, types}, {"Eigen", "OMPL"}}},
      {guided,
       {{recall, planning, evidence, inverse, collision, geometry, kinematics, types}, {"Eigen"}}},
      {link, {{dds, security, codec, kinematics, json, files, types}, {"Eigen"}}},
      {results,
       {{page, planning, collision, kinematics, models, mixture, json, files, types},
        {"Eigen", "CLI11", "nlohmann-json"}}},
      {moveit, {{planning, kinematics, types}, {"Eigen", "yaml-cpp", "SQLite"}}},
      {"client/cli",
       {{link,      arguments, files,      moveit, guided,  ompl, page,   plots,   mcap,   inverse,
         collision, geometry,  kinematics, models, mixture, json, manual, results, tables, types},
        {"Eigen", "CLI11"}}},
      {"client/c",
       {{guided, link, json, evidence, mixture, recall, planning, models, collision, geometry,
         kinematics, types},
        {"Eigen"}}},
      {"client/library",
       {{guided, link, ompl, recall, planning, collision, models, inverse, mixture, kinematics,
         types},
        {}}},
      // A project of its own: what is installed, and files beside its own, which have no folder.
      {"client/examples", {{""}, {"OMPL"}}},
      // A package of ROS: the installed libkinship, its own files, and MoveIt.
      {"client/ros2/kinship_moveit", {{""}, {"Eigen", "OctoMap"}}},
      {planner, {planner_programs, {"Eigen", "CLI11"}}},
      {"client/python",
       {{guided, link, files, ompl, recall, planning, inverse, collision, geometry, kinematics,
         models, mixture, evidence, json, types},
        {"Eigen", "pybind11"}}},
      {"client/experiments", {experiments, {"Eigen", "CLI11", "nlohmann-json"}}},
  };
}();

/// Rooms of server/store/sqlite: each may include what stands before it, and the folder itself all.
inline const std::vector<std::string> kStoreRooms = {"files", "database", "rows", "opening",
                                                     "upkeep"};

/// What of server/store a file in server/store/values may include: it knows no engine.
inline const std::set<std::string> kStoreForValues = {"server/store/store.hpp",
                                                      "server/store/values/"};

/// The same for server/store/rules, which knows no engine either.
inline const std::set<std::string> kStoreForRules = {"server/store/store.hpp",
                                                     "server/store/values/", "server/store/rules/"};

/// The same for server/store/tables, which knows engines as `Session`.
inline const std::set<std::string> kStoreForTables = {
    "server/store/store.hpp", "server/store/session.hpp", "server/store/values/",
    "server/store/rules/", "server/store/tables/"};

}  // namespace kinship::architecture
