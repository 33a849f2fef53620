#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "converters/export/file_stream.h"
#include "sdk/core/progress.h"

namespace mesocell {

/// The binary part of a GLB file: views that begin at multiples of four and are written one after the other.
class GlbViews {
 public:
  struct View {
    std::uint64_t offset, bytes;
    int target;  ///< 34962 of vertices, 34963 of indices, 0 of neither
    int stride;  ///< 0 where values are packed
    std::function<void(FileStream& out)> write;
  };

  /// `write` writes exactly `bytes`, now or never. Returns the view's number.
  std::size_t add(std::uint64_t bytes, int target, int stride, std::function<void(FileStream& out)> write) {
    views_.push_back({size_, bytes, target, stride, std::move(write)});
    size_ += (bytes + 3) / 4 * 4;
    return views_.size() - 1;
  }
  [[nodiscard]] const std::vector<View>& views() const { return views_; }
  [[nodiscard]] std::uint64_t size() const { return size_; }

 private:
  std::vector<View> views_;
  std::uint64_t size_ = 0;
};

/// Writes header, JSON and views. Errors: kLimit (over 4 GiB), kOutput, kCancelled.
[[nodiscard]] Status write_glb(const std::string& path, std::string_view json, const GlbViews& views,
                               bool no_clobber, std::uint64_t* file_bytes, const Progress* progress);

}  // namespace mesocell
