#!/bin/sh
# notices.sh SOURCE: every library that `run` installs to build and to test is in the third-party notices.
set -eu
missing=0
for package in $(sed -n 's/^\(build\|test\|view\)_packages="\(.*\)"$/\2/p' "$1/run"); do
  case $package in lib*-dev | *json3-dev) ;; *) continue ;; esac
  grep -q "$package" "$1/THIRD_PARTY_NOTICES.md" || { echo "THIRD_PARTY_NOTICES.md does not name $package"; missing=1; }
done
exit $missing
