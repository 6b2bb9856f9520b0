#!/bin/sh
# difference.sh LIBRARY INCLUDE BASELINE [--write]: against the types and functions of the last
# release. Additions pass; whatever a compiled program would notice does not. --write makes a new
# baseline, to be committed with a release.
set -eu
for tool in abidw abidiff; do
  command -v $tool >/dev/null || { echo "skipped: no $tool"; exit 77; }
done
now=$(mktemp)
trap 'rm -f "$now"' EXIT
abidw --no-show-locs --no-comp-dir-path --no-corpus-path --no-elf-needed --headers-dir "$2" \
  --drop-private-types --exported-interfaces-only --type-id-style hash --out-file "$now" "$1"
if [ "${4-}" = --write ]; then
  cp "$now" "$3"
  exit 0
fi
# 4: something changed; 8: incompatibly. Additions alone are no defect.
status=0
abidiff --no-show-locs --no-added-syms "$3" "$now" || status=$?
if [ $((status & 11)) -ne 0 ]; then exit 1; fi
