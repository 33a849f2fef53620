#include "converters/import/sniff.h"

#include <array>

namespace mesocell {
namespace {

struct Signature {
  std::string_view begins, name;
};

using namespace std::string_view_literals;

constexpr std::array<Signature, 36> kSignatures = {{
    {"\x89MESO\r\n\x1a", "a .meso file"},
    {"ply\n", kPlyContent},
    {"ply\r", kPlyContent},
    {"glTF", kGlbContent},
    {"DRACO", kDracoContent},
    {"Kaydara FBX", "an FBX scene"},
    {"BLENDER", "a Blender scene"},
    {"ISO-10303-21", "a STEP model"},
    {"#VRML", "a VRML scene"},
    {"PXR-USDC", "a USD scene"},
    {"#usda", "a USD scene"},
    {" BDV\0\0\0\0"sv, "an OpenVDB volume"},
    {"NanoVDB", "a NanoVDB volume"},
    {"#INRIMAGE-4", "an INRIMAGE volume"},
    {"NRRD000", "an NRRD volume"},
    {"# vtk DataFile", "a VTK data set"},
    {"\x89PNG", "a PNG image"},
    {"\xff\xd8\xff", "a JPEG image"},
    {"\x76\x2f\x31\x01", kExrContent},
    {"#?RADIANCE", kHdrContent},
    {"#?RGBE", kHdrContent},
    {"DDS ", "a DDS texture"},
    {"\xabKTX ", "a KTX texture"},
    {"II*\0"sv, kTiffContent},
    {"MM\0*"sv, kTiffContent},
    {"II+\0"sv, kTiffContent},
    {"MM\0+"sv, kTiffContent},
    {"GIF8", "a GIF image"},
    {"\0\0\0\x0cjP  "sv, "a JPEG 2000 image"},
    {"PK\x03\x04", "a zip archive"},
    {"\x1f\x8b", "a gzip archive"},
    {"7z\xbc\xaf", "a 7z archive"},
    {"%PDF", "a PDF document"},
    {"\x7f"
     "ELF",
     "a program"},
    {"<", "an XML or HTML document"},
    {"\xef\xbb\xbf<", "an XML or HTML document"},
}};

bool is_space(char c) { return c == ' ' || c == '\t' || c == '\n' || c == '\r'; }

/// The keyword of an OFF file: [ST][C][N][4][n]OFF.
bool is_off(std::string_view bytes) {
  for (const std::string_view part : {"ST"sv, "C"sv, "N"sv, "4"sv, "n"sv})
    if (bytes.starts_with(part)) bytes.remove_prefix(part.size());
  return bytes.starts_with("OFF") && (bytes.size() == 3 || is_space(bytes[3]) || bytes[3] == '#');
}

/// A JSON object that has an "asset" early or late.
bool is_gltf_json(std::string_view bytes) {
  if (bytes.starts_with("\xef\xbb\xbf")) bytes.remove_prefix(3);
  while (!bytes.empty() && is_space(bytes.front())) bytes.remove_prefix(1);
  return bytes.starts_with("{") && bytes.find("\"asset\"") != bytes.npos;
}

/// A text of "key = value", which may begin with either of two keys [MetaIO].
bool is_meta_image(std::string_view bytes) {
  for (const std::string_view key : {"ObjectType"sv, "NDims"sv})
    if (bytes.starts_with(key)) {
      bytes.remove_prefix(key.size());
      return bytes.substr(0, bytes.find_first_not_of(' ') + 1).ends_with('=');
    }
  return false;
}

/// The size of a BMP's second header tells it from a text that begins with BM.
bool is_bmp(std::string_view bytes) {
  return bytes.starts_with("BM") && bytes.size() >= 18 && bytes.substr(15, 3) == "\0\0\0"sv &&
         (bytes[14] == 12 || bytes[14] == 40 || bytes[14] == 56 || bytes[14] == 108 || bytes[14] == 124);
}

}  // namespace

std::string_view sniff_content(std::string_view bytes) {
  for (const Signature& s : kSignatures)
    if (bytes.starts_with(s.begins)) return s.name;
  if (is_off(bytes)) return kOffContent;
  if (is_meta_image(bytes)) return "a MetaImage volume";
  if (is_bmp(bytes)) return "a BMP image";
  if (is_gltf_json(bytes)) return kGltfContent;
  return {};
}

}  // namespace mesocell
