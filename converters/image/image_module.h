#pragma once

/// The interface of the image module, in C, so that nothing of the image library is linked into the program:
/// that costs 0.4 s and 130 MB at every start.

#include <stddef.h>
#include <stdint.h>

extern "C" {

enum MesocellPixelType : uint32_t {
  kMesocellPixelUint8 = 0,  ///< sRGB, alpha unassociated
  kMesocellPixelFloat = 1,  ///< linear
  // Numbers that are no colors, as they are.
  kMesocellPixelData8 = 2,
  kMesocellPixelData16 = 3,
  kMesocellPixelData32 = 4,
};

/// A picture to be encoded: rows from the top, channels interleaved, page after page.
struct MesocellImage {
  const char* format;  ///< "png" (8 and 16 bits), "openexr" (floats) or "tiff"
  uint32_t width, height, channel_count;
  uint32_t page_count;  ///< 1 in a PNG; parts of an OpenEXR file are named 0, 1, …
  MesocellPixelType type;
  const char* const* channel_names;
  const void* pixels;
};

/// Gets the bytes of an encoded picture, which are the module's. Throws nothing.
typedef void (*MesocellTakeBytes)(void* context, const void* bytes, size_t count);

/// Encodes a picture and hands its file to `take`, once. Not to a file by name: the library does not look
/// whether the last bytes found room on the disk. Returns 0, or 1 with a text in `message`, cut to
/// `message_bytes` and ended by 0. Throws nothing.
typedef int (*MesocellEncodeImage)(const MesocellImage* image, MesocellTakeBytes take, void* context,
                                   char* message, size_t message_bytes);

/// What a picture's file says of it, before its pixels are read.
struct MesocellImageHeader {
  uint32_t width, height, channel_count;
  uint32_t srgb;  ///< 1: values are in sRGB, not linear
  const char* const* channel_names;
};

/// Returns room for width × height × channel_count floats, or null to refuse the picture. Throws nothing.
typedef float* (*MesocellMakeRoom)(void* context, const MesocellImageHeader* header);

enum MesocellReadStatus : int {
  kMesocellReadDone = 0,
  kMesocellReadFailed = 1,   ///< `message` says why
  kMesocellReadRefused = 2,  ///< the caller did, or a tile of the picture is over `max_bytes`
};

/// Reads a picture of a given format ("png", "openexr", "hdr") and no other, as floats: integers from 0 to
/// 1, alpha as it is in the file. Nothing of the pixels' size is allocated before make_room is asked. Returns
/// a MesocellReadStatus, a message as above. Throws nothing.
typedef int (*MesocellReadImage)(const char* path, const char* format, uint64_t max_bytes,
                                 MesocellMakeRoom make_room, void* context, char* message,
                                 size_t message_bytes);

enum MesocellSampleType : uint32_t {
  kMesocellSampleUint = 0,   ///< uint32_t, the integer as the library has it, not scaled
  kMesocellSampleFloat = 1,  ///< float
};

/// What a file says of its pages, before their pixels are read. All are alike.
struct MesocellPagesHeader {
  uint32_t width, height, channel_count;
  MesocellSampleType type;
  uint32_t bits;   ///< of an integer in the file: 8, 16 or 32, its sign not counted; 0 of a float
  uint32_t srgb;   ///< 1: values are in sRGB, not linear
  uint32_t exact;  ///< 1: values are those that were stored, not what a lossy compression left of them
  const char* const* channel_names;
};

/// Who reads pages. Both functions throw nothing.
struct MesocellPageReader {
  void* context;
  /// 1: integers, too, are given as floats, as they stand in the file and not scaled, so exact to 24 bits;
  /// they may be negative.
  uint32_t as_floats;
  /// 1: the first page alone is read; there may be others, of any kind.
  uint32_t first_only;
  /// Called once, first. Returns room for one page: width × height × channel_count samples of 4 bytes, rows
  /// from the top, channels interleaved; or null to refuse.
  void* (*make_room)(void* context, const MesocellPagesHeader* header);
  /// Called for pages 0, 1, … in order when they stand in that room. Returns 0 to go on, else the reading
  /// ends.
  int (*take)(void* context, uint32_t page);
};

/// Reads the pages of a picture of a given format ("png", "openexr", "hdr", "tiff", "jpeg") and no other,
/// with samples as they are in the file. It must have `page_count` of them, all alike. Integers with a sign
/// must not be negative. Nothing of the pixels' size is allocated before make_room is asked. A file whose
/// pages are of tiles over `max_bytes` is refused. Returns a MesocellReadStatus, a message as above. Throws
/// nothing. Of a TIFF the caller checks the directory: the library misreads some kinds without a word.
typedef int (*MesocellReadPages)(const char* path, const char* format, uint32_t page_count,
                                 uint64_t max_bytes, const MesocellPageReader* reader, char* message,
                                 size_t message_bytes);

/// Changes whenever this header does; a module of another version is not used.
#define MESOCELL_IMAGE_MODULE_VERSION 6u
typedef uint32_t (*MesocellImageModuleVersion)(void);
}
