// What recorded scenes cost: bytes of a store with 500 attempts of one robot without a scene, with
// one scene, and with 500 different ones; time to hash, encode and decode one; time to make a
// filter of one, and to ask it. Usage: scene_bench [DIRECTORY]    a place for three stores;
// default: here

#include <unistd.h>

#include <ctime>
#include <filesystem>
#include <functional>
#include <iostream>
#include <random>
#include <string>

#include "server/store/sqlite/scene_blob.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "server/transfer/scene_filter.hpp"
#include "tests/bench/shelf_cell.hpp"
#include "tests/support/store_values.hpp"

namespace kinship::bench {
namespace {

constexpr std::uint64_t kSeed = 1;
constexpr int kAttempts = 500;
constexpr Eigen::Index kWaypoints = 12;  // of a shortened path

RecordedScene scene_of(const kinematics::Chain& chain, std::mt19937_64& generator) {
  const ShelfCell cell = make_shelf_cell(chain, generator);
  RecordedScene scene{cell.surroundings.scene.objects, {}, {}};
  for (const AttachedObject& held : cell.surroundings.attached)
    scene.held.push_back(
        {held.name, held.shape, chain.T_tip_transfer().inverse() * held.T_link_object});
  return scene;
}

/// \param scenes  0: none.
std::uintmax_t store_bytes(const std::filesystem::path& directory, const kinematics::Chain& chain,
                           int scenes) {
  const std::filesystem::path file =
      directory / ("scene_bench_" + std::to_string(getpid()) + ".db");
  store::RobotRecord robot = test::make_robot("panda", 1);
  robot.dof = static_cast<std::uint32_t>(chain.dof());
  {
    const auto store = store::open_sqlite_store(file);
    static_cast<void>(store->register_robot(robot).value_or_throw());
    std::mt19937_64 generator(kSeed);
    RecordedScene scene;
    for (int i = 0; i < kAttempts; ++i) {
      Attempt attempt =
          test::make_attempt(robot.digest, "shelf", static_cast<std::uint64_t>(i) + 1);
      attempt.path = test::make_path(static_cast<std::uint64_t>(i), chain.dof(), kWaypoints);
      if (i < scenes)
        scene = scene_of(chain, generator);
      if (scenes > 0)
        attempt.scene = scene;
      test::report(*store, {attempt});
    }
  }
  const std::uintmax_t bytes = std::filesystem::file_size(file);
  std::filesystem::remove(file);
  std::filesystem::remove(file.string() + ".lock");
  return bytes;
}

/// CPU time of one call, in microseconds.
double time_us(int calls, const std::function<void()>& call) {
  const std::clock_t start = std::clock();
  for (int i = 0; i < calls; ++i)
    call();
  return 1e6 * static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC / calls;
}

void print_filter(const std::string& name, const RecordedScene& scene) {
  const kinematics::Chain chain = test::model_chain(name);
  const geometry::RobotShapes shapes = model_shapes(name);
  const auto identity = Eigen::Isometry3d::Identity();
  const double make_us =
      time_us(200, [&] { transfer::scene_filter(chain, shapes, scene, identity); });
  const transfer::SceneFilter filter = transfer::scene_filter(chain, shapes, scene, identity);
  std::mt19937_64 generator(kSeed);
  int kept = 0;
  constexpr int kAsked = 20'000;
  const double ask_us = time_us(kAsked, [&] {
    Eigen::VectorXd q(chain.dof());
    for (Eigen::Index i = 0; i < q.size(); ++i)
      q[i] = std::uniform_real_distribution<double>(chain.lower()[i], chain.upper()[i])(generator);
    kept += filter.keep(q) ? 1 : 0;
  });
  std::cout << name << ": a filter takes " << make_us << " us to make, " << ask_us
            << " us to ask; keeps " << 100.0 * kept / kAsked << " % of random configurations;";
  for (const auto& [first, second] : filter.always_touching)
    std::cout << " '" << first << "' always touches '" << second << "'";
  std::cout << '\n';
}

void run(const std::filesystem::path& directory) {
  const kinematics::Chain chain = test::model_chain("panda");
  const std::uintmax_t none = store_bytes(directory, chain, 0);
  std::cout << kAttempts << " attempts without a scene: " << none << " bytes\n";
  for (const int scenes : {1, kAttempts}) {
    const std::uintmax_t bytes = store_bytes(directory, chain, scenes);
    std::cout << kAttempts << " attempts with " << scenes << " scenes: " << bytes << " bytes, "
              << (static_cast<double>(bytes) - static_cast<double>(none)) / kAttempts
              << " more an attempt\n";
  }
  std::mt19937_64 generator(kSeed);
  const RecordedScene scene = scene_of(chain, generator);
  const store::SceneBlob blob = store::encode_scene(scene);
  std::cout << "a scene of " << scene.objects.size() << " objects and " << scene.held.size()
            << " held: " << scene_bytes(scene) << " bytes on the wire, " << blob.size << " plain, "
            << blob.bytes.size() << " kept; hash " << time_us(2000, [&] { content_digest(scene); })
            << " us, encode " << time_us(2000, [&] { store::encode_scene(scene); })
            << " us, decode "
            << time_us(2000,
                       [&] {
                         store::decode_scene(blob.size, static_cast<std::int64_t>(blob.encoding),
                                             blob.bytes);
                       })
            << " us\n";
  for (const char* const name : {"panda", "ur10e", "iiwa14"})
    print_filter(name, scene);
}

}  // namespace
}  // namespace kinship::bench

int main(int count, char** arguments) {
  kinship::bench::run(count > 1 ? arguments[1] : ".");
  return 0;
}
