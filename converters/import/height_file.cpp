#include "converters/import/height_file.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "converters/image/page_reader.h"
#include "converters/import/picture_file.h"

namespace mesocell {
namespace {

constexpr std::uint32_t kMaxMapSide = 1u << 16;
constexpr std::size_t kMaxMapChannels = 16;

}  // namespace

Result<HeightSamples> read_height_file(const std::string& path, const HeightReadOptions& options,
                                       const Progress* progress) {
  Result<PictureFile> picture = examine_picture(
      path, {.max_file_bytes = options.max_file_bytes, .max_pages = 1024, .max_side = kMaxMapSide});
  if (!picture) {
    Error error = picture.error();
    if (error.code == ErrorCode::kInvalidInput && error.message.find("; ") == std::string::npos)
      error.message += std::string("; heights are read from ") + kHeightSources;
    return error;
  }
  if (picture->pages != 1)
    return Error{ErrorCode::kInvalidInput,
                 "it has " + std::to_string(picture->pages) + " pages, and heights are one; take it apart"};
  HeightSamples out;
  out.format = picture->format;
  std::size_t channel = 0, channels = 0;
  PageSink sink;
  sink.as_floats = true;
  sink.begin = [&](const PageHeader& header) -> Status {
    channels = header.channels.size();
    const std::uint64_t pixels = std::uint64_t{header.width} * header.height;
    if (pixels > options.max_pixels || channels > kMaxMapChannels)
      return Error{ErrorCode::kLimit, std::to_string(header.width) + " x " + std::to_string(header.height) +
                                          " pixels of " + std::to_string(channels) +
                                          " channels are over the limit; use a smaller picture"};
    if (!options.channel.empty()) {
      const auto at = std::find(header.channels.begin(), header.channels.end(), options.channel);
      if (at == header.channels.end()) {
        std::string names;
        for (const std::string& name : header.channels) names += (names.empty() ? "" : ", ") + name;
        return Error{ErrorCode::kUsage, "it has no channel '" + options.channel + "'; there are: " + names};
      }
      channel = std::size_t(at - header.channels.begin());
    }
    out.channel = header.channels[channel];
    for (const std::string& other : header.channels)
      if (other != out.channel) out.notes.lose("channel " + other);
    out.width = header.width;
    out.depth = header.height;
    // The 8 bits of an .hdr are how it stores floats, and are read as they are.
    out.exact = header.exact || out.format == "hdr";
    if (header.bits > 0) out.full = float(std::ldexp(1.0, int(header.bits)) - 1);
    out.samples.resize(std::size_t(pixels));
    return {};
  };
  sink.take = [&](std::uint32_t, PageSamples samples) -> Status {
    if (progress && progress->cancelled()) return Error{ErrorCode::kCancelled, "cancelled"};
    for (std::size_t i = 0; i < out.samples.size(); ++i) {
      const float s = float_sample(samples[i * channels + channel]);
      const bool missing = options.no_data && s == float(*options.no_data);
      out.samples[i] = missing ? std::numeric_limits<float>::quiet_NaN() : s;
    }
    return {};
  };
  if (Status status = read_pages(path, picture->format, 1, sink); !status) return status.error();
  return out;
}

}  // namespace mesocell
