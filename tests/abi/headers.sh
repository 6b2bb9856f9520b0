#!/bin/sh
# headers.sh INCLUDE: the public headers, each alone, in every language that they promise.
set -eu
include=$1
folder=$(mktemp -d)
trap 'rm -rf "$folder"' EXIT
headers=$(cd "$include/pbf" && echo *.h)
for header in $headers; do
  printf '#include <pbf/%s>\n#include <pbf/%s>\nint main(void) { return (int)(PBF_OK); }\n' $header $header >"$folder/$header.c"
  cp "$folder/$header.c" "$folder/$header.cpp"
done
tried=0
check() { # compiler, standard, ending
  command -v "$1" >/dev/null || return 0
  for header in $headers; do
    "$1" "-std=$2" -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only -I"$include" "$folder/$header.$3"
  done
  tried=$((tried + 1))
}
# Between the oldest and the newest of each language there is little that only one of them takes.
c="c99 c17" cpp="c++11 c++20"
if [ -n "${PBF_TEST_LONG-}" ]; then c="c99 c11 c17" cpp="c++11 c++14 c++17 c++20"; fi
for standard in $c; do
  for compiler in gcc clang; do check $compiler $standard c; done
done
for standard in $cpp; do
  for compiler in g++ clang++; do check $compiler $standard cpp; done
done
# The C++ wrapper: C++17 and later, with exceptions and without.
printf '#include <pbf/pbf.hpp>\n#include <pbf/pbf.hpp>\nint main() { return pbf::solver::create().ok() ? 0 : 1; }\n' >"$folder/wrapper.cpp"
for standard in c++17 c++20; do
  for compiler in g++ clang++; do
    command -v $compiler >/dev/null || continue
    for without in "" "-fno-exceptions -fno-rtti"; do
      # shellcheck disable=SC2086 # words on purpose
      $compiler -std=$standard $without -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only -I"$include" "$folder/wrapper.cpp"
      tried=$((tried + 1))
    done
  done
done
echo "$tried compilers and standards"
[ $tried -gt 0 ] || { echo "skipped: no compiler"; exit 77; }
