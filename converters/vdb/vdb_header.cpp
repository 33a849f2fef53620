#include "converters/vdb/vdb_header.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <span>
#include <string_view>

#include "converters/image/input_file.h"
#include "converters/import/sniff.h"
#include "format/byte_reader.h"

namespace mesocell {
namespace {

constexpr std::uint64_t kMagic = 0x56444220;
constexpr std::uint32_t kOldest = 222, kNewest = 224;
constexpr std::uint64_t kMaxText = 1 << 16, kMaxRead = std::uint64_t{16} << 20;
constexpr std::uint32_t kMaxGrids = 4096, kMaxMetadata = 65536;
constexpr std::string_view kHalf = "_HalfFloat", kTree = "Tree_";
constexpr char kSeparator = '\x1e';  // between a name and what makes it unique

/// Numbers and texts of a file, from any place on.
class FileCursor {
 public:
  explicit FileCursor(const InputFile& file) : file_(file) {}

  [[nodiscard]] bool failed() const { return failed_; }
  [[nodiscard]] std::uint64_t position() const { return position_; }
  void seek(std::uint64_t position) { position_ = position; }

  std::uint64_t number(std::size_t bytes) {
    std::array<std::byte, 8> buffer{};
    fill(std::span(buffer).first(bytes));
    return ByteReader(buffer).u64();
  }
  std::string text() {
    const std::uint64_t size = number(4);
    if (failed_ || size > kMaxText) {
      failed_ = true;
      return {};
    }
    std::string text(std::size_t(size), '\0');
    fill(std::as_writable_bytes(std::span(text)));
    return failed_ ? std::string() : text;
  }
  void skip(std::uint64_t bytes) {
    if (bytes > file_.size() - std::min(position_, file_.size())) failed_ = true;
    if (!failed_) position_ += bytes;
  }

 private:
  void fill(std::span<std::byte> bytes) {
    total_ += bytes.size();
    if (failed_ || total_ > kMaxRead || !file_.read_at(position_, bytes)) {
      failed_ = true;
      std::fill(bytes.begin(), bytes.end(), std::byte{0});
      return;
    }
    position_ += bytes.size();
  }

  const InputFile& file_;
  std::uint64_t position_ = 0, total_ = 0;
  bool failed_ = false;
};

Error damaged(const std::string& what, std::uint64_t at) {
  Error error{ErrorCode::kInvalidInput,
              "the VDB is damaged or ends too early (" + what + "); fetch or export it again"};
  error.offset = at;
  return error;
}

Status read_preamble(FileCursor& cursor) {
  const std::uint32_t version = std::uint32_t(cursor.number(4));
  cursor.skip(8);  // the version of the library that wrote it
  const bool has_offsets = cursor.number(1) != 0;
  cursor.skip(36);  // a number of its own
  if (cursor.failed()) return damaged("its head", cursor.position());
  if (version < kOldest || version > kNewest)
    return Error{ErrorCode::kInvalidInput, "it is a VDB of version " + std::to_string(version) +
                                               ", and versions " + std::to_string(kOldest) + " to " +
                                               std::to_string(kNewest) +
                                               " can be read; open and save it by the program that made it"};
  if (!has_offsets)
    return Error{
        ErrorCode::kInvalidInput,
        "it is a VDB written as a stream, without an index of its grids; open and save it as a file"};
  const std::uint64_t entries = cursor.number(4);
  if (entries > kMaxMetadata) return damaged("its metadata", cursor.position());
  for (std::uint64_t i = 0; i < entries && !cursor.failed(); ++i) {
    (void)cursor.text();
    (void)cursor.text();
    cursor.skip(cursor.number(4));
  }
  if (cursor.failed()) return damaged("its metadata", cursor.position());
  return {};
}

}  // namespace

bool is_vdb_file(const std::string& path) {
  const Result<InputFile> file = InputFile::open(path, ~std::uint64_t{0});
  if (!file) return false;
  FileCursor cursor(*file);
  return cursor.number(8) == kMagic && !cursor.failed();
}

Result<std::vector<VdbGridHead>> read_vdb_header(const std::string& path, std::uint64_t max_file_bytes) {
  const Result<InputFile> file = InputFile::open(path, max_file_bytes);
  if (!file) return file.error();
  FileCursor cursor(*file);
  if (cursor.number(8) != kMagic) {
    std::string begin(std::min<std::uint64_t>(file->size(), 64), '\0');
    const bool read = file->read_at(0, std::as_writable_bytes(std::span(begin)));
    const std::string_view content = read ? sniff_content(begin) : std::string_view();
    return Error{ErrorCode::kInvalidInput,
                 file->size() == 0 ? std::string("it is empty, and no VDB; export it again")
                 : content.empty()
                     ? std::string("it is no VDB, as it does not begin like one; export it again")
                     : "it is no VDB but " + std::string(content) + "; give it the extension of what it is"};
  }
  if (Status status = read_preamble(cursor); !status) return status.error();
  const std::uint64_t count = cursor.number(4);
  if (cursor.failed() || count > kMaxGrids) return damaged("its number of grids", cursor.position());
  if (count == 0) return Error{ErrorCode::kInvalidInput, "the VDB has no grids; export it with one"};

  std::vector<VdbGridHead> grids;
  std::vector<std::string> parents;
  std::set<std::string> names;
  std::map<std::string, std::uint32_t> of_name;
  for (std::uint64_t i = 0; i < count; ++i) {
    const std::uint64_t begin = cursor.position();
    VdbGridHead grid;
    const std::string unique_name = cursor.text();
    grid.type = cursor.text();
    parents.push_back(cursor.text());
    const std::uint64_t grid_at = cursor.number(8), blocks_at = cursor.number(8), end = cursor.number(8);
    if (cursor.failed() || grid_at < cursor.position() || blocks_at < grid_at || end < blocks_at ||
        end > file->size())
      return damaged("where its grid " + std::to_string(i) + " is", begin);
    if (!names.insert(unique_name).second) return damaged("two grids of one name", begin);
    if (grid.type.ends_with(kHalf)) {
      grid.half = true;
      grid.type.resize(grid.type.size() - kHalf.size());
    }
    if (grid.type.starts_with(kTree)) grid.type.erase(0, kTree.size());
    const std::size_t separator = unique_name.find(kSeparator);
    grid.name = unique_name.substr(0, separator);
    grid.key = separator == unique_name.npos ? unique_name
                                             : grid.name + "[" + unique_name.substr(separator + 1) + "]";
    grid.index = of_name[grid.name]++;
    grids.push_back(std::move(grid));
    cursor.seek(end);
  }
  for (const std::string& parent : parents)
    if (!parent.empty() && !names.contains(parent)) return damaged("a grid that another one refers to", 0);
  for (VdbGridHead& grid : grids) grid.only = of_name[grid.name] == 1;
  return grids;
}

}  // namespace mesocell
