#include "server/store/sqlite/database/page_scan.hpp"

#include <sqlite3.h>

#include <algorithm>
#include <utility>

#include "server/store/sqlite/database/checked_vfs.hpp"
#include "server/store/sqlite/database/page_format.hpp"
#include "server/store/sqlite/database/sqlite_error.hpp"

namespace kinship::store {
namespace {

/// Walks one b-tree and asks of each page whether it is wanted.
class Walk {
 public:
  Walk(PageReader& reader, const std::vector<std::uint64_t>& wanted,
       std::map<std::uint64_t, PageOwner>& found, std::chrono::steady_clock::time_point deadline)
      : reader_(&reader), wanted_(&wanted), found_(&found), deadline_(deadline) {}

  enum class Form : std::uint8_t { Tree, Overflow, FreeTrunk, FreeLeaf };

  /// Through all that hangs on a page.
  void walk(std::uint64_t root, Form form, const PageOwner& owner) {
    owner_ = owner;
    next_.clear();
    push(root, form);
    // A sound tree has no page twice; this ends for any other too.
    for (std::uint64_t left = reader_->count(); !next_.empty() && left > 0 && !complete(); --left) {
      const auto [number, its_form] = next_.back();
      next_.pop_back();
      if (std::ranges::binary_search(*wanted_, number))
        found_->try_emplace(number, owner_);
      visit(number, its_form);
    }
  }
  bool complete() const {
    return found_->size() == wanted_->size() || std::chrono::steady_clock::now() > deadline_;
  }

 private:
  void push(std::uint64_t number, Form form) {
    if (number > 0 && number <= reader_->count())
      next_.emplace_back(number, form);
  }
  void visit(std::uint64_t number, Form form) {
    const std::optional<PageBytes> page =
        form == Form::FreeLeaf ? std::nullopt : reader_->read(number);
    if (!page)
      return;
    if (form == Form::Tree)
      visit_tree(*page, number == 1 ? kHeaderOfFile : 0);
    else
      push(big_endian(*page, 0, 4), form);
    if (form == Form::FreeTrunk)
      for (std::uint64_t leaf = 0; leaf < big_endian(*page, 4, 4) && leaf < page->size() / 4;
           ++leaf)
        push(big_endian(*page, 8 + 4 * static_cast<std::size_t>(leaf), 4), Form::FreeLeaf);
  }
  void visit_tree(PageBytes page, std::size_t header) {
    const std::uint8_t type = page[header];
    const bool interior = type == kIndexInterior || type == kTableInterior;
    if (!interior && type != kIndexLeaf && type != kTableLeaf)
      return;
    const std::size_t pointers = header + (interior ? 12 : 8);
    const std::uint64_t cells = big_endian(page, header + 3, 2);
    for (std::size_t cell = 0; cell < cells; ++cell)
      visit_cell(page, static_cast<std::size_t>(big_endian(page, pointers + 2 * cell, 2)), type);
    if (interior)
      push(big_endian(page, header + 8, 4), Form::Tree);
  }
  void visit_cell(PageBytes page, std::size_t at, std::uint8_t type) {
    if (type == kIndexInterior || type == kTableInterior) {
      push(big_endian(page, at, 4), Form::Tree);
      at += 4;
    }
    if (type == kTableInterior)
      return;
    const std::uint64_t payload = varint(page, at);
    if (type == kTableLeaf)
      varint(page, at);  // the row's id
    push(overflow_of(page, at, payload, type == kTableLeaf), Form::Overflow);
  }

  static constexpr std::size_t kHeaderOfFile = 100;
  PageReader* reader_;
  const std::vector<std::uint64_t>* wanted_;
  std::map<std::uint64_t, PageOwner>* found_;
  std::chrono::steady_clock::time_point deadline_;
  PageOwner owner_;
  std::vector<std::pair<std::uint64_t, Form>> next_;
};

/// The schema and its b-trees. No snapshot is kept: a large file takes a while to walk.
std::vector<std::pair<std::uint64_t, PageOwner>> roots_of(Database& database) {
  std::vector<std::pair<std::uint64_t, PageOwner>> roots = {{1, {"sqlite_schema", "the schema"}}};
  {
    Statement query(database.connection(),
                    "SELECT rootpage, tbl_name, type || ' ' || name FROM sqlite_master "
                    "WHERE rootpage > 0");
    while (query.step())
      roots.emplace_back(
          static_cast<std::uint64_t>(query.column_integer(0)),
          PageOwner{std::string(query.column_text(1)), std::string(query.column_text(2))});
  }
  if (database.in_transaction())
    database.execute("COMMIT; BEGIN");
  return roots;
}

}  // namespace

PageReader::PageReader(Database& database)
    : PageReader(database, static_cast<std::size_t>(database.integer("PRAGMA page_size"))) {}

PageReader::PageReader(Database& database, std::size_t page_size) : bytes_(page_size) {
  sqlite3_file_control(&database.connection(), "main", SQLITE_FCNTL_FILE_POINTER, &file_);
}

std::uint64_t PageReader::count() const {
  sqlite3_int64 size = 0;
  if (const int code = file_->pMethods->xFileSize(file_, &size); code != SQLITE_OK)
    throw SqliteError(code, "the size of the store's file cannot be read");
  return static_cast<std::uint64_t>(size) / bytes_.size();
}

std::optional<PageBytes> PageReader::read(std::uint64_t number) {
  const HolesAllowed free_pages;
  const auto offset =
      static_cast<sqlite3_int64>(number - 1) * static_cast<sqlite3_int64>(bytes_.size());
  const int code =
      file_->pMethods->xRead(file_, bytes_.data(), static_cast<int>(bytes_.size()), offset);
  if (code == kDamagedPage)
    return std::nullopt;
  if (code != SQLITE_OK)
    throw SqliteError(
        code, "page " + std::to_string(number) + " cannot be read: " + sqlite3_errstr(code));
  return PageBytes(bytes_);
}

std::map<std::uint64_t, PageOwner> owners_of(Database& database,
                                             const std::vector<std::uint64_t>& pages,
                                             std::chrono::steady_clock::time_point deadline) {
  constexpr std::size_t kFirstTrunkAt = 32;
  PageReader reader(database);
  std::map<std::uint64_t, PageOwner> owners;
  Walk walk(reader, pages, owners, deadline);
  try {
    for (const auto& [root, owner] : roots_of(database))
      walk.walk(root, Walk::Form::Tree, owner);
    if (const auto first = reader.read(1))
      walk.walk(big_endian(*first, kFirstTrunkAt, 4), Walk::Form::FreeTrunk, {"", "free"});
  } catch (const SqliteError& error) {
    if (!error.is_damage())
      throw;
  }
  const bool in_time = std::chrono::steady_clock::now() <= deadline;
  for (const std::uint64_t page : pages)
    owners.try_emplace(
        page, PageOwner{"", in_time ? "unknown, below a damaged page" : "not looked up yet"});
  return owners;
}

}  // namespace kinship::store
