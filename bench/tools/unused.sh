#!/bin/sh
# What a feature costs those who do not use it:
#
#   bench/tools/unused.sh BUILD FOLDER [pbf-bench ablation's options]
#
# Builds the CPU backends, or those that PBF_BACKENDS names, once without each feature and once with all
# into FOLDER, and compares them on a scene that needs none by BUILD's pbf-bench. `pbf-bench ablation
# --against` says what it does.
set -eu
[ $# -ge 2 ] || { sed -n '2,9s/^# \{0,1\}//p' "$0" >&2; exit 2; }
build=$1 folder=$2
shift 2
source=$(cd "$(dirname "$0")/../.." && pwd)
against=
features=$(sed -n 's/^PBF_FEATURE(\([A-Z0-9_]*\),.*/\1/p' "$source/backends/physics/features.def" | tr '[:upper:]' '[:lower:]')
# shellcheck disable=SC2086 # words on purpose
for without in "" $features "$(echo $features | tr ' ' ';')"; do
  case $without in "") name=with_all ;; *";"*) name=without_any ;; *) name=without_$without ;; esac
  cmake -S "$source" -B "$folder/$name" -DCMAKE_BUILD_TYPE=Release "-DPBF_BACKENDS=${PBF_BACKENDS:-reference;serial;openmp}" \
    -DPBF_VARIANTS=3d-f32 "-DPBF_WITHOUT=$without" \
    -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_TESTS=OFF -DPBF_BUILD_EXAMPLES=OFF >/dev/null
  cmake --build "$folder/$name" --parallel 2 >/dev/null
  against="$against --against $name=$folder/$name/lib/pbf/backends"
done
# shellcheck disable=SC2086 # words on purpose
exec "$build/bin/pbf-bench" ablation $against "$@"
