#include "format/issues.h"

#include <array>
#include <cassert>

namespace mesocell {
namespace {

constexpr auto kError = Severity::kError;

constexpr std::array kCatalogue = {
    IssueInfo{"header-truncated", kError, "3.1", Remedy::kDamaged,
              "the file is shorter than its header of 64 bytes"},
    IssueInfo{"header-magic", kError, "3.1", Remedy::kNotMeso,
              "the file does not begin with the signature of a .meso file"},
    IssueInfo{"header-hash", kError, "3.1", Remedy::kDamaged,
              "the header does not have the hash that it states"},
    IssueInfo{"version-unsupported", kError, "3.1", Remedy::kVersion,
              "the file is of a major version that this reader does not know"},
    IssueInfo{"version-newer", Severity::kWarning, "5", Remedy::kNone,
              "the file is of a newer minor version; what this one does not know of it is ignored"},
    IssueInfo{"file-size", kError, "3.1", Remedy::kDamaged,
              "the file does not have the size that its header states"},
    IssueInfo{"header-flags", kError, "3.1", Remedy::kWriter, "the header's flags are not zero"},
    IssueInfo{"header-reserved", kError, "3.1", Remedy::kWriter, "the header's reserved bytes are not zero"},
    IssueInfo{"extension-nonzero", kError, "5", Remedy::kWriter,
              "bits are not zero that only later minor versions may use"},
    IssueInfo{"asset-count", kError, "3.1", Remedy::kWriter, "the number of assets is not in 1…1024"},
    IssueInfo{"chunk-count", kError, "3.1", Remedy::kWriter, "the number of chunks is not in 1…4096"},
    IssueInfo{"directory-truncated", kError, "3.3", Remedy::kDamaged,
              "the file ends within the asset table or the directory"},
    IssueInfo{"directory-hash", kError, "3.1", Remedy::kDamaged,
              "asset table and directory do not have the hash that the header states"},
    IssueInfo{"asset-flags", kError, "3.2", Remedy::kVersion,
              "an asset has flags that this reader must know and does not"},
    IssueInfo{"asset-reserved", kError, "3.2", Remedy::kWriter,
              "reserved bytes of the asset table are not zero"},
    IssueInfo{"asset-name", kError, "3.2", Remedy::kWriter,
              "the name of an asset is not valid UTF-8 followed by zeros"},
    IssueInfo{"asset-name-duplicate", kError, "3.2", Remedy::kWriter, "two assets have the same name"},
    IssueInfo{"asset-name-missing", Severity::kWarning, "3.2", Remedy::kNone,
              "one of several assets has no name"},
    IssueInfo{"asset-chunk-count", kError, "3.2", Remedy::kWriter,
              "the chunks of the assets are not those of the directory"},
    IssueInfo{"chunk-flags", kError, "3.3", Remedy::kVersion,
              "a chunk has flags that this reader must know and does not"},
    IssueInfo{"chunk-codec", kError, "3.3", Remedy::kVersion,
              "a chunk has a codec that is neither raw nor zstd, or that its type does not allow"},
    IssueInfo{"chunk-reserved", kError, "3.3", Remedy::kWriter,
              "reserved bytes of a directory entry are not zero"},
    IssueInfo{"chunk-offset", kError, "3.3", Remedy::kWriter,
              "a chunk does not begin where the one before it ends"},
    IssueInfo{"chunk-bounds", kError, "3.3", Remedy::kDamaged, "a chunk reaches beyond the end of the file"},
    IssueInfo{"chunk-raw-size", kError, "3.3", Remedy::kWriter,
              "a raw chunk does not have as many stored bytes as its decoded bytes and its block table take"},
    IssueInfo{"file-trailing", kError, "3.4", Remedy::kWriter, "the file goes on after its last chunk"},
    IssueInfo{"block-bytes", kError, "3.3", Remedy::kWriter,
              "the block size is not a power of two in 4096…8388608"},
    IssueInfo{"block-table", kError, "3.5", Remedy::kWriter, "a chunk is too small for its block table"},
    IssueInfo{"block-size", kError, "3.5", Remedy::kWriter,
              "a block is empty, larger than what it decodes to, out of order, or not where the chunk ends"},
    IssueInfo{"block-ratio", kError, "3.6", Remedy::kWriter,
              "a block states more decoded bytes than its codec can make of its stored bytes"},
    IssueInfo{"block-hash", kError, "3.5", Remedy::kDamaged,
              "a block does not have the hash that the block table states"},
    IssueInfo{"chunk-hash", kError, "3.3", Remedy::kDamaged,
              "a chunk, or its block table, does not have the hash that the directory states"},
    IssueInfo{"padding-nonzero", kError, "3.4", Remedy::kDamaged,
              "padding in a chunk or after it is not zero"},
    IssueInfo{"representation-unknown", kError, "3.2", Remedy::kVersion,
              "an asset is of a representation that this reader does not know"},
    IssueInfo{"chunk-duplicate", kError, "3.3", Remedy::kWriter, "a chunk type occurs twice in an asset"},
    IssueInfo{"chunk-criticality", kError, "3.3", Remedy::kWriter,
              "a chunk is critical that must be skippable, or the reverse"},
    IssueInfo{"chunk-unknown-critical", kError, "3.3", Remedy::kVersion,
              "a critical chunk is of a type that this reader does not know"},
    IssueInfo{"chunk-unknown-skippable", Severity::kInfo, "3.3", Remedy::kNone,
              "a skippable chunk is of a type that this reader does not know; it is ignored"},
    IssueInfo{"chunk-missing", kError, "4", Remedy::kWriter,
              "a chunk is missing that the representation requires"},
    IssueInfo{"zstd-frame", kError, "3.6", Remedy::kWriter,
              "a block is not a single zstd frame with content size and without dictionary"},
    IssueInfo{"zstd-window", kError, "3.6", Remedy::kWriter,
              "a zstd frame needs a window of more than 8 MiB"},
    IssueInfo{"zstd-size", kError, "3.6", Remedy::kWriter,
              "the content size of a zstd frame is not the decoded size of its block"},
    IssueInfo{"zstd-data", kError, "3.6", Remedy::kWriter, "a zstd frame does not decode"},
    IssueInfo{"payload-truncated", kError, "4", Remedy::kWriter,
              "a chunk ends before all that it should hold"},
    IssueInfo{"payload-trailing", kError, "4", Remedy::kWriter,
              "a chunk goes on after all that it should hold"},
    IssueInfo{"payload-reserved", kError, "4", Remedy::kWriter,
              "reserved bytes of a header in a chunk are not zero"},
    IssueInfo{"payload-padding", kError, "2.6", Remedy::kWriter,
              "bytes between the parts of a chunk are not zero"},
    IssueInfo{"map-error", kError, "2.7", Remedy::kWriter,
              "a stated error is not a finite number or has its sign bit set"},
    IssueInfo{"grid-box", kError, "4.1", Remedy::kWriter, "the grid's box is not finite or has no extent"},
    IssueInfo{"grid-voxel-edge", kError, "4.1", Remedy::kWriter,
              "the voxel edge is not a finite positive number"},
    IssueInfo{"grid-tiles", kError, "4.1", Remedy::kWriter,
              "the number of tiles is zero on an axis or over 2³¹ − 1 in all"},
    IssueInfo{"grid-extent", kError, "4.1", Remedy::kWriter, "an axis has more than 2³⁰ voxels"},
    IssueInfo{"tile-resolution", kError, "4.2", Remedy::kWriter, "the tile resolution is not in 4…1024"},
    IssueInfo{"tile-cell-count", kError, "4.2", Remedy::kWriter, "the number of cells is not in 1…65535"},
    IssueInfo{"tile-piece-count", kError, "4.2", Remedy::kWriter,
              "there are fewer pieces than cells or more than voxels"},
    IssueInfo{"tile-id-bytes", kError, "4.2", Remedy::kWriter,
              "the bytes of a piece id are not the least that hold the number of pieces"},
    IssueInfo{"piece-cell", kError, "4.2", Remedy::kWriter,
              "a piece is of a cell that is not in 1…cell_count"},
    IssueInfo{"piece-reserved", kError, "4.2", Remedy::kWriter, "reserved bytes of a piece are not zero"},
    IssueInfo{"piece-order", kError, "4.2", Remedy::kWriter,
              "pieces are not strictly ascending by (cell, home z, y, x)"},
    IssueInfo{"cell-without-piece", kError, "4.2", Remedy::kWriter, "a cell has no piece"},
    IssueInfo{"voxel-id", kError, "4.2", Remedy::kWriter,
              "a voxel has the id of a piece that does not exist"},
    IssueInfo{"piece-without-voxel", kError, "4.2", Remedy::kWriter, "a piece has no voxel"},
    IssueInfo{"cell-home", kError, "4.2", Remedy::kWriter,
              "the first voxel of a cell does not lie in its home tile"},
    IssueInfo{"memb-rule", kError, "4.3", Remedy::kWriter, "the membership rule is unknown"},
    IssueInfo{"memb-cell-count", kError, "4.3", Remedy::kWriter,
              "membership and tile state different numbers of cells"},
    IssueInfo{"memb-mixed-count", kError, "4.3", Remedy::kWriter,
              "the number of mixed tiles is not that of the states"},
    IssueInfo{"memb-rank", kError, "4.3", Remedy::kWriter,
              "a rank is not the number of mixed tiles before its page"},
    IssueInfo{"memb-tag", kError, "4.3", Remedy::kWriter, "a tag has the code 3"},
    IssueInfo{"memb-unused-bits", kError, "4.3", Remedy::kWriter,
              "unused bits after the states or after the tags of a tile are not zero"},
    IssueInfo{"memb-uniform", kError, "4.3", Remedy::kWriter, "all tags of a mixed tile are the same"},
    IssueInfo{"memb-counts", kError, "4.3", Remedy::kWriter,
              "the stated numbers of inside, outside and intersected instances are not those of the tags"},
    IssueInfo{"memb-nothing-inside", Severity::kWarning, "4.3", Remedy::kNone,
              "no cell instance is INSIDE: there is nothing to be seen"},
    IssueInfo{"text-key", kError, "4.4", Remedy::kWriter,
              "a key does not have 1…256 bytes or holds a zero byte"},
    IssueInfo{"text-utf8", kError, "4.4", Remedy::kWriter, "a key or value is not valid UTF-8"},
    IssueInfo{"text-order", kError, "4.4", Remedy::kWriter, "keys are not strictly ascending"},
    IssueInfo{"text-control", Severity::kWarning, "4.4", Remedy::kNone,
              "a key or value has control characters"},
    IssueInfo{"color-resolution", kError, "4.5", Remedy::kWriter,
              "the resolution of the color map is not in 1…1024"},
    IssueInfo{"normal-encoding", kError, "4.8", Remedy::kVersion, "the encoding of the normals is unknown"},
    IssueInfo{"normal-code", kError, "4.8", Remedy::kWriter, "a byte of a normal is above 252"},
    IssueInfo{"mesh-encoding", kError, "4.10", Remedy::kVersion, "the encoding of the basic mesh is unknown"},
    IssueInfo{"mesh-bytes", kError, "4.10", Remedy::kWriter,
              "the basic mesh has not as many bytes as it states"},
    IssueInfo{"mesh-counts", kError, "4.10", Remedy::kWriter,
              "the basic mesh has fewer than 3 vertices or 1 triangle, or over 2³¹ − 1"},
    IssueInfo{"scol-resolution", kError, "4.11", Remedy::kWriter,
              "the resolution of the surface colors is not in 1…32 or above that of the tile"},
    IssueInfo{"scol-brick-count", kError, "4.11", Remedy::kWriter,
              "the number of bricks is zero or not that of the tiles that have one"},
    IssueInfo{"scol-color-count", kError, "4.11", Remedy::kWriter,
              "the number of surface colors is not that of the color voxels that have one"},
    IssueInfo{"scol-rank", kError, "4.11", Remedy::kWriter,
              "a rank is not the number of bricks or of surface colors before its page"},
    IssueInfo{"scol-empty-brick", kError, "4.11", Remedy::kWriter, "a brick has no color"},
    IssueInfo{"scol-unused-bits", kError, "4.11", Remedy::kWriter,
              "unused bits after those of the tiles or of a brick's color voxels are not zero"},
    IssueInfo{"limit-exceeded", kError, "6", Remedy::kLimit,
              "reading the file would take more than the caller allows"},
};
static_assert(kCatalogue.size() == static_cast<std::size_t>(IssueId::kCount));

}  // namespace

std::string_view severity_name(Severity severity) {
  switch (severity) {
    case Severity::kError:
      return "error";
    case Severity::kWarning:
      return "warning";
    case Severity::kInfo:
      return "info";
  }
  return "error";
}

std::string_view remedy_text(Remedy remedy) {
  switch (remedy) {
    case Remedy::kNone:
      return "";
    case Remedy::kNotMeso:
      return "give a .meso file; other formats must be converted first";
    case Remedy::kDamaged:
      return "the file is damaged: copy or make it again";
    case Remedy::kVersion:
      return "read it with a matching version, or make it again with this one";
    case Remedy::kWriter:
      return "the program that wrote it is at fault: make it again";
    case Remedy::kLimit:
      return "raise the limit if the file is to be trusted";
  }
  return "";
}

std::span<const IssueInfo> issue_catalogue() { return kCatalogue; }

const IssueInfo& issue_info(IssueId id) {
  assert(id < IssueId::kCount);
  return kCatalogue[static_cast<std::size_t>(id)];
}

std::string issue_catalogue_markdown() {
  std::string text =
      "# Issues of Mesocell 1.0 and 1.1\n\n"
      "What a validator reports of a `.meso` file, made from the catalogue in `format/issues.cpp`; a test "
      "fails if\n"
      "the two differ. *Clause* is the section of `mesocell-1.md`. A file is valid if it has no issue of "
      "severity\n"
      "error. Every message adds what was found where.\n\n"
      "| Id | Severity | Clause | Text |\n|---|---|---|---|\n";
  for (const IssueInfo& info : kCatalogue) {
    text.append("| `").append(info.id).append("` | ").append(severity_name(info.severity));
    text.append(" | ").append(info.clause).append(" | ").append(info.text).append(" |\n");
  }
  return text;
}

}  // namespace mesocell
