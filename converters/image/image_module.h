#pragma once

/// The interface of the image module, in C, so that nothing of the image library is linked into the program:
/// that costs 0.4 s and 130 MB at every start.

#include <stddef.h>
#include <stdint.h>

extern "C" {

enum MesocellPixelType : uint32_t {
  kMesocellPixelUint8 = 0,  ///< sRGB, alpha unassociated
  kMesocellPixelFloat = 1,  ///< linear
};

/// A picture to be written: rows from the top, channels interleaved.
struct MesocellImage {
  const char* path;  ///< the format follows the extension
  uint32_t width, height, channel_count;
  MesocellPixelType type;
  const char* const* channel_names;
  const void* pixels;
};

/// Writes a picture. Returns 0, or 1 with a text in `message`, cut to `message_bytes` and ended by 0. Throws
/// nothing.
typedef int (*MesocellWriteImage)(const MesocellImage* image, char* message, size_t message_bytes);

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
  kMesocellReadRefused = 2,  ///< make_room returned null, or a tile of the picture is over `max_bytes`
};

/// Reads a picture of a given format ("png", "openexr", "hdr") and no other, as floats: integers from 0 to
/// 1, alpha as it is in the file. Nothing of the pixels' size is allocated before make_room is asked. Returns
/// a MesocellReadStatus, a message as above. Throws nothing.
typedef int (*MesocellReadImage)(const char* path, const char* format, uint64_t max_bytes,
                                 MesocellMakeRoom make_room, void* context, char* message,
                                 size_t message_bytes);

/// Changes whenever this header does; a module of another version is not used.
#define MESOCELL_IMAGE_MODULE_VERSION 2u
typedef uint32_t (*MesocellImageModuleVersion)(void);
}
