#!/bin/sh
# linkage.sh OBJECT…: the variants have functions of the same names, of which a linker must not take one
# for the other: no weak symbol stands in two of their objects. (nvcc gives the unnamed namespace a name of
# its own in each object, in which symbols are weak.)
set -eu
command -v nm >/dev/null || { echo "skipped: no nm"; exit 77; }
found=$(nm "$@" | awk '$(NF-1) ~ /^[WVwvu]$/ {print $NF}' | sort | uniq -d)
[ -z "$found" ] || { echo "$found"; exit 1; }
