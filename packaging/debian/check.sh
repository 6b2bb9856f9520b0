#!/bin/sh
# check.sh SOURCE BUILD FOLDER: the packages for Debian of BUILD (configured for /usr) in FOLDER: what lintian says of
# them, and a program that is built and run against what is in them, unpacked into a folder of its own.
set -eu
source=$1 build=$2 folder=$3
rm -rf "$folder"
mkdir -p "$folder/root"
cd "$folder"
cpack -G DEB --config "$build/CPackConfig.cmake" -B "$folder" >log 2>&1 || { cat log; exit 1; }
ls -l ./*.deb

if command -v lintian >/dev/null; then
  lintian --allow-root --fail-on error,warning ./*.deb
  echo "lintian finds nothing but what the overrides explain"
else
  echo "no lintian: not looked at"
fi

for package in ./*.deb; do dpkg-deb -x "$package" root; done
libdir=$(dirname "$(find root -name libpbf.so)")
PKG_CONFIG_PATH=$folder/$libdir/pkgconfig
export PKG_CONFIG_PATH
# shellcheck disable=SC2046 # words on purpose
c++ -std=c++17 "$source/examples/splash.cpp" -o splash $(pkg-config --cflags --libs pbf)
LD_LIBRARY_PATH=$folder/$libdir ./splash | tee printed
grep -q '1\.0 s: front at 1\.9' printed
if [ -x root/usr/bin/pbf-bench ]; then
  root/usr/bin/pbf-bench list | head -n 5
fi
