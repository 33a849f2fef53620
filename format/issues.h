#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "format/api.h"

namespace mesocell MESOCELL_API {

enum class Severity : std::uint8_t {
  kError,    ///< the file is invalid, readers refuse it
  kWarning,  ///< valid, but likely not what was meant
  kInfo,     ///< valid, worth knowing
};

/// "error", "warning", "info".
[[nodiscard]] std::string_view severity_name(Severity severity);

/// A fault or remark about a file.
struct Issue {
  std::string_view id;  ///< of the catalogue, e.g. "header-magic"
  Severity severity = Severity::kError;
  std::optional<std::uint64_t> offset;  ///< byte in the file, where it is known
  std::uint32_t chunk = 0;              ///< four-character code, 0 outside any chunk
  std::string text;
};

/// The catalogue's entries, in the order of issue_catalogue().
enum class IssueId : std::uint8_t {
  kHeaderTruncated,
  kHeaderMagic,
  kHeaderHash,
  kVersionUnsupported,
  kVersionNewer,
  kFileSize,
  kHeaderFlags,
  kHeaderReserved,
  kExtensionNonzero,
  kAssetCount,
  kChunkCount,
  kDirectoryTruncated,
  kDirectoryHash,
  kAssetFlags,
  kAssetReserved,
  kAssetName,
  kAssetNameDuplicate,
  kAssetNameMissing,
  kAssetChunkCount,
  kChunkFlags,
  kChunkCodec,
  kChunkReserved,
  kChunkOffset,
  kChunkBounds,
  kChunkRawSize,
  kFileTrailing,
  kBlockBytes,
  kBlockTable,
  kBlockSize,
  kBlockRatio,
  kBlockHash,
  kChunkHash,
  kPaddingNonzero,
  kRepresentationUnknown,
  kChunkDuplicate,
  kChunkCriticality,
  kChunkUnknownCritical,
  kChunkUnknownSkippable,
  kChunkMissing,
  kZstdFrame,
  kZstdWindow,
  kZstdSize,
  kZstdData,
  kPayloadTruncated,
  kPayloadTrailing,
  kPayloadReserved,
  kPayloadPadding,
  kMapError,
  kGridBox,
  kGridVoxelEdge,
  kGridTiles,
  kGridExtent,
  kTileResolution,
  kTileCellCount,
  kTilePieceCount,
  kTileIdBytes,
  kPieceCell,
  kPieceReserved,
  kPieceOrder,
  kCellWithoutPiece,
  kVoxelId,
  kPieceWithoutVoxel,
  kCellHome,
  kMembRule,
  kMembCellCount,
  kMembMixedCount,
  kMembRank,
  kMembTag,
  kMembUnusedBits,
  kMembUniform,
  kMembCounts,
  kMembNothingInside,
  kTextKey,
  kTextUtf8,
  kTextOrder,
  kTextControl,
  kColorResolution,
  kNormalEncoding,
  kNormalCode,
  kMeshEncoding,
  kMeshBytes,
  kMeshCounts,
  kScolResolution,
  kScolBrickCount,
  kScolColorCount,
  kScolRank,
  kScolEmptyBrick,
  kScolUnusedBits,
  kLimitExceeded,
  kCount,
};

/// What a person can do about an issue.
enum class Remedy : std::uint8_t { kNone, kNotMeso, kDamaged, kVersion, kWriter, kLimit };
/// The remedy as half a sentence; empty for kNone.
[[nodiscard]] std::string_view remedy_text(Remedy remedy);

/// A row of the catalogue, from which messages and spec/issues.md are made.
struct IssueInfo {
  std::string_view id;
  Severity severity;
  std::string_view clause;  ///< of spec/mesocell-1.md
  Remedy remedy;
  std::string_view text;
};

/// All rows, indexed by IssueId.
[[nodiscard]] std::span<const IssueInfo> issue_catalogue();
[[nodiscard]] const IssueInfo& issue_info(IssueId id);

/// The text of spec/issues.md.
[[nodiscard]] std::string issue_catalogue_markdown();

}  // namespace mesocell
