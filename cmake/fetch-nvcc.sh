#!/bin/sh
# Puts CUDA's compiler into a folder from PyPI's wheels, for machines without a CUDA toolkit:
#
#   cmake/fetch-nvcc.sh FOLDER      then   cmake -DPBF_CUDA_WHEELS=FOLDER …
#
# Needs python3 with pip; nothing of the machine is changed.
set -eu
[ $# -eq 1 ] || { echo "usage: cmake/fetch-nvcc.sh FOLDER" >&2; exit 2; }
folder=$1
python3 -m pip install --quiet --no-deps --only-binary=:all: --upgrade --target "$folder" \
  nvidia-cuda-nvcc==13.0.88 nvidia-cuda-crt==13.0.88 nvidia-nvvm==13.0.88 \
  nvidia-cuda-runtime==13.0.96 nvidia-cuda-cccl==13.0.85 nvidia-nvtx==13.0.85
nvcc=$folder/nvidia/cu13/bin/nvcc
chmod +x "$folder"/nvidia/cu13/bin/* "$folder"/nvidia/cu13/nvvm/bin/* 2>/dev/null || true
# The wheels have their libraries in lib, where nvcc looks in lib64.
[ -e "$folder/nvidia/cu13/lib64" ] || ln -s lib "$folder/nvidia/cu13/lib64"
"$nvcc" --version | tail -n 1
