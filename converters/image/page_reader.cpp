#include "converters/image/page_reader.h"

#include <array>
#include <cassert>
#include <exception>

#include "converters/image/image_module_access.h"

namespace mesocell {
namespace {

constexpr std::uint64_t kMaxTileBytes = std::uint64_t{1} << 28;

struct Reading {
  const PageSink* sink;
  Status refusal = Error{ErrorCode::kLimit, "its tiles are too large to be read; save it without tiles"};
  std::vector<std::uint32_t> samples = {};
};

/// Calls the sink for the module, through which no exception may pass; false if it refused.
template <typename Body>
bool guarded(Reading& reading, const Body& body) {
  const Error no_memory{ErrorCode::kLimit, "there is not enough memory to read it; use a smaller one"};
  try {
    Status status = body();
    if (status) return true;
    reading.refusal = std::move(status);
  } catch (const std::exception&) {
    reading.refusal = no_memory;
  }
  return false;
}

void* make_room(void* context, const MesocellPagesHeader* header) {
  Reading& reading = *static_cast<Reading*>(context);
  const bool accepted = guarded(reading, [&]() -> Status {
    PageHeader page;
    page.width = header->width;
    page.height = header->height;
    page.channels.assign(header->channel_names, header->channel_names + header->channel_count);
    page.is_float = header->type == kMesocellSampleFloat;
    page.bits = header->bits;
    page.encoding = header->srgb ? ImageEncoding::kSrgb : ImageEncoding::kLinear;
    page.exact = header->exact != 0;
    if (Status status = reading.sink->begin(page); !status) return status;
    reading.samples.resize(std::size_t{page.width} * page.height * page.channels.size());
    return {};
  });
  return accepted ? reading.samples.data() : nullptr;
}

int take(void* context, std::uint32_t page) {
  Reading& reading = *static_cast<Reading*>(context);
  return guarded(reading, [&] { return reading.sink->take(page, reading.samples); }) ? 0 : 1;
}

}  // namespace

Status read_pages(const std::string& path, const char* format, std::uint32_t page_count,
                  const PageSink& sink) {
  assert(page_count > 0 && (!sink.first_only || page_count == 1));
  const Result<ImageModule>& module = image_module();
  if (!module) return Error{ErrorCode::kUnreadable, module.error().message};
  Reading reading{&sink};
  const MesocellPageReader reader{&reading, sink.as_floats ? 1u : 0u, sink.first_only ? 1u : 0u, make_room, take};
  std::array<char, 512> message{};
  const int status = module->read_pages(path.c_str(), format, page_count, kMaxTileBytes, &reader,
                                        message.data(), message.size());
  if (status == kMesocellReadRefused) return reading.refusal;
  if (status != kMesocellReadDone)
    return Error{ErrorCode::kInvalidInput,
                 std::string("it cannot be read (") + message.data() + "); check that it is whole"};
  return {};
}

}  // namespace mesocell
