#!/bin/sh
# cycles.sh OBJECT…: fails where objects call each other, directly or by way of others, and names
# them.
set -eu
for tool in nm tsort; do
  command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
calls=$(mktemp)
trap 'rm -f "$calls"' EXIT
nm -A "$@" | awk '
  { object = $1; sub(/:.*/, "", object); kind = $(NF - 1); symbol = $NF }
  kind ~ /^[TDBRC]$/ { home[symbol] = object }
  kind == "U" { wants[object, symbol] = 1 }
  END {
    for (want in wants) {
      split(want, part, SUBSEP)
      if (part[2] in home) print part[1], home[part[2]]
    }
  }' >"$calls"
test -s "$calls" || { echo "no calls between objects found"; exit 1; }
tsort "$calls" >/dev/null
