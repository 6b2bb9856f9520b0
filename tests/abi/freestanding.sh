#!/bin/sh
# freestanding.sh PLUGIN OBJECT…: a backend needs no C++ runtime, and no function that is compiled for one
# instruction set can take the place of another's: its objects have no weak symbol, which a linker may
# merge, and no C++ name that other objects see, and the plugin loads no C++ library.
set -eu
command -v nm >/dev/null && command -v readelf >/dev/null || { echo "skipped: no nm or readelf"; exit 77; }
plugin=$1
shift
found=$(nm -A "$@" | awk '
  $(NF-1) ~ /^[WVwvu]$/ && $NF !~ /^(__cxa_finalize|__gmon_start__|_ITM_)/ {print "weak: " $0}
  $(NF-1) ~ /^[TDBRUC]$/ && $NF ~ /^(_Z|__cxa|__gxx|_Unwind)/ {print "C++: " $0}')
needed=$(readelf -d "$plugin" | grep -E 'NEEDED.*lib(stdc\+\+|c\+\+|gcc_s)' || true)
[ -z "$found$needed" ] || { echo "$found" "$needed"; exit 1; }
