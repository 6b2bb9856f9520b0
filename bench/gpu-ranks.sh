#!/bin/sh
# Checks and times one scene on several GPUs of one host, in one go:
#
#   bench/gpu-ranks.sh [outdir] [quick|largest]
#
# Needs cmake 3.25, a C and C++ compiler, nvcc and DLPack's header. Raw JSON, one object a line, goes
# to outdir (default: $OUT, else bench/results/<host>): ranks-same.json, whether ranks have the bits of
# one solver, and ranks-times.json, from which bench/tools/ranks_table.py makes a table. With `quick`
# a build that is not optimised of $PBF_VARIANTS, checks and one size; with `largest` 600 million particles
# on one device and a billion on all, in ranks-largest.json: some 200 bytes a particle, and minutes to add
# them. PBF_COMMIT names the commit where there is no git; PBF_BUILD_DIR a build to use as it is.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-${OUT:-$root/bench/results/$(uname -n)}}
quick=${2:-}
build=${PBF_BUILD_DIR:-$root/build/gpu-ranks}
mkdir -p "$out" || exit 1
out=$(cd "$out" && pwd)
failed=0

if [ -z "${PBF_BUILD_DIR:-}" ]; then
  generator=
  command -v ninja >/dev/null && generator='-G Ninja'
  [ "$quick" != quick ] || export CUDAFLAGS=--Ofast-compile=max
  # shellcheck disable=SC2086
  cmake -S "$root" -B "$build" $generator -DCMAKE_BUILD_TYPE=Release -DPBF_REQUIRE_CUDA=ON -DPBF_BACKENDS=cuda \
    ${PBF_VARIANTS:+"-DPBF_VARIANTS=$PBF_VARIANTS"} -DPBF_BUILD_TESTS=OFF -DPBF_BUILD_BENCH=OFF \
    -DPBF_BUILD_EXAMPLES=OFF -DPBF_MPI=OFF >"$out/ranks-build.log" 2>&1 &&
    cmake --build "$build" --parallel --target pbf pbf_backend_cuda >>"$out/ranks-build.log" 2>&1 ||
    { tail -n 30 "$out/ranks-build.log"; exit 1; }
fi
ranks=$build/gpu_ranks
${CC:-cc} -std=c17 -D_POSIX_C_SOURCE=200809L -O2 -I"$root/include" -I"$root/backends" "$root"/bench/gpu_ranks/*.c \
  "$root"/bench/gpu_check/flow.c "$root"/bench/gpu_check/scenes.c "$root"/bench/gpu_check/solver.c "$root"/tests/ranks/thread_ranks.c -o "$ranks" \
  -L"$build/lib" -lpbf -lm -lpthread "-Wl,-rpath,$build/lib" || exit 1
devices=$(nvidia-smi --query-gpu=name --format=csv,noheader | wc -l)

same() { timeout 200 "$ranks" same "$1" >>"$out/ranks-same.json" 2>&1 || failed=1; }
timed() { timeout 200 "$ranks" time "$@" >>"$out/ranks-times.json" 2>&1 || failed=1; }
if [ "$quick" != largest ]; then
  : >"$out/ranks-same.json"
  : >"$out/ranks-times.json"
fi
if [ "$quick" = largest ]; then
  { timeout 300 "$ranks" time 600000000 0 && timeout 500 "$ranks" time 1000000000 "$devices"; } \
    >"$out/ranks-largest.json" 2>&1 || failed=1
  cat "$out/ranks-largest.json"
elif [ -n "$quick" ]; then
  PBF_RANKS_DEVICES=1 same 2
  same 3
  [ "$devices" -gt 1 ] && same "$devices"
  timed 1000000 0
  timed 1000000 1
  [ "$devices" -gt 1 ] && timed 1000000 2
else
  # Times first. Ranks 0 is a solver without ranks. Then weak scaling, with 32 million for each.
  for size in 1000000 16000000 64000000; do
    count=0
    while [ "$count" -le "$devices" ]; do
      timed "$size" "$count"
      count=$((count == 0 ? 1 : 2 * count))
    done
  done
  timed 32000000 0
  count=2
  while [ "$count" -le "$devices" ]; do
    [ "$count" -eq 2 ] || timed $((32000000 * count)) "$count" # 64 million on two there are
    count=$((2 * count))
  done
  same 2
  PBF_RANKS_PROCESSES=1 same 2
  export PBF_RANKS_STAGED=1
  same 2
  PBF_RANKS_PROCESSES=1 PBF_RANKS_BRIEF=1 same 2
  timed 1000000 2
  timed 16000000 2
  unset PBF_RANKS_STAGED
  [ "$devices" -gt 2 ] && same "$devices"
fi
printf '{"machine": "%s", "devices": %s, "commit": "%s", "driver": "%s"}\n' \
  "$(nvidia-smi --query-gpu=name --format=csv,noheader | head -n 1)" "$devices" \
  "${PBF_COMMIT:-$(git -C "$root" rev-parse HEAD 2>/dev/null || echo unknown)}" \
  "$(nvidia-smi --query-gpu=driver_version --format=csv,noheader | head -n 1)" >"$out/ranks-machine.json"
grep -h '"good": false' "$out"/ranks-*.json
exit $failed
