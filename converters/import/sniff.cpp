#include "converters/import/sniff.h"

#include <array>

namespace mesocell {
namespace {

struct Signature {
  std::string_view begins, name;
};

using namespace std::string_view_literals;

constexpr std::array<Signature, 18> kSignatures = {{
    {"\x89MESO\r\n\x1a", "a .meso file"},
    {"ply\n", "a PLY mesh"},
    {"ply\r", "a PLY mesh"},
    {"OFF", "an OFF mesh"},
    {"COFF", "an OFF mesh"},
    {"NOFF", "an OFF mesh"},
    {"glTF", "a glTF scene"},
    {"Kaydara FBX", "an FBX scene"},
    {"BLENDER", "a Blender scene"},
    {"\x89PNG", "a PNG image"},
    {"\xff\xd8\xff", "a JPEG image"},
    {"\x76\x2f\x31\x01", "an OpenEXR image"},
    {"GIF8", "a GIF image"},
    {"PK\x03\x04", "a zip archive"},
    {"\x1f\x8b", "a gzip archive"},
    {"%PDF", "a PDF document"},
    {"\x7f"
     "ELF",
     "a program"},
    {"<", "an XML or HTML document"},
}};

}  // namespace

std::string_view sniff_content(std::string_view bytes) {
  for (const Signature& s : kSignatures)
    if (bytes.substr(0, s.begins.size()) == s.begins) return s.name;
  return {};
}

}  // namespace mesocell
