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
for header in $headers; do echo "#include <pbf/$header>"; done >"$folder/all_of_them.c"
echo 'int main(void) { return (int)(PBF_OK); }' >>"$folder/all_of_them.c"
cp "$folder/all_of_them.c" "$folder/all_of_them.cpp"
check() { # compiler, standard, ending, headers
  command -v "$1" >/dev/null || return 0
  for header in $4; do
    "$1" "-std=$2" -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Werror -fsyntax-only -I"$include" "$folder/$header.$3"
  done
  tried=$((tried + 1))
}
# Whether a header includes what it needs is the same in all standards: each alone in the oldest of a language, by one compiler,
# and all in one unit in every standard, by every compiler; at length each alone everywhere.
check gcc c99 c "$headers"
check g++ c++11 cpp "$headers"
units=all_of_them
if [ -n "${PBF_TEST_LONG-}" ]; then units=$headers; fi
for standard in c99 c11 c17; do
  for compiler in gcc clang; do check $compiler $standard c "$units"; done
done
for standard in c++11 c++14 c++17 c++20; do
  for compiler in g++ clang++; do check $compiler $standard cpp "$units"; done
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
# In older ones it says what it needs, and nothing else.
for compiler in g++ clang++; do
  command -v $compiler >/dev/null || continue
  printf '#include <pbf/pbf.hpp>\n' >"$folder/older.cpp"
  ! $compiler -std=c++14 -fsyntax-only -I"$include" "$folder/older.cpp" 2>"$folder/errors" || { echo "$compiler takes pbf.hpp for C++14"; exit 1; }
  grep -q 'error: .*pbf.hpp is C++17' "$folder/errors" && [ "$(grep -c 'error:' "$folder/errors")" = 1 ] ||
    { cat "$folder/errors"; exit 1; }
done
echo "$tried compilers and standards"
[ $tried -gt 0 ] || { echo "skipped: no compiler"; exit 77; }
