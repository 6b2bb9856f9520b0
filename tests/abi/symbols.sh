#!/bin/sh
# symbols.sh LIBRARY LIST: the library exports what the list has, and nothing else.
set -eu
command -v nm >/dev/null || { echo "skipped: no nm"; exit 77; }
nm -D --extern-only --defined-only "$1" | awk '{print $3}' | grep -v '^__asan_\|^__odr_asan' | LC_ALL=C sort | diff "$2" -
