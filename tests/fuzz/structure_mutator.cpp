#include <algorithm>
#include <cstring>

#include "format/container.h"
#include "sdk/core/rng.h"
#include "tests/format/mutations.h"
#include "tests/format/test_file.h"
#include "tests/fuzz/fuzz.h"

// Mutations for targets whose input is a file: it is taken apart, chunks or the fields before them are
// changed, and it is put together with hashes that fit. Bytes changed anywhere would end at a hash.

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t max_size);

using namespace mesocell;
using namespace mesocell::test;

namespace {

Bytes bytes_of(const std::uint8_t* data, std::size_t size) {
  const auto bytes = std::as_bytes(std::span(data, size));
  return {bytes.begin(), bytes.end()};
}

/// The file's chunks, if they can be had.
std::optional<TestFile> take_apart(const Bytes& file) {
  const auto container = Container::open(file, fuzz::kLimits);
  if (!container || !container->verify(0)) return std::nullopt;
  for (const ChunkInfo& chunk : container->chunks_of(0))
    if (!container->read_chunk(0, chunk.type)) return std::nullopt;
  return TestFile::take_apart(file);
}

/// By libFuzzer, which knows what numbers the code compared with.
void mutate_by_fuzzer(Bytes& bytes, std::size_t most) {
  if (bytes.empty()) bytes.resize(1);  // it cannot change nothing
  const std::size_t size = bytes.size();
  bytes.resize(std::max(size, most));
  bytes.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(bytes.data()), size, bytes.size()));
}

void mutate_parts(Rng& rng, TestFile& parts) {
  const auto any = [&] { return rng.below(std::uint32_t(parts.chunks.size())); };
  const auto has = [&](std::uint32_t type) {
    return std::any_of(parts.chunks.begin(), parts.chunks.end(),
                       [&](const TestChunk& c) { return c.type == type; });
  };
  for (std::uint32_t k = 0, n = 1 + rng.below(3) / 2; k < n; ++k) {
    TestChunk& chunk = parts.chunks[any()];
    switch (rng.below(16)) {
      case 0:
        std::swap(chunk, parts.chunks[any()]);
        break;
      case 1:
        if (parts.chunks.size() > 1) parts.chunks.erase(parts.chunks.begin() + any());
        break;
      case 2:
        parts.chunks.insert(parts.chunks.begin() + any(), TestChunk(chunk));
        break;
      case 3:
        chunk.type ^= 1u << rng.below(32);
        break;
      case 4:
        chunk.flags ^= 1u << rng.below(rng.below(2) == 0 ? 1 : 32);
        break;
      case 5:
      case 6:
        mutate_payload(rng, chunk);
        break;
      case 7:
      case 8:
      case 9:
      case 10:
        if (has(kTileChunk) && has(kMembershipChunk)) mutate_deep(rng, parts);
        break;
      case 11: {  // a byte at the edge of what it may be
        constexpr std::uint8_t kEdges[] = {0, 1, 2, 3, 4, 127, 128, 252, 253, 254, 255};
        if (!chunk.stored.empty())
          chunk.stored[rng.below(std::uint32_t(chunk.stored.size()))] =
              std::byte(kEdges[rng.below(std::uint32_t(std::size(kEdges)))]);
        break;
      }
      default:
        mutate_by_fuzzer(chunk.stored, chunk.stored.size() + rng.below(64));
        chunk.decoded_bytes = chunk.stored.size();
        break;
    }
  }
  if (has(kGridChunk) && has(kMembershipChunk) && rng.below(2) == 0) fix_counts(parts);
  for (TestChunk& chunk : parts.chunks) {
    const std::uint32_t kind = rng.below(16);
    if (kind < 2) compress(chunk, 1 + int(rng.below(19)));
    if (kind == 2) split(chunk, 4096, rng.below(2) == 0);
  }
  if (rng.below(32) == 0) {
    TestFile other = parts;
    other.name = "other";
    parts.others.push_back(std::move(other));
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t max_size,
                                               unsigned seed) {
  Rng rng(seed);
  Bytes file = bytes_of(data, size);
  auto parts = rng.below(16) > 0 ? take_apart(file) : std::nullopt;
  if (!parts) {
    mutate_by_fuzzer(file, max_size);
    if (rng.below(4) > 0) reseal_chunks(file);
  } else if (rng.below(4) == 0) {
    std::size_t begin = file.size();
    const auto container = Container::open(file, fuzz::kLimits);
    for (const ChunkInfo& chunk : container->chunks()) begin = std::min(begin, std::size_t(chunk.offset));
    mutate_bytes(rng, file, 0, begin);
    rng.below(2) == 0 ? reseal_chunks(file) : reseal_directory(file);
  } else {
    mutate_parts(rng, *parts);
    file = parts->build();
    // A frame of zstd is changed after it was made, or it would always be a good one.
    if (rng.below(16) == 0) {
      mutate_bytes(rng, file, file.size() / 2, file.size());
      reseal_chunks(file);
    }
  }
  if (file.size() > max_size) return LLVMFuzzerMutate(data, size, max_size);
  std::memcpy(data, file.data(), file.size());
  return file.size();
}

/// One chunk of the first file is replaced by that of the second, or comes from it.
extern "C" std::size_t LLVMFuzzerCustomCrossOver(const std::uint8_t* data, std::size_t size,
                                                 const std::uint8_t* other_data, std::size_t other_size,
                                                 std::uint8_t* out, std::size_t max_size, unsigned seed) {
  auto parts = take_apart(bytes_of(data, size));
  const auto other = take_apart(bytes_of(other_data, other_size));
  if (!parts || !other) return 0;
  Rng rng(seed);
  const TestChunk& chunk = other->chunks[rng.below(std::uint32_t(other->chunks.size()))];
  const auto at = std::find_if(parts->chunks.begin(), parts->chunks.end(),
                               [&](const TestChunk& c) { return c.type == chunk.type; });
  if (at == parts->chunks.end())
    parts->chunks.push_back(chunk);
  else
    *at = chunk;
  const Bytes file = parts->build();
  if (file.size() > max_size) return 0;
  std::memcpy(out, file.data(), file.size());
  return file.size();
}
