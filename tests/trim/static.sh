#!/bin/sh
# static.sh CMAKE CTEST CC SOURCE FOLDER FEATURES: two static builds for one scene's kind, one with all
# features and one with none; their tests, and what a program linked against them holds.
set -eu
cmake=$1 ctest=$2 cc=$3 source=$4 folder=$5 features=$6
most_bytes=592000 # of a program with all features, for two instruction sets; 440000 before many colliders, periodic axes, several fluids, 480000 before adhesion and walls of flush boxes, 500000 before walls of fields, reservoirs, and ranks with all stages, 530000 before the grid of steps that change, 534000 before loops of lambda with phases' mobilities, what is clear of colliders, and rooms between planes, 550000 before loads under a grid, the last pressure, and what is done before parts of a step, 560000 before the pressure of closed-in fluid, loads by points, and what is checked before memory is taken, 568000 before loads that know the surface, tables of ids, and what is derived in a unit near h, 572000 before overlaps inside solids, drag under a grid, colliders that leave sleepers, and sentences of one line, 584000 before particles that enter, arrays that are aligned, and grids over periodic faces
few_bytes=192000  # of one with none; 188000 before round solids in each other, and containers that reach out of the domain, 186000 before arrays go once there are those that are wanted, bounds in lanes, and positions checked as vectors, 172000 before the latter two, 182000 before threads' own memory, 185000 before snapshots are known by a table, and processes counted, 188000 before the last pressure, what is done before parts of a step, and colliders that are compared by their bits, 194000 before sentences of one line, and the environment of callbacks, 197000 before particles that a backend finds, points told apart by bits, and exponentials of the library's own, 201000 before programs without emitters leave them out

quiet() { "$@" >"$folder/log" 2>&1 || { cat "$folder/log"; exit 1; }; }

# build NAME FEATURES-LEFT-OUT
build() {
  mkdir -p "$folder/$1"
  quiet "$cmake" -S "$source" -B "$folder/$1" -DCMAKE_C_COMPILER="$cc" -DCMAKE_BUILD_TYPE=MinSizeRel \
    -DPBF_WERROR=ON -DPBF_STATIC=ON -DPBF_BACKENDS=serial -DPBF_VARIANTS=3d-f32 "-DPBF_ISAS=sse2;avx2" -DPBF_FUSED=OFF \
    "-DPBF_WITHOUT=$2" -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_EXAMPLES=OFF -DPBF_BUILD_TESTS=ON
  quiet "$cmake" --build "$folder/$1" --parallel 2 --target pbf "$3"
  (cd "$folder/$1" && quiet "$ctest" -L "$4" -E "$often" --output-on-failure)
  grep -E 'tests passed|Skipped' "$folder/log"
}

# link NAME SOURCE
link() {
  program=$folder/$1/$(basename "$2" .c)
  "$cc" -Os -std=c11 -I"$source/include" "$2" "$folder/$1/lib/libpbf.a" -o "$program" -Wl,--gc-sections -pthread -lm
  if nm -u "$program" | grep -E ' (dlopen|dlsym|dladdr)(@|$)'; then
    echo "a program with the static library loads files" >&2
    exit 1
  fi
  strip "$program"
}

# Of the API's tests those that count memory over thousands of solvers, and follow sleepers, only at length.
often='^api\.(cycles|locale|sleep)\.'
[ -z "${PBF_TEST_LONG-}" ] || often='^$'

build all "" api_tests 'api|trim|install'
build few "$features" test_trim_without trim

# Nothing but the API can be seen from outside, even where a program exports all it has.
"$cc" -shared -o "$folder/all.so" -Wl,--whole-archive "$folder/all/lib/libpbf.a" -Wl,--no-whole-archive -pthread -lm
"$source/tests/abi/symbols.sh" "$folder/all.so" "$source/tests/abi/libpbf.symbols"

# A scene that needs none of the features comes to the same bits and bytes in both.
link all "$source/tests/trim/bits.c"
link few "$source/tests/trim/bits.c"
"$folder/all/bits" | tee "$folder/all.bits"
"$folder/few/bits" | diff "$folder/all.bits" -

link all "$source/examples/hello.c"
"$folder/all/hello" | tail -n 1
bytes=$(wc -c <"$folder/all/hello") few=$(wc -c <"$folder/few/bits")
echo "examples/hello.c: $bytes bytes; the scene without features: $few bytes"
[ "$bytes" -lt "$most_bytes" ] || { echo "more than $most_bytes" >&2; exit 1; }
[ "$few" -lt "$few_bytes" ] || { echo "more than $few_bytes" >&2; exit 1; }
