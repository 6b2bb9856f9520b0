#!/bin/sh
# subproject.sh CMAKE SOURCE FOLDER: pbf as a part of another project: shared, by FetchContent, in a build of several
# configurations that makes what it links alone and has other rules for compiling; and static, by add_subdirectory, with two
# backends in one program that is optimised when it is linked, and in a module that a program unloads.
set -eu
cmake=$1 source=$2 folder=$3
small="-DPBF_VARIANTS=3d-f32 -DPBF_ISAS=scalar -DCMAKE_C_FLAGS_DEBUG=-Og -DCMAKE_CXX_FLAGS_DEBUG=-Og"
quiet() { "$@" >"$folder.log" 2>&1 || { cat "$folder.log"; exit 1; }; }
build() { # how, options
  how=$1
  shift
  rm -rf "$folder/$how/_deps/pbf-subbuild" # of a generator that was another one
  # shellcheck disable=SC2086 # words on purpose
  quiet "$cmake" --fresh -S "$source/tests/install/subproject" -B "$folder/$how" -DHOW=$how "-DSOURCE=$source" $small "$@"
  quiet "$cmake" --build "$folder/$how" --parallel 2
}
# The plugin lies beside the library, where the program finds it.
build FetchContent -G "Ninja Multi-Config" -DPBF_BACKENDS=serial
build add_subdirectory -DCMAKE_BUILD_TYPE=Debug -DPBF_STATIC=ON "-DPBF_BACKENDS=serial;threads" \
  -DCMAKE_POSITION_INDEPENDENT_CODE=ON -DCMAKE_INTERPROCEDURAL_OPTIMIZATION=ON -DCMAKE_POLICY_DEFAULT_CMP0069=NEW
for how in FetchContent add_subdirectory; do
  "$folder/$how/splash" | tail -n 1 | tee "$folder.log"
  grep -q '1\.0 s: front at 1\.9' "$folder.log"
  "$folder/$how/numbers"
  PBF_TEST_BACKEND=serial quiet "$folder/$how/same_bits" "$source/tests/same_bits/pinned.txt" 3d-f32
done
for backend in serial threads; do "$folder/add_subdirectory/reloads" "$folder/add_subdirectory/module.so" $backend; done
