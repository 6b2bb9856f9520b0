#!/bin/sh
# folders.sh CMAKE SOURCE: folders of the installed files that are given whole, as distributions do that have one for each package.
set -eu
cmake=$1 source=$2
command -v pkg-config >/dev/null || { echo "skipped: no pkg-config"; exit 77; }
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
"$cmake" -S "$source" -B "$folder/build" -DPBF_BACKENDS=reference -DPBF_VARIANTS=2d-f32 -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_TESTS=OFF \
  -DPBF_BUILD_EXAMPLES=OFF -DCMAKE_BUILD_TYPE=Debug -DCMAKE_DEBUG_POSTFIX=_debug "-DCMAKE_INSTALL_PREFIX=$folder/prefix" \
  "-DCMAKE_INSTALL_LIBDIR=$folder/libraries/lib" "-DCMAKE_INSTALL_INCLUDEDIR=$folder/headers/include" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
said=$(PKG_CONFIG_PATH=$folder/build pkg-config --cflags --libs pbf)
expected="-I$folder/headers/include -L$folder/libraries/lib -lpbf_debug "
[ "${said% } " = "$expected" ] || { echo "pbf.pc says '$said', not '$expected'" >&2; exit 1; }
