#include "converters/import/sniff.h"

#include <array>

namespace mesocell {
namespace {

struct Signature {
  std::string_view begins, name;
};

using namespace std::string_view_literals;

constexpr std::string_view kUsgsContent = "a USGS digital elevation model", kLasContent = "a LAS point cloud",
                           kAsciiGridContent = "an ESRI ASCII grid", kSrtmContent = "an SRTM height tile",
                           kDtedContent = "a DTED height tile", kTerragenContent = "a Terragen terrain",
                           kBtContent = "a VTP binary terrain", kSurferContent = "a Surfer grid",
                           kNetCdfContent = "a netCDF data set", kHdfContent = "an HDF5 data set",
                           kErdasContent = "an ERDAS Imagine raster";

constexpr std::array<Signature, 47> kSignatures = {{
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
    {"LASF", kLasContent},
    {"UHL1", kDtedContent},
    {"TERRAGENTERRAIN ", kTerragenContent},
    {"binterr1.", kBtContent},
    {"DSAA", kSurferContent},
    {"DSBB", kSurferContent},
    {"DSRB", kSurferContent},
    {"CDF\x01", kNetCdfContent},
    {"CDF\x02", kNetCdfContent},
    {"\x89HDF\r\n\x1a\n", kHdfContent},
    {"EHFA_HEADER_TAG", kErdasContent},
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

/// A whole number of 6 characters, as Fortran writes them; -1 if it is none.
int fortran_integer(std::string_view bytes, std::size_t at) {
  int n = 0;
  bool digits = false;
  for (const char c : bytes.substr(at, 6)) {
    if (c == ' ' && !digits) continue;
    if (c < '0' || c > '9') return -1;
    n = 10 * n + (c - '0');
    digits = true;
  }
  return digits ? n : -1;
}

/// The first record has no mark, but numbers at fixed places: level, pattern, system of reference; units on
/// the ground and of heights, and the four sides of the area [USGS, Standards for Digital Elevation Models
/// 2].
bool is_usgs(std::string_view bytes) {
  if (bytes.size() < 864) return false;
  for (const char c : bytes.substr(0, 864))
    if (c != '\n' && c != '\r' && (c < ' ' || c > '~')) return false;
  const int level = fortran_integer(bytes, 144), pattern = fortran_integer(bytes, 150);
  const int reference = fortran_integer(bytes, 156), ground = fortran_integer(bytes, 528);
  const int heights = fortran_integer(bytes, 534), sides = fortran_integer(bytes, 540);
  return level >= 1 && level <= 4 && pattern >= 1 && pattern <= 2 && reference >= 0 && reference <= 20 &&
         ground >= 0 && ground <= 3 && heights >= 1 && heights <= 2 && sides == 4;
}

/// Begins with "ncols 253", in any case.
bool is_ascii_grid(std::string_view bytes) {
  constexpr std::string_view kKey = "ncols";
  while (!bytes.empty() && is_space(bytes.front())) bytes.remove_prefix(1);
  if (bytes.size() <= kKey.size() || !is_space(bytes[kKey.size()])) return false;
  for (std::size_t i = 0; i < kKey.size(); ++i)
    if ((bytes[i] | 0x20) != kKey[i]) return false;
  const std::size_t number = bytes.find_first_not_of(" \t", kKey.size());
  return number != bytes.npos && bytes[number] >= '0' && bytes[number] <= '9';
}

}  // namespace

std::string_view sniff_name(std::string_view extension, std::uint64_t bytes) {
  // Squares of one or three seconds of arc, and what there is of the former beyond 50 degrees; 16 bits.
  const bool size = bytes == 2 * 1201 * 1201 || bytes == 2 * 3601 * 3601 || bytes == 2 * 3601 * 1801;
  return extension == ".hgt" && size ? kSrtmContent : std::string_view();
}

std::string_view terrain_remedy(std::string_view content) {
  if (content == kLasContent)
    return "make a mesh of its points, or a picture of their heights (PDAL does both)";
  for (const std::string_view grid :
       {kUsgsContent, kAsciiGridContent, kSrtmContent, kDtedContent, kTerragenContent, kBtContent,
        kSurferContent, kNetCdfContent, kHdfContent, kErdasContent})
    if (content == grid)
      return "convert it to a TIFF, a 16-bit PNG or an EXR, for example by gdal_translate FILE heights.tif";
  return {};
}

std::string_view sniff_content(std::string_view bytes) {
  for (const Signature& s : kSignatures)
    if (bytes.starts_with(s.begins)) return s.name;
  if (is_off(bytes)) return kOffContent;
  if (is_meta_image(bytes)) return "a MetaImage volume";
  if (is_bmp(bytes)) return "a BMP image";
  if (is_ascii_grid(bytes)) return kAsciiGridContent;
  if (is_usgs(bytes)) return kUsgsContent;
  if (is_gltf_json(bytes)) return kGltfContent;
  return {};
}

}  // namespace mesocell
