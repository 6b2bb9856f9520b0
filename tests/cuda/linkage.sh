#!/bin/sh
# linkage.sh OBJECT…: the variants have functions of the same names, of which a linker must not take one
# for the other: their objects have no weak symbol.
set -eu
command -v nm >/dev/null || { echo "skipped: no nm"; exit 77; }
found=$(nm -A "$@" | awk '$(NF-1) ~ /^[WVwvu]$/')
[ -z "$found" ] || { echo "$found"; exit 1; }
