#include "converters/image/image_module_access.h"

#include "converters/image/module_loader.h"

namespace mesocell {

const Result<ImageModule>& image_module() {
  static const Result<ImageModule> loaded = []() -> Result<ImageModule> {
    const Result<void*> module = load_module("mesocell_image");
    if (!module) return module.error();
    const auto version =
        reinterpret_cast<MesocellImageModuleVersion>(find_function(*module, "mesocell_image_module_version"));
    const auto encode =
        reinterpret_cast<MesocellEncodeImage>(find_function(*module, "mesocell_encode_image"));
    const auto read = reinterpret_cast<MesocellReadImage>(find_function(*module, "mesocell_read_image"));
    const auto read_pages =
        reinterpret_cast<MesocellReadPages>(find_function(*module, "mesocell_read_pages"));
    if (!version || !encode || !read || !read_pages || version() != MESOCELL_IMAGE_MODULE_VERSION)
      return Error{ErrorCode::kOutput,
                   "the image module is of another version; install the one of this program"};
    return ImageModule{encode, read, read_pages};
  }();
  return loaded;
}

}  // namespace mesocell
