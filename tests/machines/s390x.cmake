# A big-endian machine of 64 bits, by emulation.
set(CMAKE_SYSTEM_PROCESSOR s390x)
set(MESOCELL_TRIPLE s390x-linux-gnu)
include(${CMAKE_CURRENT_LIST_DIR}/debian_cross.cmake)
set(CMAKE_CROSSCOMPILING_EMULATOR "qemu-s390x;-L;/usr/${MESOCELL_TRIPLE}" CACHE STRING "")
