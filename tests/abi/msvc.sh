#!/bin/sh
# msvc.sh SOURCE GENERATED: the library and its CPU backends as clang-cl takes them: for the ABI of Microsoft's compiler, whose
# headers are not here: those of the C library are declared in msvc/. Files for Windows alone want windows.h, mingw-w64's.
# Extensions of GNU's are errors, but in what lib/compiler.h and the lanes have.
set -eu
source=$1 generated=$2
here=$(cd "$(dirname "$0")" && pwd)
command -v clang++ >/dev/null || { echo "skipped: there is no clang"; exit 77; }
cd "$source"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
for name in pbf_linked pbf_cpu_sources; do
  echo '#define PBF_EACH_LINKED(DO) DO(serial)' >"$work/$name.h"
  echo '#define PBF_CPU_SOURCES ""' >>"$work/$name.h"
done
common="-fsyntax-only -Werror -Wall -Wextra -Wgnu -Iinclude -Ibackends -I$generated -I$work"
msvc="--target=x86_64-pc-windows-msvc -nostdlibinc -isystem $here/msvc -fms-extensions"
count=0
check() { # compiler and flags
  # shellcheck disable=SC2068,SC2086 # words on purpose
  compiler=$1
  shift
  $compiler $common $@
  count=$((count + 1))
}

backend='-DPBF_BACKEND_NAME="serial" -DPBF_BUILD_ID=""'
for file in $(find lib -name '*.c' ! -name 'os_*' ! -name 'image*' | sort) lib/plugin/image_pe.c; do
  check clang $msvc -std=c17 -Wpedantic -DPBF_BUILDS_LIBRARY -Ilib -Ithird_party "$file"
done
for file in core build isa plugin startable_threads team_loops team_serial team_threads; do
  check clang $msvc -std=c17 -Wpedantic $backend backends/cpu/$file.c
done
# Lanes are vectors of the compilers' own: half of them in each variant, at length all.
for variant in 3-32-float 2-64-double; do
  dimension=${variant%%-*} real=${variant##*-} bits=$(echo $variant | cut -d- -f2)
  cxx="clang++ $msvc -std=c++17 -fno-exceptions -fno-rtti -nostdinc++ -Wno-missing-field-initializers -Wno-gnu
    -DPBF_DIM=$dimension -DPBF_BITS=$bits -DPBF_REAL=$real"
  name=${dimension}d_f$bits
  check $cxx -DPBF_VARIANT_API=cpu_$name backends/cpu/backend.cpp
  check $cxx -DPBF_VARIANT_API=reference_$name backends/reference/backend.cpp
  case $variant in 3-*) sets="SCALAR AVX2" ;; *) sets="SSE2 AVX512" ;; esac
  if [ -n "${PBF_TEST_LONG-}" ]; then sets="SCALAR SSE2 AVX2 AVX512"; fi
  for lanes in $sets; do check $cxx -DPBF_VARIANT_API=cpu_$name -march=skylake-avx512 -DPBF_LANES_$lanes backends/cpu/kernels.cpp; done
done
if [ -e /usr/x86_64-w64-mingw32/include/windows.h ]; then
  for file in lib/os_windows.c lib/os_windows_files.c backends/common/system_windows.c; do
    check clang --target=x86_64-w64-windows-gnu -isystem /usr/x86_64-w64-mingw32/include -std=c17 -Wpedantic -DPBF_BUILDS_LIBRARY -Ilib $file
  done
fi
# Attributes and built-in functions of GNU's are in one header of lib.
if grep -nE '__attribute__|__builtin_|__typeof|__asm' -r lib --include=*.c --include=*.h | grep -v '^lib/compiler\.h:'; then
  echo "msvc: the lines above belong into lib/compiler.h" >&2
  exit 1
fi
echo "$count files"
