// make_golden_store FILE: writes the store that README.md speaks of.

#include <filesystem>
#include <iostream>

#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/golden/golden_store.hpp"

namespace kinship {
namespace {

int make(const std::filesystem::path& file) {
  if (std::filesystem::exists(file)) {
    std::cerr << "make_golden_store: '" << file.string() << "' is there already\n";
    return 1;
  }
  // Pages of 1 KB instead of 4: to keep it small.
  store::Database(file, store::Access::Create).execute("PRAGMA page_size = 1024; VACUUM");
  {
    const std::unique_ptr<store::Store> store = store::open_sqlite_store(file);
    const AuditEntry audit = test::golden_audit_entry();
    for (const store::RobotRecord& robot : test::golden_robots())
      static_cast<void>(store->register_robot(robot).value_or_throw());
    test::report(*store, test::golden_attempts());
    test::report(*store, test::golden_attempts_with_scene());
    store->put_distribution(test::golden_distribution());
    store->put_distribution(test::golden_distribution());
    test::report(*store, {test::golden_retired_attempt(), test::golden_same_content()});
    static_cast<void>(
        store->retire_path(test::golden_retired_attempt().report_uuid, &audit).value_or_throw());
    const Uuid retired_before = test::id_from<Uuid>(test::kGoldenRetiredBefore);
    static_cast<void>(store->retire_reports(std::span(&retired_before, 1)));
    store->put_notes({{"golden", "note"}});
    store->put_distribution(test::golden_evicted_distribution());
    store->evict_distribution(test::golden_evicted_distribution().id, &audit);
    store->put_rehearsal(test::golden_rehearsal());
    store->add_audit(audit);
    store::RobotRecord robot = test::golden_robots()[0];
    robot.description.mesh_solids = test::golden_mesh_solids();
    robot.description.meshes = test::golden_link_meshes();
    ++robot.geometry_revision;
    static_cast<void>(store->replace_geometry(robot));
    store->put_meshes(robot.digest, {test::golden_mesh().content()}, {1U << 20U, 0});
  }
  {
    const std::unique_ptr<store::Store> store =
        store::open_sqlite_store(file, {.max_paths_per_pair = test::kGoldenCap});
    test::report(*store, test::golden_capped_attempts());
    static_cast<void>(store->remove_task(test::golden_retired_attempt().task).value_or_throw());
  }
  store::Database(file, store::Access::ReadWrite).execute("PRAGMA journal_mode = DELETE; VACUUM");
  for (const char* const suffix : {".lock", ".high-water-mark"})
    std::filesystem::remove(file.string() + suffix);
  std::cout << file.string() << ": " << std::filesystem::file_size(file) << " bytes\n";
  return 0;
}

}  // namespace
}  // namespace kinship

int main(int count, char** arguments) {
  if (count != 2) {
    std::cerr << "usage: make_golden_store FILE\n";
    return 2;
  }
  try {
    return kinship::make(arguments[1]);
  } catch (const kinship::Failure& failure) {
    std::cerr << "make_golden_store: " << failure.what() << "\n";
    return 1;
  }
}
