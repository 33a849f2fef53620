# What the toolchain files share: Debian's cross compiler for MESOCELL_TRIPLE, and zstd, xxHash and Catch2 for that
# machine, which tests/machines/run unpacks into a folder of the build.
set(CMAKE_SYSTEM_NAME Linux)
set(CMAKE_CXX_COMPILER ${MESOCELL_TRIPLE}-g++)
cmake_path(SET MESOCELL_SYSROOT NORMALIZE
  ${CMAKE_CURRENT_LIST_DIR}/../../build-${CMAKE_SYSTEM_PROCESSOR}/packages)
set(CMAKE_FIND_ROOT_PATH ${MESOCELL_SYSROOT})
set(CMAKE_FIND_ROOT_PATH_MODE_PROGRAM NEVER)
set(CMAKE_FIND_ROOT_PATH_MODE_LIBRARY ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_INCLUDE ONLY)
set(CMAKE_FIND_ROOT_PATH_MODE_PACKAGE ONLY)
