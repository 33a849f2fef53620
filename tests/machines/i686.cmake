# 32-bit x86, which x86-64 runs as it is. SSE does the arithmetic: x87 would round to 80 bits, and files would depend on
# the machine.
set(CMAKE_SYSTEM_PROCESSOR i686)
set(MESOCELL_TRIPLE i686-linux-gnu)
set(CMAKE_CXX_FLAGS_INIT "-msse2 -mfpmath=sse")
include(${CMAKE_CURRENT_LIST_DIR}/debian_cross.cmake)
set(CMAKE_CROSSCOMPILING_EMULATOR
  "/usr/${MESOCELL_TRIPLE}/lib/ld-linux.so.2;--library-path;/usr/${MESOCELL_TRIPLE}/lib" CACHE STRING "")
