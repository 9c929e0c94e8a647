#pragma once

#include <gtest/gtest.h>
#include <sqlite3.h>

#include <array>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <future>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "server/store/maintenance.hpp"
#include "server/store/sqlite/database/database.hpp"
#include "server/store/sqlite/sqlite_store.hpp"
#include "tests/support/store_values.hpp"
#include "tests/support/temporary_directory.hpp"

namespace kinship::store::store_damage_test {

namespace fs = std::filesystem;

inline constexpr std::uint64_t kPageSize = 4096;

/// A store in which one place is damaged.
class StoreDamage : public testing::Test {
 protected:
  StoreDamage() { open(); }

  void open(const SqliteOptions& options = {}) {
    store_.reset();
    store_ = open_sqlite_store(file_, options);
    static_cast<void>(store_->register_robot(robot_));
  }
  Attempt attempt(std::uint64_t number, Eigen::Index waypoints = 20) const {
    Attempt made = test::make_attempt(robot_.digest, "shelf", number);
    made.path = test::make_path(number, test::kDof, waypoints);
    return made;
  }
  Receipt report(const Attempt& reported) { return test::report(*store_, {reported}).at(0); }
  std::vector<StoredPath> paths() const {
    return store_->read_paths(robot_.digest, "shelf", {.after_id = 0, .limit = 100'000});
  }
  void drain() { test::report(*store_, {}); }

  void edit(const std::string& sql) {
    store_.reset();
    Database database(file_, Access::ReadWrite);
    database.execute(sql);
    ASSERT_GT(database.changed_rows(), 0) << sql;
  }
  /// The pages that belong to a table or an index, in order.
  std::vector<std::uint64_t> pages_of(const std::string& owner) const {
    Database database(file_, Access::ReadOnly);
    std::vector<std::uint64_t> found;
    for (const Row& row :
         database.query("SELECT pageno FROM dbstat WHERE name = $1 ORDER BY pageno", owner))
      found.push_back(static_cast<std::uint64_t>(row.column_integer(0)));
    return found;
  }
  /// Pages with rows, and not what does not fit on one.
  std::vector<std::uint64_t> leaves_of(const std::string& owner) const {
    Database database(file_, Access::ReadOnly);
    std::vector<std::uint64_t> found;
    for (const Row& row : database.query(
             "SELECT pageno FROM dbstat WHERE name = $1 AND pagetype = 'leaf' ORDER BY pageno",
             owner))
      found.push_back(static_cast<std::uint64_t>(row.column_integer(0)));
    return found;
  }
  /// Of the closed store: SQLite cannot read the page any more.
  void break_page(std::uint64_t page) const {
    constexpr std::uint64_t kHeaderOfFileBytes = 100;
    flip(page, page == 1 ? kHeaderOfFileBytes : 0);
  }
  /// Of the closed store: a bit of a page's content.
  void flip(std::uint64_t page, std::uint64_t place = 4000, int bit = 4) const {
    std::fstream stream(file_, std::ios::in | std::ios::out | std::ios::binary);
    const auto offset = static_cast<std::streamoff>((page - 1) * kPageSize + place);
    stream.seekg(offset);
    const int byte = stream.get();
    stream.seekp(offset);
    stream.put(static_cast<char>(byte ^ bit));
    ASSERT_TRUE(stream.good());
  }
  /// Of the closed store: the entries of an index lead from each of rows 1 and 2 to the other one.
  void swap_entries(const std::string& table, const std::string& index,
                    const std::string& columns) const {
    sqlite3* other = nullptr;
    ASSERT_EQ(sqlite3_open(file_.c_str(), &other), SQLITE_OK);
    const auto page = [](const std::string& owner) {
      return "(SELECT rootpage FROM sqlite_master WHERE name = '" + owner + "')";
    };
    const std::string sql =
        "PRAGMA writable_schema = ON; CREATE TABLE twin AS SELECT 3 - id AS twin_id, " + columns +
        " FROM " + table + "; CREATE TABLE swapped (id INTEGER PRIMARY KEY, " + columns +
        "); INSERT INTO swapped SELECT * FROM twin; CREATE INDEX swapped_entries ON swapped (" +
        columns + "); UPDATE sqlite_master SET rootpage = " + page("swapped_entries") +
        " WHERE name = '" + index + "'";
    EXPECT_EQ(sqlite3_exec(other, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK)
        << sqlite3_errmsg(other);
    sqlite3_close(other);
  }
  /// Where a leaf of a table has the id of its last row: its last byte. The last row is the one
  /// whose entry ends the array of cells; its id follows the size of its content, both as varints.
  std::uint64_t place_of_last_id(std::uint64_t page) const {
    constexpr std::size_t kCells = 3, kArray = 8;
    std::ifstream stream(file_, std::ios::binary);
    stream.seekg(static_cast<std::streamoff>((page - 1) * kPageSize));
    std::array<char, kPageSize> bytes{};
    stream.read(bytes.data(), bytes.size());
    const auto number_at = [&](std::size_t at) {
      return static_cast<std::size_t>(static_cast<unsigned char>(bytes.at(at))) * 256 +
             static_cast<unsigned char>(bytes.at(at + 1));
    };
    std::size_t at = number_at(kArray + 2 * (number_at(kCells) - 1));
    const auto end_of_varint = [&](std::size_t from) {
      while (static_cast<unsigned char>(bytes.at(from)) >= 0x80U)
        ++from;
      return from;
    };
    at = end_of_varint(at) + 1;
    return end_of_varint(at);
  }
  std::string first_finding_of_scrub() {
    std::promise<std::string> said;
    store_ = open_sqlite_store(file_,
                               {.scrub_bytes_per_s = 1'000'000'000,
                                .log = [&, first = true](std::string_view line) mutable {
                                  if (line.starts_with("damaged: ") && std::exchange(first, false))
                                    said.set_value(std::string(line));
                                }});
    auto line = said.get_future();
    if (line.wait_for(std::chrono::seconds(20)) != std::future_status::ready) {
      ADD_FAILURE() << "the scrub found nothing";
      return {};
    }
    return line.get();
  }
  StoreCheck check() const {
    return check_store(file_, [](double) {});
  }

  const test::TemporaryDirectory directory_;
  const fs::path file_ = directory_ / "store.db";
  const RobotRecord robot_ = test::make_robot("panda", 1);
  std::unique_ptr<Store> store_;
};

}  // namespace kinship::store::store_damage_test
