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

/// Changes whenever this header does; a module of another version is not used.
#define MESOCELL_IMAGE_MODULE_VERSION 1u
typedef uint32_t (*MesocellImageModuleVersion)(void);
}
