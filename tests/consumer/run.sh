#!/bin/bash
# run.sh SOURCE WORK (--installed BUILD | CMAKE_OPTION...)
# Installs what BUILD made, or what the project makes with the options, below WORK, moves it, builds the samples
# against it by find_package and by pkg-config, runs them, and checks what was installed and what they are linked with.
set -euo pipefail
source=$1 work=$2
shift 2
: "${CMAKE:=cmake}" "${CXX:=c++}" "${PKG_CONFIG:=pkg-config}" "${READELF:=readelf}"
[ -n "${CC:-}" ] || CC=cc

fail() {
  echo "FAILED: $*" >&2
  exit 1
}
say() { echo "== $* (${SECONDS} s)"; }

# What only authoring, importing and pictures need.
authoring_only='CGAL|OpenMesh|OpenImageIO|OpenVDB|gmp|mpfr|boost'

rm -rf "$work"
mkdir -p "$work"
say "installing"
if [ "$1" = --installed ]; then
  build=$2
else
  build=$work/build
  "$CMAKE" -S "$source" -B "$build" -DCMAKE_CXX_COMPILER="$CXX" -DCMAKE_BUILD_TYPE=Release -DMESOCELL_TESTS=OFF "$@" \
    >"$work/configure.log" || fail "configure"
  "$CMAKE" --build "$build" --parallel 2 >"$work/build.log" || { cat "$work/build.log"; fail "build"; }
fi
"$CMAKE" --install "$build" --prefix "$work/installed" >"$work/install.log" || fail "install"
# An installation knows no path, so it can be moved.
prefix=$work/moved
mv "$work/installed" "$prefix"
# No pipe into `grep -q` or `head` in this script: they leave early, the writer then dies of SIGPIPE, and pipefail makes
# that a failure, now and then.
libdir=$(find "$prefix" -name 'libmesocell_format.*' -printf '%h' -quit)
[ -f "$libdir/libmesocell_format.a" ] && shared=no || shared=yes
[ -d "$prefix/include/mesocell/sdk/author" ] && authoring=yes || authoring=no

say "checking what is installed: authoring $authoring, shared $shared"
[ -n "$(find "$prefix" -path '*/doc/*' -name LICENSE)" ] || fail "the licence is not installed"
# `a && b` with a test that finds nothing would end the script, so the other way round.
! grep -rlIF -e "$source" -e "$build" -e "$work" "$prefix" || fail "the files above name a folder of the build"
if [ "$authoring" = no ]; then
  ! grep -rlIE "find_dependency\((CGAL|OpenMesh|OpenImageIO)|-l(gmp|mpfr)|CGAL::" "$prefix" ||
    fail "the files above need libraries of authoring"
  ! find "$prefix" | grep -E 'author|membership|/tiles' || fail "parts of authoring are installed"
  ! grep -E '^(CGAL|OpenMesh|OpenImageIO)_DIR|libgmp' "$build/CMakeCache.txt" ||
    fail "the build without authoring looks for the libraries above"
fi
# Every header can be included, and alone, with warnings. They are the same in all builds, so one of them is enough. Those
# that are the first thing in a source are compiled alone by every build, so here all together.
leads_source() {
  local text=$source/${1%.h}.cpp
  [ -f "$text" ] && [ "$(grep -m 1 '^#include' "$text")" = "#include \"$1\"" ]
}
check_header() {
  case $1 in
    *mesocell_loader.h)
      "$CC" -x c -std=c99 -Wall -Wextra -Wpedantic -Werror -fsyntax-only "$1" &&
        "$CXX" -x c++ -std=c++17 -Wall -Wextra -Wpedantic -Werror -fsyntax-only "$1" ;;
    *) "$CXX" -x c++ -std=c++20 -Wall -Wextra -Wshadow -Wconversion -Werror -fsyntax-only -I "$include" \
      -include "$1" /dev/null ;;
  esac || { echo "$1 cannot be included alone" >&2; return 1; }
}
export -f check_header
export CC CXX include=$prefix/include/mesocell
if [ "$build" != "$work/build" ]; then
  alone=()
  while IFS= read -r header; do
    printf '#include "%s"\n' "$header" >>"$work/all_headers.h"
    [[ $header != */mesocell_loader.h ]] && leads_source "$header" || alone+=("$include/$header")
  done < <(find "$include" -name '*.h' -printf '%P\n' | sort)
  printf '%s\0' "$work/all_headers.h" "${alone[@]}" | xargs -0 -P 2 -I{} bash -c 'check_header "{}"' || fail "a header"
fi
# Only the project's own names are exported.
if [ "$shared" = yes ]; then
  for library in "$libdir"/libmesocell_*.so; do
    names=$("$READELF" --dyn-syms --wide "$library" | awk '$7 != "UND" && $5 ~ /GLOBAL|WEAK|UNIQUE/ { print $8 }')
    [ -n "$names" ] || fail "$library exports nothing"
    ! grep -vE '^(mesocell_|_Z(N|NK|TVN|TIN|TSN)8mesocell)' <<<"$names" || fail "$library exports the names above"
  done
fi

# The samples, away from the project's own headers.
cp -r "$source/samples/sdk" "$work/sdk"
cp "$source/samples/load_and_cast.cpp" "$work/"
cp "$source/tests/consumer/make_cube.cpp" "$work/"
wc -l "$work"/sdk/*.c* "$work/load_and_cast.cpp" | awk '$2 != "total" && $1 >= 100 { print $2; bad = 1 } END { exit bad }' ||
  fail "a sample has 100 lines or more"

# check_links PROGRAM ALLOWED: which libraries the program names itself, transitively those of ours.
check_links() {
  local needed
  needed=$(LD_LIBRARY_PATH=$libdir ldd "$1")
  ! grep -q 'not found' <<<"$needed" || fail "$1 does not find: $needed"
  ! grep -E "$2" <<<"$needed" || fail "$1 is linked with the libraries above"
}

# run_samples FOLDER: both casters agree on every asset.
run_samples() (
  cd "$1"
  check_links ./loader_alone "$authoring_only|libmesocell_(format|core|trace)"
  check_links ./load_and_cast "$authoring_only"
  [ "$shared" = no ] || grep -q "$libdir/libmesocell_trace.so" <<<"$(ldd ./load_and_cast)" ||
    fail "it does not use the shared library"
  ./make_cube cube.meso || fail "make_cube"
  # From 0.5 + 2·√3 m down to the top face at 1 m.
  expected="cell 1 of tile 0 at 2.9641 m"
  assets=(cube.meso)
  if [ "$authoring" = yes ]; then
    ./build_asset ball.meso || fail "build_asset"
    ./own_tile foam.meso || fail "own_tile"
    assets+=(ball.meso foam.meso)
    [ ! -x "$prefix/bin/mesocell" ] || "$prefix/bin/mesocell" validate ball.meso || fail "the command finds ball.meso invalid"
  fi
  for asset in "${assets[@]}"; do
    hit=$(./load_and_cast "$asset")
    echo "$asset: $hit"
    [ "$(./loader_alone "$asset")" = "$hit" ] || fail "the loader alone sees something else in $asset"
    [ "$asset" != cube.meso ] || [ "$hit" = "$expected" ] || fail "the cube should give: $expected"
    grep -q '^cell ' <<<"$hit" || fail "the ray misses $asset"
  done
  head -c 100 cube.meso >cut.meso
  local code=0
  ./loader_alone cut.meso 2>message || code=$?
  [ "$code" = 3 ] && [ -s message ] || fail "a file cut short gives exit code $code"
)

say "find_package"
# The samples' own project, with one more program and every warning.
cat >>"$work/sdk/CMakeLists.txt" <<'END'
add_executable(make_cube ../make_cube.cpp)
target_link_libraries(make_cube PRIVATE mesocell::format)
END
configure=("$CMAKE" -B "$work/cmake" -DCMAKE_C_COMPILER="$CC" -DCMAKE_CXX_COMPILER="$CXX" -DCMAKE_BUILD_TYPE=Release
  -DCMAKE_PREFIX_PATH="$prefix" -DCMAKE_C_FLAGS="-Wall -Wextra -Werror" -DCMAKE_CXX_FLAGS="-Wall -Wextra -Werror")
"${configure[@]}" -S "$work/sdk" >"$work/cmake.log" || fail "find_package"
"$CMAKE" --build "$work/cmake" --verbose --parallel 2 >"$work/cmake-build.log" 2>&1 ||
  { cat "$work/cmake-build.log"; fail "the samples do not build"; }
# The runtime's users do not see authoring's libraries even where it is installed.
! grep -E -- '-o (loader_alone|load_and_cast|make_cube) ' "$work/cmake-build.log" | grep -E "$authoring_only" ||
  fail "the link lines above name authoring's libraries"
run_samples "$work/cmake"

if [ "$authoring" = no ]; then
  mkdir "$work/missing"
  printf '%s\n' 'cmake_minimum_required(VERSION 3.23)' 'project(missing LANGUAGES CXX)' \
    'find_package(mesocell REQUIRED COMPONENTS authoring)' >"$work/missing/CMakeLists.txt"
  ! "$CMAKE" -S "$work/missing" -B "$work/missing/build" -DCMAKE_PREFIX_PATH="$prefix" >"$work/missing.log" 2>&1 ||
    fail "a component that is not installed was found"
  grep -q "The component 'authoring' is not installed" <<<"$(tr -s '\n ' ' ' <"$work/missing.log")" ||
    fail "the message does not name the missing component"
fi

say "pkg-config"
export PKG_CONFIG_PATH=$libdir/pkgconfig
mkdir "$work/pkg"
# build_with PACKAGE PROGRAM SOURCE
build_with() {
  local flags libs object=$work/pkg/$2.o
  flags=$("$PKG_CONFIG" --cflags "$1") && libs=$("$PKG_CONFIG" --libs "$1") || fail "pkg-config $1"
  # Words are what pkg-config means to give.
  # shellcheck disable=SC2086
  case $3 in
    *.c) "$CC" -std=c99 -O1 $flags -c "$3" -o "$object" && "$CC" "$object" $libs -lm -Wl,-rpath,"$libdir" -o "$work/pkg/$2" ;;
    *) "$CXX" -std=c++20 -O1 $flags -c "$3" -o "$object" && "$CXX" "$object" $libs -Wl,-rpath,"$libdir" -o "$work/pkg/$2" ;;
  esac || fail "$2 does not build by pkg-config $1"
}
build_with mesocell-loader loader_alone "$work/sdk/loader_alone.c"
build_with mesocell load_and_cast "$work/load_and_cast.cpp"
build_with mesocell make_cube "$work/make_cube.cpp"
if [ "$authoring" = yes ]; then
  build_with mesocell-authoring build_asset "$work/sdk/build_asset.cpp"
  build_with mesocell-authoring own_tile "$work/sdk/own_tile.cpp"
fi
run_samples "$work/pkg"
say "done"
