#include "tests/conformance/cases.h"
#include "tests/conformance/files.h"

/// MESH, which version 1.1 brought. [spec 4.10]
namespace mesocell::test {
namespace {

using std::to_string;

TestFile with_mesh(std::size_t bytes) {
  CellObject object = tiny_object();
  BasicMesh& mesh = object.basic_mesh.emplace();
  for (std::size_t i = 0; i < bytes; ++i) mesh.draco.push_back(std::byte(i * 7));
  mesh.vertices = 8;
  mesh.triangles = 12;
  mesh.max_error = 0.125f;
  return TestFile::of(object);
}

}  // namespace

void add_mesh_cases(CaseList& cases) {
  const TestFile parts = with_mesh(100);
  for (const std::size_t bytes : {0u, 1u, 64u, 100u, 5000u})
    cases.valid("mesh/" + to_string(bytes) + "-bytes", "4.10", with_mesh(bytes).build());
  add_chunk_header_cases(cases, parts, kBasicMeshChunk, 24);
  add_stated_error_cases(cases, parts, kBasicMeshChunk, 4, "4.10");
  for (unsigned bit = 0; bit < 32; bit += 5)
    cases.fault("mesh-encoding/bit-" + to_string(bit), with_bit(parts, kBasicMeshChunk, 0, bit));
  for (unsigned bit = 0; bit < 64; bit += 7)
    cases.fault("mesh-bytes/bit-" + to_string(bit), with_bit(parts, kBasicMeshChunk, 8, bit));
  for (const std::size_t bytes : {64u, 65u, 163u, 165u, 228u})
    cases.fault("mesh-bytes/of-" + to_string(bytes), with_size(parts, kBasicMeshChunk, bytes));
  for (const std::uint32_t count : {0u, 1u, 2u, 0x80000000u, 0xffffffffu})
    cases.fault("mesh-counts/vertices-" + to_string(count), with(parts, kBasicMeshChunk, 16, count));
  for (const std::uint32_t count : {0u, 0x80000000u, 0xffffffffu})
    cases.fault("mesh-counts/triangles-" + to_string(count), with(parts, kBasicMeshChunk, 20, count));
  for (const std::uint32_t count : {3u, 0x7fffffffu})
    cases.valid("mesh/vertices-" + to_string(count), "4.10", with(parts, kBasicMeshChunk, 16, count));
  for (const std::uint32_t count : {1u, 0x7fffffffu})
    cases.valid("mesh/triangles-" + to_string(count), "4.10", with(parts, kBasicMeshChunk, 20, count));
  TestFile critical = parts;
  critical.chunk(kBasicMeshChunk).flags = 1;
  cases.fault("chunk-criticality/mesh", critical.build());
  TestFile packed = with_mesh(5000);
  compress(packed.chunk(kBasicMeshChunk));
  cases.valid("mesh/compressed", "4.10", packed.build());
  // In a file of 1.0 the type is unknown, and what the chunk holds is nobody's business.
  TestFile older = parts;
  older.minor = 0;
  cases.valid("mesh/in-1-0", "5", older.build(), "chunk-unknown-skippable");
  cases.valid("mesh/in-1-0-of-another-size", "5", with_size(older, kBasicMeshChunk, 3),
              "chunk-unknown-skippable");
  older.chunk(kBasicMeshChunk).flags = 1;
  cases.fault("chunk-unknown-critical/mesh-in-1-0", older.build());
}

}  // namespace mesocell::test
