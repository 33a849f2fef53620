#pragma once

/// Marks the namespace in every installed header: what it declares is exported by shared libraries, all else
/// is hidden.
#if defined(__GNUC__)
#define MESOCELL_API __attribute__((visibility("default")))
#else
#define MESOCELL_API
#endif

/// Marks it in a header that is not installed and that another of the project's libraries needs.
#define MESOCELL_INTERNAL_API MESOCELL_API
