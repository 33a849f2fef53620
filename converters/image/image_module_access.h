#pragma once

#include "converters/image/image_module.h"
#include "format/result.h"

namespace mesocell {

/// The functions of the image module.
struct ImageModule {
  MesocellEncodeImage encode;
  MesocellReadImage read;
  MesocellReadPages read_pages;
};

/// Loads the module when it is first asked for. Errors: kOutput.
[[nodiscard]] const Result<ImageModule>& image_module();

}  // namespace mesocell
