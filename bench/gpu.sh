#!/bin/sh
# Builds, tests, verifies and times the cuda backend on a machine with an NVIDIA GPU, in one go:
#
#   bench/gpu.sh [outdir] [quick]
#
# Needs cmake 3.25, a C and C++ compiler, nvcc and DLPack's header; compute-sanitizer and cmocka
# (CMAKE_PREFIX_PATH names where, if not in the usual place) where they are: without them their part
# says so and is left out.
# Raw JSON, one object a line, goes to outdir (default: $OUT, else bench/results/<host>).
# PBF_COMMIT names the commit where there is no git; PBF_BUILD_DIR a build to use as it is;
# if that has pbf-bench, the stability suite runs, too.
set -u
root=$(cd "$(dirname "$0")/.." && pwd)
out=${1:-${OUT:-$root/bench/results/$(uname -n)}}
quick=${2:-}
build=${PBF_BUILD_DIR:-$root/build/gpu}
mkdir -p "$out" || exit 1
out=$(cd "$out" && pwd)
failed=0

if [ -z "${PBF_BUILD_DIR:-}" ]; then
  generator=
  command -v ninja >/dev/null && generator='-G Ninja'
  configure() {
    # shellcheck disable=SC2086
    cmake -S "$root" -B "$build" $generator -DCMAKE_BUILD_TYPE=Release -DPBF_REQUIRE_CUDA=ON \
      -DPBF_BACKENDS='reference;cuda' -DPBF_BUILD_TESTS="$1" -DPBF_BUILD_BENCH=OFF \
      -DPBF_BUILD_EXAMPLES=OFF >"$out/build.log" 2>&1
  }
  targets='pbf pbf_backend_reference pbf_backend_cuda'
  if configure ON; then
    targets="$targets test_cuda_plugin test_cuda_device test_cuda_caller test_cuda_rows test_cuda_lost test_cuda_forked"
    cmake --build "$build" --target help | grep -q test_cuda_vulkan && targets="$targets test_cuda_vulkan"
  else
    configure OFF || { tail -n 30 "$out/build.log"; exit 1; }
  fi
  # shellcheck disable=SC2086
  cmake --build "$build" --parallel --target $targets >>"$out/build.log" 2>&1 ||
    { tail -n 30 "$out/build.log"; exit 1; }
fi
check=$build/gpu_check
${CC:-cc} -std=c17 -D_POSIX_C_SOURCE=200809L -O2 -I"$root/include" -I"$root/backends" "$root"/bench/gpu_check/*.c -o "$check" \
  -L"$build/lib" -lpbf -lm "-Wl,-rpath,$build/lib" || exit 1

commit=${PBF_COMMIT:-$(git -C "$root" rev-parse HEAD 2>/dev/null || echo unknown)}
driver=$(nvidia-smi --query-gpu=driver_version --format=csv,noheader 2>/dev/null | head -n 1)
compiler=$(${CUDACXX:-nvcc} --version 2>/dev/null | sed -n 's/.*release \(.*\), V.*/\1/p')
printf '{"machine": "%s", "commit": "%s", "driver": "%s", "cuda": "%s", "plugin_bytes": %s}\n' \
  "$(nvidia-smi --query-gpu=name --format=csv,noheader | head -n 1)" "$commit" "$driver" "$compiler" \
  "$(wc -c <"$build/lib/pbf/backends/pbf_backend_cuda.so")" | tee "$out/machine.json"

# run NAME COMMAND...: its output goes to the file NAME.
run() {
  name=$1
  shift
  "$@" >"$out/$name" 2>&1
  status=$?
  echo "$name: exit code $status"
  [ $status -eq 0 ] || failed=1
}

# Times first: nothing else runs then.
: >"$out/times.json"
timed() { "$check" time "$@" >>"$out/times.json" 2>&1 || failed=1; }
timed report-30k 30000
timed report-30k 30000 1.913 f64
for support in 1.6666667 2; do
  timed shallow-dam-break 30000 $support
  timed shallow-dam-break 265000 $support
  timed shallow-dam-break 1000000 $support
  timed shallow-dam-break 4000000 $support
done
for support in 2.25 3; do
  timed shallow-dam-break 1000000 $support
done
timed shallow-dam-break 30000 3 # walls mirror the fluid
for extra in damping_compensation angular_momentum_correction shear_stress_correction viscosity vorticity; do
  timed shallow-dam-break 30000 2 $extra
  timed shallow-dam-break 1000000 2 $extra
done
for extra in periodic emitter drain reservoir; do
  timed shallow-dam-break 5000 2 $extra
  timed shallow-dam-break 1000000 2 $extra
done
for solids in '1 box' '64 box' '1000 box' '1000 hull' '1000 mesh' '1000 box move'; do
  # shellcheck disable=SC2086
  "$check" solids 1000000 $solids >>"$out/times.json" 2>&1 || failed=1
done
if [ -z "$quick" ]; then
  timed shallow-dam-break 16000000 2
  timed shallow-dam-break 100000000 2
  timed shallow-dam-break 1000000 2 f64
fi
export PBF_TEST_BACKEND=cuda # of the tests
for test in plugin device caller rows lost forked vulkan; do
  program=$build/bin/test_cuda_$test
  if [ -x "$program" ]; then
    run "test-$test.txt" "$program"
  else
    echo "test-$test.txt: not built: no cmocka, or no Vulkan"
  fi
done
run barriers.txt python3 -B "$root/tests/cuda/barriers.py" "$build/lib/pbf/backends/pbf_backend_cuda.so"
run same.json "$check" same
# What takes long in verify is the reference, one thread each.
for part in 2d-f32 2d-f64 3d-f32 3d-f64 large; do
  "$check" verify $part >"$out/verify-$part.json" 2>&1 &
  verifying="${verifying:-} $!"
done
for process in $verifying; do
  wait "$process" || failed=1
done
cat "$out"/verify-*.json >"$out/verify.json"
rm "$out"/verify-*.json
if command -v compute-sanitizer >/dev/null; then
  for tool in memcheck racecheck initcheck synccheck; do
    run "$tool.txt" compute-sanitizer --error-exitcode 1 --tool $tool "$check" exercise
    tail -n 1 "$out/$tool.txt"
  done
fi
# The stiff and extreme cases, where the harness has been built too. They are judged here if Python
# has NumPy and SciPy, else from the dumps: pbf-check stability.
if [ -x "$build/bin/pbf-bench" ]; then
  cases=$out/stability
  run stability-run.txt "$build/bin/pbf-bench" stability --backend cuda ${quick:+--quick} --dump "$cases" --only-dump
  if "${PBF_PYTHON:-python3}" -c 'import numpy, scipy' 2>/dev/null; then
    run stability.txt "${PBF_PYTHON:-python3}" -B "$root/check/pbf-check" stability "$cases" --json "$out/stability.json"
  else
    tar -C "$out" -czf "$out/stability.tar.gz" stability && rm -r "$cases"
  fi
fi
grep -h '"good": false' "$out/same.json" "$out/verify.json"
exit $failed
