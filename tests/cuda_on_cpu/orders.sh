#!/bin/sh
# tests/cuda_on_cpu/orders.sh PROGRAM [ARGUMENT...]
# Whether the program, over the emulated device, prints the same in any order of threads, blocks and
# streams: results that differ have read what another thread was still to write.
set -eu
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for seed in 0 3 5; do
  PBF_CUDA_EMULATED_SEED=$seed "$@" > "$work/$seed"
  [ -s "$work/$seed" ] || { echo "nothing came with seed $seed"; exit 1; }
  cmp "$work/0" "$work/$seed"
done
