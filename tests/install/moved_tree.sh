#!/bin/sh
# moved_tree.sh CMAKE BUILD CONSUMER
set -eu
cmake=$1 build=$2 consumer=$3
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
unset PBF_BACKEND_PATH LD_LIBRARY_PATH PKG_CONFIG_PATH 2>/dev/null || true

# Not through ninja: what the tests have not built is not installed, and nothing is built here.
"$cmake" --install "$build" --prefix "$folder/first" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }
moved="$folder/to a [folder] élsewhere"
mv "$folder/first" "$moved"
cd "$folder"
if grep -rlF --include='*.cmake' --include='*.pc' -e "$folder/first" -e "$build" "$moved"; then
  echo "these files name where the tree was built or installed" >&2
  exit 1
fi
for file in LICENSE THIRD_PARTY_NOTICES.md pbf.hpp; do
  [ -n "$(find "$moved" -name $file)" ] || { echo "$file is not installed" >&2; exit 1; }
done
if [ -n "$(find "$moved" -name libpbf.a)" ]; then
  home="" # the backends are linked in, and come from no file
else
  home=$moved
  library=$(find "$moved" -name libpbf.so)
  case $(readlink "$library") in libpbf.so.[0-9]*) ;; *) echo "libpbf.so is no link to its soname" >&2; exit 1 ;; esac
fi

"$cmake" -S "$consumer" -B by_cmake -DCMAKE_PREFIX_PATH="$moved" >log 2>&1 || { cat log; exit 1; }
"$cmake" --build by_cmake >log 2>&1 || { cat log; exit 1; }
echo "find_package:"
by_cmake/consumer "$home"

if command -v pkg-config >/dev/null; then
  PKG_CONFIG_PATH=$(dirname "$(find "$moved" -name pbf.pc)")
  export PKG_CONFIG_PATH
  libdir=""
  eval "libdir=$(pkg-config --variable=libdir pbf)" # which has backslashes before spaces and their like
  eval "set -- $(pkg-config --cflags --libs pbf)"
  ${CC:-cc} "$consumer/consumer.c" -o by_pkg_config "$@" -Wl,-rpath,"$libdir"
  echo "pkg-config $(pkg-config --modversion pbf):"
  ./by_pkg_config "$home"
else
  echo "pkg-config is not here: left out"
fi

bench=$(find "$moved" -name pbf-bench)
if [ -n "$bench" ]; then
  said=$("$bench" run --scene nonesuch --backend auto 2>&1) && { echo "a scene that there is not runs" >&2; exit 1; }
  case $said in
    *"$moved/"*) echo "pbf-bench finds its scenes where it is" ;;
    *) echo "pbf-bench looks for scenes elsewhere: $said" >&2; exit 1 ;;
  esac
fi
