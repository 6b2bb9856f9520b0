#!/bin/sh
# folders.sh CMAKE SOURCE: what the files for other projects say, of builds that are configured alone: folders that are given whole,
# as distributions do that have one for each package; and OpenMP in a project of C++ alone.
set -eu
cmake=$1 source=$2
command -v pkg-config >/dev/null || { echo "skipped: no pkg-config"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
configure() { # name, options
  name=$1
  shift
  "$cmake" -S "$source" -B "$folder/$name" -DPBF_VARIANTS=2d-f32 -DPBF_ISAS=scalar -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_TESTS=OFF \
    -DPBF_BUILD_EXAMPLES=OFF "$@" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
}
configure shared -DPBF_BACKENDS=reference -DCMAKE_BUILD_TYPE=Debug -DCMAKE_DEBUG_POSTFIX=_debug "-DCMAKE_INSTALL_PREFIX=$folder/prefix" \
  "-DCMAKE_INSTALL_LIBDIR=$folder/libraries/lib" "-DCMAKE_INSTALL_INCLUDEDIR=$folder/headers/include"
said=$(PKG_CONFIG_PATH=$folder/shared pkg-config --cflags --libs pbf)
expected="-I$folder/headers/include -L$folder/libraries/lib -lpbf_debug "
[ "${said% } " = "$expected" ] || { echo "pbf.pc says '$said', not '$expected'" >&2; exit 1; }

configure static -DPBF_BACKENDS=openmp -DPBF_STATIC=ON
mkdir -p "$folder/lib/cmake/pbf" "$folder/project"
cp "$folder/static/pbfConfig.cmake" "$folder/lib/cmake/pbf"
cat >"$folder/lib/cmake/pbf/pbfTargets.cmake" <<'END'
add_library(pbf::pbf STATIC IMPORTED)
set_target_properties(pbf::pbf PROPERTIES IMPORTED_CONFIGURATIONS RELEASE INTERFACE_LINK_LIBRARIES OpenMP::OpenMP_C)
END
cat >"$folder/project/CMakeLists.txt" <<'END'
cmake_minimum_required(VERSION 3.25)
project(cxx_alone LANGUAGES CXX)
find_package(pbf REQUIRED)
get_target_property(links OpenMP::OpenMP_C INTERFACE_LINK_LIBRARIES)
if(NOT links)
  message(FATAL_ERROR "OpenMP's library is not linked")
endif()
END
"$cmake" -S "$folder/project" -B "$folder/project/build" "-Dpbf_DIR=$folder/lib/cmake/pbf" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
