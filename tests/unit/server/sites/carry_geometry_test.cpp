#include "server/sites/carry_geometry.hpp"

#include "server/runtime/robot_registry.hpp"
#include "server/sites/exchange.hpp"
#include "tests/support/box_mesh.hpp"
#include "tests/unit/server/fleet.hpp"
#include "tests/unit/server/sites/site_and_memory.hpp"

namespace kinship::sites {
namespace {

RobotDescription rough() { return fleet::with_shape(fleet::teacher(), "<mesh filename='a.stl'/>"); }
RobotDescription fitted() {
  RobotDescription description = rough();
  description.mesh_solids.solids = {{"link1", SphereShape{0.1}}};
  return description;
}
RobotDescription exact(double radius_m = 0.05) {
  return fleet::with_shape(fleet::teacher(), "<sphere radius='" + std::to_string(radius_m) + "'/>");
}

/// Two sites, ulm and bern, and the memory; each server of them is a registry over its store.
class Geometry : public testing::Test {
 protected:
  struct Place {
    explicit Place(const std::filesystem::path& file) : store(store::open_sqlite_store(file)) {}

    void registers(const RobotDescription& description) {
      const RegisterReply reply = runtime::RobotRegistry(*store).register_robot(description, 1);
      EXPECT_NE(reply.status, RegisterStatus::Refused) << reply.message;
    }
    GeometryGrade grade() const {
      return runtime::RobotRegistry(*store).find(kRobot).value()->grade;
    }
    std::uint64_t revision() const { return store->find_robot(kRobot)->geometry_revision; }

    std::unique_ptr<store::Store> store;
    std::optional<Positions> positions;
    std::optional<Exchange> exchange;
    ExchangeCounts counts;
  };

  void talk(Place& site, bool begins_anew = false) {
    if (begins_anew || !site.exchange) {
      site.exchange.reset();
      site.positions.emplace(*site.store);
      ExchangeOptions options;
      options.look_every = std::chrono::milliseconds(0);
      SiteHooks hooks;
      hooks.tasks_in_use = [] { return std::set<std::string>{"shelf"}; };
      site.exchange.emplace(*site.store, *memory_.store, *site.positions, site.counts, hooks,
                            options);
    }
    for (int idle = 0; idle < 8;)
      idle = site.exchange->step().has_worked ? 0 : idle + 1;
  }
  void talk_all() {
    for (int round = 0; round < 2; ++round)
      for (Place* const site : {&ulm_, &bern_})
        talk(*site);
  }
  void report(Place& site, std::uint64_t number) {
    test::report(*site.store, {fleet::solved(fleet::robot_of(rough()), "shelf", number)});
  }

  static inline const Digest kRobot = fleet::chain_of(rough()).digest();
  const test::TemporaryDirectory directory_;
  Place memory_{directory_ / "memory.db"}, ulm_{directory_ / "ulm.db"},
      bern_{directory_ / "bern.db"};
};

TEST_F(Geometry, ThatIsBetterSpreadsFromWhoeverHasItToAllOthers) {
  ulm_.registers(rough());
  bern_.registers(exact());
  report(ulm_, 1);
  report(bern_, 2);
  talk_all();
  for (const Place* const place : {&memory_, &ulm_, &bern_})
    EXPECT_EQ(place->grade(), GeometryGrade::Exact);
  EXPECT_EQ(bern_.revision(), 0U) << "it had it";
}

TEST_F(Geometry, ThatComesLaterSpreadsWithoutAnotherReport) {
  ulm_.registers(rough());
  bern_.registers(rough());
  report(ulm_, 1);
  report(bern_, 2);
  talk_all();
  ASSERT_EQ(memory_.grade(), GeometryGrade::None);
  ulm_.registers(fitted());
  talk_all();
  for (const Place* const place : {&memory_, &ulm_, &bern_})
    EXPECT_EQ(place->grade(), GeometryGrade::Approximate);
  // Both improve while they are cut off: the better one is kept, however often each improved.
  bern_.registers(exact());
  talk_all();
  for (const Place* const place : {&memory_, &ulm_, &bern_})
    EXPECT_EQ(place->grade(), GeometryGrade::Exact);
}

TEST_F(Geometry, OfMeshesSpreadsWithTheirContents) {
  const TriangleMesh mesh =
      TriangleMesh::from_corners(test::BoxMesh({0.1, 0.1, 0.3}).triangles()).value_or_throw();
  ulm_.registers(fitted());
  bern_.registers(fitted());
  report(ulm_, 1);
  report(bern_, 2);
  talk_all();
  RobotDescription meshed = fitted();
  meshed.meshes = {{"link1", MeshRole::Both, Eigen::Isometry3d::Identity(), {}, 0, mesh.digest()}};
  ulm_.registers(meshed);
  talk_all();
  for (const Place* const place : {&memory_, &ulm_, &bern_})
    EXPECT_EQ(place->grade(), GeometryGrade::Approximate) << "the content is nowhere yet";
  meshed.contents = {mesh.content()};
  ulm_.registers(meshed);
  talk_all();
  for (const Place* const place : {&memory_, &ulm_, &bern_}) {
    EXPECT_EQ(place->grade(), GeometryGrade::Exact);
    EXPECT_TRUE(place->store->find_mesh(mesh.digest()));
  }
}

TEST_F(Geometry, OfOneGradeStaysWhereItIsAndGoesNotToAndFro) {
  ulm_.registers(exact(0.1));
  bern_.registers(exact(0.2));
  report(ulm_, 1);
  report(bern_, 2);
  talk_all();
  for (Place* const site : {&ulm_, &bern_})
    talk(*site, true);
  for (const Place* const place : {&memory_, &ulm_, &bern_})
    EXPECT_EQ(place->revision(), 0U);
  EXPECT_EQ(bern_.store->find_robot(kRobot)->description.urdf, exact(0.2).urdf);
  EXPECT_EQ(memory_.store->find_robot(kRobot)->description.urdf, exact(0.1).urdf);
}

TEST_F(Geometry, KeepsTheLabelThatARobotHasAtEachPlace) {
  RobotDescription renamed = exact();
  renamed.label = "of_bern";
  ulm_.registers(rough());
  bern_.registers(renamed);
  report(ulm_, 1);
  report(bern_, 2);
  talk_all();
  EXPECT_EQ(ulm_.store->find_robot(kRobot)->description.label, "teacher");
  EXPECT_EQ(memory_.store->find_robot(kRobot)->description.label, "teacher");
  EXPECT_EQ(bern_.store->find_robot(kRobot)->description.label, "of_bern");
}

TEST_F(Geometry, OfWhatHasNotChangedIsNotReadAgain) {
  ulm_.registers(exact());
  int offered = 0;
  const auto count = [&](const Digest&, const RobotDescription&) {
    ++offered;
    return false;
  };
  memory_.registers(rough());
  memory_.registers(fitted());
  GeometryExchange geometry(*ulm_.store, *memory_.store, count, count);
  geometry.compare_changed();
  EXPECT_EQ(offered, 2) << "up, and down";
  geometry.compare_changed();
  geometry.compare_new(kRobot);
  EXPECT_EQ(offered, 2);
  memory_.registers(exact());
  geometry.compare_changed();
  EXPECT_EQ(offered, 4);
}

TEST_F(Geometry, OfARobotThatTheOtherSideDoesNotKnowIsNotCarried) {
  memory_.registers(rough());
  memory_.registers(exact());
  talk(ulm_);
  EXPECT_FALSE(ulm_.store->find_robot(kRobot));
  ulm_.registers(rough());
  talk(ulm_);
  EXPECT_EQ(ulm_.grade(), GeometryGrade::Exact) << "once it does";
}

}  // namespace
}  // namespace kinship::sites
