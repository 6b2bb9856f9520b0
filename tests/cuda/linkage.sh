#!/bin/sh
# linkage.sh OBJECT…: the variants have functions of the same names, of which a linker must not take one
# for another. So no two objects have a weak symbol of the same name.
set -eu
command -v nm >/dev/null || { echo "skipped: no nm"; exit 77; }
found=$(nm -A "$@" | awk '$(NF-1) ~ /^[WVu]$/ && ++objects[$NF] == 2 {print $NF}')
[ -z "$found" ] || { echo "in two objects:" "$found"; exit 1; }
