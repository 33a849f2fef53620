#include <algorithm>
#include <atomic>
#include <cmath>
#include <string>

#include "sdk/core/parallel.h"
#include "sdk/tiles/generators.h"

namespace mesocell {
namespace {

/// The even number of courses that divides the bricks and makes them nearest to twice as long as high; 0 if
/// none.
std::uint32_t choose_courses(const GeneratorOptions& options) {
  std::uint32_t best = 0;
  double least = 0;
  for (std::uint32_t courses = 2; courses <= options.cells && courses <= options.resolution[1];
       courses += 2) {
    if (options.cells % courses != 0) continue;
    const double brick = double(options.resolution[0]) / (options.cells / courses);
    const double ratio = brick / (double(options.resolution[1]) / courses) / 2;
    const double off = std::max(ratio, 1 / ratio);
    if (best == 0 || off < least) {
      best = courses;
      least = off;
    }
  }
  return best;
}

}  // namespace

Result<TileMap> make_bricks_tile(const GeneratorOptions& options, TileReport* report) {
  const Result<double> mortar = number_option(options.recipe, "mortar", 0.1, 0, 0.9);
  if (!mortar) return mortar.error();
  const Result<double> given = number_option(options.recipe, "courses", 0, 0, 1024);
  if (!given) return given.error();
  const std::uint32_t courses = *given > 0 ? std::uint32_t(*given) : choose_courses(options);
  if (courses == 0 || courses % 2 != 0 || double(courses) != (*given > 0 ? *given : double(courses)))
    return Error{ErrorCode::kUsage,
                 "bricks in running bond need an even number of courses that fits the resolution"};
  if (options.cells % courses != 0)
    return Error{ErrorCode::kUsage, "cells=" + std::to_string(options.cells) + " is not a multiple of " +
                                        std::to_string(courses) + " courses"};
  const std::uint32_t row = options.cells / courses;  // bricks in a course
  const Index3& n = options.resolution;
  const double length = double(n[0]) / row, height = double(n[1]) / courses, gap = *mortar * height;

  TileBuilder builder(n, options.cells);
  std::atomic<bool> any{false};
  const bool done = parallel_for(
      n[2], options.threads,
      [&](std::size_t z, unsigned) {
        // The mortar lies before each brick on every axis.
        if (double(z) + 0.5 < gap) return;
        for (std::uint32_t y = 0; y < n[1]; ++y) {
          const std::uint32_t course = std::uint32_t((y + 0.5) / height);
          if (y + 0.5 - course * height < gap) continue;
          // Every second course is moved by half a brick, so its last brick reaches into the next tile.
          const double offset = course % 2 == 0 ? 0 : length / 2;
          for (std::uint32_t x = 0; x < n[0]; ++x) {
            const double along = x + 0.5 - offset;
            const double brick = std::floor(along / length);
            if (along - brick * length < gap) continue;
            const bool before = brick < 0;  // the part of the last brick that began in the tile before
            const std::uint32_t cell = course * row + (before ? row - 1 : std::uint32_t(brick)) + 1;
            builder.set(x + std::uint64_t{n[0]} * (y + std::uint64_t{n[1]} * z),
                        builder.code(cell, builder.image_index(before ? -1 : 0, 0, 0)));
            any = true;
          }
        }
      },
      options.progress, "tile");
  if (!done) return Error{ErrorCode::kCancelled, "cancelled"};
  if (!any)
    return Error{ErrorCode::kUsage,
                 "the mortar leaves no brick a voxel; use less of it, or a higher resolution"};
  return builder.finish(options.threads, report);
}

}  // namespace mesocell
