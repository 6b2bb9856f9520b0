#!/bin/sh
# functions.sh PROGRAM SYMBOLS.SH LIBRARY: the program calls all that the library exports.
set -eu
list=$(mktemp)
trap 'rm -f "$list"' EXIT
"$1" --list | LC_ALL=C sort >"$list"
sh "$2" "$3" "$list"
