#!/bin/sh
# subproject.sh CMAKE SOURCE FOLDER: pbf as a part of another project, by FetchContent and by
# add_subdirectory. The first is built and run, small; both are the same from there on.
set -eu
cmake=$1 source=$2 folder=$3
small="-DCMAKE_BUILD_TYPE=Debug -DPBF_BACKENDS=serial -DPBF_VARIANTS=3d-f32 -DPBF_ISAS=scalar"
quiet() { "$@" >"$folder.log" 2>&1 || { cat "$folder.log"; exit 1; }; }
for how in add_subdirectory FetchContent; do
  # shellcheck disable=SC2086 # words on purpose
  quiet "$cmake" -S "$source/tests/install/subproject" -B "$folder/$how" -DHOW=$how "-DSOURCE=$source" $small
done
quiet "$cmake" --build "$folder/FetchContent" --parallel 2
# The program finds the backend beside the library that was built with it.
"$folder/FetchContent/splash" | tail -n 1 | tee "$folder.log"
grep -q '1\.0 s: front at 1\.9' "$folder.log"
