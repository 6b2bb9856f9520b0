#!/bin/sh
# lua.sh SOURCE LIBRARIES FOLDER: the module's test and example, by LuaJIT.
set -eu
source=$1 folder=$3
command -v luajit >/dev/null || { echo "skipped: no luajit"; exit 77; }
mkdir -p "$folder"
export PBF_LIBRARY="$2/libpbf.so" LUA_PATH="$source/bindings/lua/?.lua;$source/tests/bindings/?.lua"
luajit "$source/tests/bindings/binding.lua"
luajit "$source/bindings/lua/examples/splash.lua" | tee "$folder/printed"
grep -q '1\.0 s: front at 1\.9' "$folder/printed"
luajit "$source/bindings/lua/examples/pour.lua" | tee "$folder/printed"
grep -q ', 0\.2[3-6] m high, 2[01][0-9][0-9] N on the floor, density \(0\.9\|1\.0\)$' "$folder/printed"
