#!/bin/sh
# run.sh <build folder> <seconds> [target…]   fuzzes each target for so long, two at a time. What the
# runs learn is kept in <build folder>/fuzz/<target>, what they find in <build folder>/fuzz/found.
# SEED in the environment makes a run of the same programs on a new build folder draw the same inputs.
set -eu
build=$(realpath "$1")
seconds=$2
shift 2
here=$(dirname "$(realpath "$0")")
[ $# -gt 0 ] || set -- state plugin calls scene
mkdir -p "$build/fuzz/found" "$build/fuzz/seeds"
"$build/bin/fuzz_seeds" "$build/fuzz/seeds"

fuzz() {
  target=$1
  seeds=$build/fuzz/seeds/$target
  [ "$target" != scene ] || seeds=$here/../../bench/scenes
  mkdir -p "$build/fuzz/$target"
  if "$build/bin/fuzz_$target" -seed="${SEED:-0}" -max_total_time="$seconds" -max_len=4096 -timeout=20 -rss_limit_mb=4096 \
    -artifact_prefix="$build/fuzz/found/$target-" "$build/fuzz/$target" "$seeds" >"$build/fuzz/$target.log" 2>&1
  then
    echo "fuzz: $target: $(tail -n 1 "$build/fuzz/$target.log")"
  else
    tail -n 40 "$build/fuzz/$target.log" >&2
    echo "fuzz: $target found something; the input is in $build/fuzz/found, the log $build/fuzz/$target.log" >&2
    return 1
  fi
}

failed=0
while [ $# -gt 0 ]; do
  fuzz "$1" & first=$!
  if [ $# -gt 1 ]; then
    fuzz "$2" || failed=1
    shift
  fi
  wait $first || failed=1
  shift
done
exit $failed
