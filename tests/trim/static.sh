#!/bin/sh
# static.sh CMAKE CTEST CC SOURCE BUILD: the smallest build, its tests, and what a program linked
# against it holds.
set -eu
cmake=$1 ctest=$2 cc=$3 source=$4 build=$5
most_bytes=200000

quiet() { "$@" >"$build/log" 2>&1 || { cat "$build/log"; exit 1; }; }

mkdir -p "$build"
quiet "$cmake" -S "$source" -B "$build" -DCMAKE_C_COMPILER="$cc" -DCMAKE_BUILD_TYPE=MinSizeRel -DPBF_WERROR=ON \
  -DPBF_STATIC=ON -DPBF_BACKENDS=serial -DPBF_VARIANTS=3d-f32 "-DPBF_ISAS=sse2;avx2" \
  -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_EXAMPLES=OFF -DPBF_BUILD_TESTS=ON
quiet "$cmake" --build "$build" --parallel 2 --target pbf api_tests
(cd "$build" && quiet "$ctest" -L 'api|trim|install' --output-on-failure)
grep -E 'tests passed|Skipped' "$build/log"

program=$build/hello
"$cc" -Os -std=c11 -I"$source/include" "$source/examples/hello.c" "$build/lib/libpbf.a" -o "$program" \
  -Wl,--gc-sections -pthread -lm
if nm -u "$program" | grep -E ' (dlopen|dlsym|dladdr)(@|$)'; then
  echo "a program with the static library loads files" >&2
  exit 1
fi
# Nothing but the API can be seen from outside, even where a program exports all it has.
"$cc" -shared -o "$build/all.so" -Wl,--whole-archive "$build/lib/libpbf.a" -Wl,--no-whole-archive -pthread -lm
"$source/tests/abi/symbols.sh" "$build/all.so" "$source/tests/abi/libpbf.symbols"

"$program" | tail -n 1
strip "$program"
bytes=$(wc -c <"$program")
echo "examples/hello.c with the library in it: $bytes bytes"
[ "$bytes" -lt "$most_bytes" ] || { echo "more than $most_bytes" >&2; exit 1; }
