#include "tests/import/picture_bytes.h"

#include <algorithm>
#include <map>

namespace mesocell::test {
namespace {

void put(std::string& out, std::uint64_t value, std::size_t bytes, bool big) {
  for (std::size_t k = 0; k < bytes; ++k) out += char(std::uint8_t(value >> (8 * (big ? bytes - 1 - k : k))));
}

/// zlib's format with blocks that are stored as they are [RFC 1950, 1951].
std::string zlib_stored(const std::string& data) {
  std::string out = "\x78\x01";
  for (std::size_t at = 0; at == 0 || at < data.size(); at += 65535) {
    const std::size_t n = std::min<std::size_t>(data.size() - at, 65535);
    out += char(at + n == data.size());
    put(out, n, 2, false);
    put(out, ~n & 0xffff, 2, false);
    out += data.substr(at, n);
  }
  std::uint32_t a = 1, b = 0;
  for (const char c : data) {
    a = (a + std::uint8_t(c)) % 65521;
    b = (b + a) % 65521;
  }
  put(out, b << 16 | a, 4, true);
  return out;
}

/// Literal runs, none of which crosses the end of a row.
std::string pack_bits(const std::string& data, std::size_t row_bytes) {
  std::string out;
  for (std::size_t at = 0; at < data.size();) {
    const std::string run = data.substr(at, std::min<std::size_t>(128, row_bytes - at % row_bytes));
    out += char(run.size() - 1);
    out += run;
    at += run.size();
  }
  return out;
}

/// LZW of literals alone, each as a code of 9 bits; the table is cleared before longer codes are due
/// [TIFF 6.0, 13].
std::string lzw_literals(const std::string& data) {
  std::vector<std::uint32_t> codes;
  for (std::size_t at = 0; at < data.size(); ++at) {
    if (at % 200 == 0) codes.push_back(256);
    codes.push_back(std::uint8_t(data[at]));
  }
  codes.push_back(257);
  std::string out;
  std::uint32_t buffer = 0, bits = 0;
  for (const std::uint32_t code : codes) {
    buffer = buffer << 9 | code;
    for (bits += 9; bits >= 8; bits -= 8) out += char(std::uint8_t(buffer >> (bits - 8)));
  }
  return out + char(std::uint8_t(buffer << (8 - bits)));
}

/// Samples in so many bits each; a row begins with a new byte.
std::string pack_rows(const std::vector<std::uint32_t>& samples, std::size_t row_samples, unsigned bits,
                      bool big) {
  std::string out;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    if (bits >= 8) {
      put(out, samples[i], bits / 8, big);
      continue;
    }
    const std::size_t at = i % row_samples * bits % 8;
    if (at == 0) out += '\0';
    out.back() = char(std::uint8_t(out.back()) | samples[i] << (8 - bits - at));
  }
  return out;
}

std::string png_chunk(const std::string& type, const std::string& data) {
  std::string out, body = type + data;
  put(out, data.size(), 4, true);
  std::uint32_t crc = ~0u;
  for (const char c : body) {
    crc ^= std::uint8_t(c);
    for (int k = 0; k < 8; ++k) crc = crc >> 1 ^ (crc & 1 ? 0xedb88320u : 0u);
  }
  put(body, ~crc, 4, true);
  return out + body;
}

struct Rectangle {
  std::uint32_t x, y, width, height;
};

/// The samples of a rectangle, zero beyond the picture, of channels `first` up to but without `end`.
std::vector<std::uint32_t> cut(const PlainPicture& p, const Rectangle& r, std::uint32_t first,
                               std::uint32_t end) {
  std::vector<std::uint32_t> samples;
  for (std::uint32_t y = r.y; y < r.y + r.height; ++y)
    for (std::uint32_t x = r.x; x < r.x + r.width; ++x)
      for (std::uint32_t c = first; c < end; ++c)
        samples.push_back(x < p.width && y < p.height ? p.samples[(y * p.width + x) * p.channels + c] : 0);
  return samples;
}

}  // namespace

std::string png_bytes(const PlainPicture& p, const PngOptions& options) {
  std::string header;
  put(header, p.width, 4, true);
  put(header, p.height, 4, true);
  header += char(options.bits);
  const unsigned types[] = {0, 4, 2, 6};
  header += char(options.color_type.value_or(types[p.channels - 1]));
  header += std::string(3, '\0');
  const std::size_t row = std::size_t{p.width} * p.channels;
  const std::string rows = pack_rows(p.samples, row, options.bits, true);
  const std::size_t row_bytes = (row * options.bits + 7) / 8;
  std::string filtered;
  for (std::uint32_t y = 0; y < p.height; ++y) filtered += '\0' + rows.substr(y * row_bytes, row_bytes);
  std::string out = "\x89PNG\r\n\x1a\n" + png_chunk("IHDR", header);
  if (options.gamma) {
    std::string gamma;
    put(gamma, options.gamma, 4, true);
    out += png_chunk("gAMA", gamma);
  }
  if (!options.palette.empty())
    out += png_chunk("PLTE", std::string(options.palette.begin(), options.palette.end()));
  return out + png_chunk("IDAT", zlib_stored(filtered)) + png_chunk("IEND", "");
}

std::string tiff_bytes(const std::vector<PlainPicture>& pages, const TiffOptions& options) {
  const bool big = options.big_endian;
  const std::size_t offset_bytes = options.big_tiff ? 8 : 4;
  std::string out = big ? "MM" : "II";
  put(out, options.big_tiff ? 43 : 42, 2, big);
  if (options.big_tiff) {
    put(out, 8, 2, big);
    put(out, 0, 2, big);
  }
  std::size_t link = out.size();
  put(out, 0, offset_bytes, big);
  const auto set_link = [&](std::size_t to) {
    std::string bytes;
    put(bytes, to, offset_bytes, big);
    out.replace(link, offset_bytes, bytes);
  };
  for (const PlainPicture& p : pages) {
    std::vector<std::uint32_t> offsets, sizes;
    const std::uint32_t rows = options.tile             ? options.tile
                               : options.rows_per_strip ? options.rows_per_strip
                                                        : p.height;
    const std::uint32_t columns = options.tile ? options.tile : p.width;
    for (std::uint32_t plane = 0; plane < (options.separate ? p.channels : 1); ++plane)
      for (std::uint32_t y = 0; y < p.height; y += rows)
        for (std::uint32_t x = 0; x < p.width; x += columns) {
          const std::uint32_t height = options.tile ? rows : std::min(rows, p.height - y);
          const std::uint32_t first = options.separate ? plane : 0,
                              end = options.separate ? plane + 1 : p.channels;
          std::string piece = pack_rows(cut(p, {x, y, columns, height}, first, end),
                                        std::size_t{columns} * (end - first), options.bits, big);
          if (options.compression == 5) piece = lzw_literals(piece);
          if (options.compression == 8) piece = zlib_stored(piece);
          if (options.compression == 32773) piece = pack_bits(piece, piece.size() / height);
          offsets.push_back(std::uint32_t(out.size()));
          sizes.push_back(std::uint32_t(piece.size()));
          out += piece + std::string(piece.size() % 2, '\0');
        }
    std::map<unsigned, std::vector<std::uint32_t>> tags = {
        {256, {p.width}},
        {257, {p.height}},
        {258, std::vector<std::uint32_t>(p.channels, options.bits)},
        {259, {options.compression}},
        {262, {options.photometric.value_or(p.channels < 3 ? 1u : 2u)}},
        {277, {p.channels}},
        {284, {options.separate ? 2u : 1u}},
        {339, std::vector<std::uint32_t>(p.channels, options.format)},
    };
    if (p.channels % 2 == 0) tags[338] = {2};
    tags[options.tile ? 324 : 273] = offsets;
    tags[options.tile ? 325 : 279] = sizes;
    if (options.tile) {
      tags[322] = tags[323] = {options.tile};
    } else {
      tags[278] = {rows};
    }
    for (const auto& [tag, values] : options.tags) {
      tags[tag] = values;
      if (values.empty()) tags.erase(tag);
    }
    std::string directory;
    put(directory, tags.size(), options.big_tiff ? 8 : 2, big);
    for (const auto& [tag, values] : tags) {
      // Offsets and sizes are LONG, all else SHORT.
      const bool wide = tag == 273 || tag == 279 || tag == 324 || tag == 325 || tag == 256;
      put(directory, tag, 2, big);
      put(directory, wide ? 4 : 3, 2, big);
      put(directory, values.size(), offset_bytes, big);
      std::string bytes;
      for (const std::uint32_t value : values) put(bytes, value, wide ? 4 : 2, big);
      if (bytes.size() > offset_bytes) {
        const std::size_t at = out.size();
        out += bytes + std::string(bytes.size() % 2, '\0');
        bytes.clear();
        put(bytes, at, offset_bytes, big);
      }
      bytes.resize(offset_bytes);
      directory += bytes;
    }
    set_link(out.size());
    out += directory;
    link = out.size();
    put(out, 0, offset_bytes, big);
  }
  return out;
}

std::string hdr_bytes(const PlainPicture& p) {
  std::string out = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y " + std::to_string(p.height) + " +X " +
                    std::to_string(p.width) + "\n";
  for (const std::uint32_t sample : p.samples) out += char(std::uint8_t(sample));
  return out;
}

}  // namespace mesocell::test
