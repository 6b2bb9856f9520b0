#!/bin/sh
# reproducible.sh SOURCE FOLDER [ARGUMENT…]: two copies of the tree in two folders of different lengths, built alike
# (ARGUMENTs go to cmake), install the same bytes, and name neither folder.
set -eu
source=$1 folder=$2
shift 2
rm -rf "$folder"
[ $# -gt 0 ] || set -- -DCMAKE_BUILD_TYPE=Release "-DPBF_BACKENDS=serial" -DPBF_VARIANTS=3d-f32 "-DPBF_ISAS=sse2;avx2"
for copy in a another-one; do
  mkdir -p "$folder/$copy/source"
  for part in CMakeLists.txt LICENSE THIRD_PARTY_NOTICES.md backends bench check cmake examples include lib packaging third_party; do
    cp -R "$source/$part" "$folder/$copy/source/"
  done
  cmake -S "$folder/$copy/source" -B "$folder/$copy/source/build" -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_TESTS=OFF \
    -DPBF_BUILD_EXAMPLES=OFF "$@" >"$folder/log" || { cat "$folder/log"; exit 1; }
  cmake --build "$folder/$copy/source/build" --parallel 2 >"$folder/log" || { cat "$folder/log"; exit 1; }
  cmake --install "$folder/$copy/source/build" --prefix "$folder/$copy/prefix" >"$folder/log" || { cat "$folder/log"; exit 1; }
done
diff -r "$folder/a/prefix" "$folder/another-one/prefix"
if grep -rlF "$folder" "$folder/a/prefix"; then
  echo "these files name the folder that they were built in"
  exit 1
fi
(cd "$folder/a/prefix" && find . -type f -exec sha256sum {} +) | sort -k 2
