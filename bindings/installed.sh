#!/bin/sh
# installed.sh BUILD FOLDER [ROW…]: each binding and package made from the build BUILD in FOLDER, and used from where it
# is installed there, with nothing of the source tree. Ends with a table; fails where one fails. What the
# machine has not got the programs for is skipped, and says so. FOLDER/ROW.log is what each printed; with ROWs, only
# these: installed abi cpp rust csharp dotnet lua static tarball deb reproducible conan vcpkg.
set -u
build=$(realpath "$1")
mkdir -p "$2"
folder=$(realpath "$2")
source=$(realpath "$(dirname "$0")/..")
shift 2
rows=$*
prefix=$folder/prefix
front='1\.0 s: front at 1\.9' # what every splash prints last
poured=', 0\.2[3-6] m high, 2[01][0-9][0-9] N on the floor, density \(0\.9\|1\.0\)$' # and what every pour
unset PBF_BACKEND_PATH PBF_LIB_DIR LD_LIBRARY_PATH PKG_CONFIG_PATH RUST_BACKTRACE 2>/dev/null || true

skip() { echo "skipped: $*"; exit 77; }
need() { for program in "$@"; do command -v "$program" >/dev/null || skip "no $program"; done; }
fresh() { rm -rf "$1"; mkdir -p "$1"; }

installed() {
  rm -rf "$prefix"
  cmake --install "$build" --prefix "$folder/elsewhere" && mv "$folder/elsewhere" "$prefix"
}

abi() { python3 -B "$source/tools/bindings.py" --check; }

# by_cmake PREFIX FOLDER: a project of C++ that finds the package.
by_cmake() {
  fresh "$2/source"
  cp "$source/examples/splash.cpp" "$source/packaging/conan/test_package/CMakeLists.txt" "$2/source"
  cmake -S "$2/source" -B "$2/build" -DCMAKE_PREFIX_PATH="$1" -DCMAKE_BUILD_TYPE=Release &&
    cmake --build "$2/build" && "$2/build/splash" | tee "$2/printed" && grep -q "$front" "$2/printed"
}

# by_pkg_config PREFIX FOLDER
by_pkg_config() {
  need pkg-config
  fresh "$2"
  PKG_CONFIG_PATH=$(dirname "$(find "$1" -name pbf.pc)") || return 1
  export PKG_CONFIG_PATH
  # shellcheck disable=SC2046 # words on purpose
  for program in splash pour; do
    c++ -std=c++17 "$source/examples/$program.cpp" -o "$2/$program" $(pkg-config --cflags --libs pbf) \
      -Wl,-rpath,"$(pkg-config --variable=libdir pbf)" || return 1
  done
  "$2/splash" | tee "$2/printed" && grep -q "$front" "$2/printed" && "$2/pour" | tee "$2/printed" && grep -q "$poured" "$2/printed"
}

cpp() { by_cmake "$prefix" "$folder/cpp" && by_pkg_config "$prefix" "$folder/cpp_pkg_config"; }

# The crates as they would be published, and a program that depends on them.
rust() {
  need cargo
  fresh "$folder/rust"
  cp -R "$source/bindings/rust" "$folder/rust/crates" && cd "$folder/rust" || return 1
  libdir=$(dirname "$(find "$prefix" -name libpbf.so)")
  export CARGO_TARGET_DIR="$folder/rust/target" PBF_LIB_DIR="$libdir"
  for crate in pbf-sys pbf; do
    (cd "crates/$crate" && cargo package --offline --list >"$folder/rust/$crate.files") || return 1
    mkdir -p "published/$crate"
    grep -v -E '^(Cargo\.(lock|toml\.orig)|\.cargo_vcs_info\.json)$' "$crate.files" |
      while read -r file; do
        mkdir -p "published/$crate/$(dirname "$file")" && cp "crates/$crate/$file" "published/$crate/$file"
      done
  done
  mkdir -p program/src/bin && cp crates/pbf/examples/splash.rs crates/pbf/examples/pour.rs program/src/bin
  printf '[package]\nname = "program"\nversion = "0.0.0"\nedition = "2021"\n[dependencies]\npbf = { path = "../published/pbf" }\n[workspace]\n' >program/Cargo.toml
  cargo build --offline --manifest-path program/Cargo.toml || return 1
  export LD_LIBRARY_PATH="$libdir"
  target/debug/splash | tee printed && grep -q "$front" printed && target/debug/pour | tee printed && grep -q "$poured" printed
}

# A NuGet package, which is a zip file, and a program beside what is in it.
csharp() {
  need mcs mono python3
  fresh "$folder/csharp"
  rm -f "$folder"/Pbf.*.nupkg # of another version
  cd "$folder/csharp" || return 1
  mcs -langversion:7.2 -warnaserror -noconfig -target:library -out:Pbf.dll "$source"/bindings/csharp/Pbf/*.cs &&
    python3 -B "$source/bindings/csharp/pack.py" Pbf.dll "$prefix" "$folder" || return 1
  mkdir used && cd used && python3 -m zipfile -e ../../Pbf.*.nupkg . || return 1
  for program in Splash Pour; do
    mcs -r:lib/netstandard2.0/Pbf.dll -out:$program.exe "$source/bindings/csharp/samples/$program.cs" || return 1
  done
  cp lib/netstandard2.0/Pbf.dll . || return 1
  export LD_LIBRARY_PATH="$PWD/runtimes/linux-x64/native"
  mono Splash.exe | tee printed && grep -q "$front" printed && mono Pour.exe | tee printed && grep -q "$poured" printed
}

# The same program and assembly, by .NET itself.
dotnet() {
  env dotnet --info >/dev/null 2>&1 || skip "no dotnet (pip install dotnetcore2)"
  cd "$folder/csharp/used" || return 1
  export LD_LIBRARY_PATH="$PWD/runtimes/linux-x64/native"
  for program in Splash Pour; do
    cp $program.exe $program.dll || return 1
    printf '{"runtimeOptions": {"rollForward": "LatestMajor", "framework": {"name": "Microsoft.NETCore.App", "version": "3.0.0"}, "configProperties": {"System.Globalization.Invariant": true}}}\n' >$program.runtimeconfig.json
  done
  command dotnet Splash.dll | tee printed && grep -q "$front" printed && command dotnet Pour.dll | tee printed && grep -q "$poured" printed
}

lua() {
  need luajit
  fresh "$folder/lua"
  if command -v luarocks >/dev/null; then
    (cd "$source/bindings/lua" && luarocks --lua-version 5.1 --tree "$folder/lua" make --no-doc pbf-scm-1.rockspec) || return 1
  else
    mkdir -p "$folder/lua/share/lua/5.1"
    cp -R "$source/bindings/lua/pbf.lua" "$source/bindings/lua/pbf" "$folder/lua/share/lua/5.1"
  fi
  LUA_PATH="$folder/lua/share/lua/5.1/?.lua" LD_LIBRARY_PATH=$(dirname "$(find "$prefix" -name libpbf.so)")
  export LUA_PATH LD_LIBRARY_PATH
  luajit "$source/bindings/lua/examples/splash.lua" | tee "$folder/lua/printed" && grep -q "$front" "$folder/lua/printed" &&
    luajit "$source/bindings/lua/examples/pour.lua" | tee "$folder/lua/printed" && grep -q "$poured" "$folder/lua/printed"
}

# The backends are linked in, and nothing is loaded.
static() {
  fresh "$folder/static"
  cmake -S "$source" -B "$folder/static/build" -DCMAKE_BUILD_TYPE=Release -DPBF_STATIC=ON "-DPBF_BACKENDS=serial;threads" \
    -DPBF_VARIANTS=3d-f32 "-DPBF_ISAS=sse2;avx2" -DPBF_BUILD_BENCH=OFF -DPBF_BUILD_TESTS=OFF -DPBF_BUILD_EXAMPLES=OFF &&
    cmake --build "$folder/static/build" --parallel 2 &&
    cmake --install "$folder/static/build" --prefix "$folder/static/prefix" &&
    by_cmake "$folder/static/prefix" "$folder/static/cmake" &&
    by_pkg_config "$folder/static/prefix" "$folder/static/pkg_config" || return 1
  if ldd "$folder/static/pkg_config/splash" | grep -q libpbf; then
    echo "the program wants a libpbf at run time"
    return 1
  fi
}

# `cpack` for /usr, as tests/packages looks at it.
deb() {
  need dpkg-deb dpkg-shlibdeps
  "$source/packaging/debian/check.sh" "$source" "$build" "$folder/deb"
}

tarball() {
  fresh "$folder/tarball"
  cd "$folder/tarball" && cpack -G TGZ --config "$build/CPackConfig.cmake" -B "$folder/tarball" &&
    mkdir tree && tar -xzf pbf-*.tar.gz -C tree --strip-components 1 && by_cmake "$folder/tarball/tree" "$folder/tarball/cmake"
}

reproducible() { "$source/packaging/reproducible.sh" "$source" "$folder/reproducible"; }

conan() {
  env conan --version >/dev/null 2>&1 || skip "no conan (pip install conan)" # this function hides it from command -v
  fresh "$folder/conan"
  export CONAN_HOME="$folder/conan/home"
  command conan profile detect || return 1
  cp -R "$source/packaging/conan/test_package" "$folder/conan/test_package" # Conan builds beside it
  # One kind of fluid, to be done sooner.
  command conan create "$source/packaging/conan" --no-remote --test-folder "$folder/conan/test_package" \
    -c "tools.cmake.cmaketoolchain:extra_variables={'PBF_VARIANTS': '3d-f32', 'PBF_ISAS': 'sse2;avx2'}" || return 1
}

# vcpkg itself where there is one; else the same portfile, by functions that stand in for vcpkg's.
vcpkg() {
  fresh "$folder/vcpkg"
  if [ -n "${VCPKG_ROOT-}" ]; then
    "$VCPKG_ROOT/vcpkg" install pbf "--overlay-ports=$source/packaging/vcpkg" "--x-install-root=$folder/vcpkg/packages" || return 1
    installed_by_vcpkg=$(dirname "$(find "$folder/vcpkg/packages" -path '*/share/pbf' -type d | head -n 1)")/..
  else
    # One kind of fluid, to be done sooner.
    cmake "-DWORK=$folder/vcpkg" "-DOPTIONS=-DPBF_VARIANTS=3d-f32;-DPBF_ISAS=sse2" -P "$source/packaging/vcpkg/stand_in.cmake" || return 1
    installed_by_vcpkg=$folder/vcpkg/packages
    grep -q MIT "$installed_by_vcpkg/share/pbf/copyright" || return 1
  fi
  by_cmake "$installed_by_vcpkg" "$folder/vcpkg/cmake" && by_pkg_config "$installed_by_vcpkg" "$folder/vcpkg/pkg_config"
}

table="" failed=0
try() { # NAME ROW
  case " $rows " in "  " | *" $2 "*) ;; *) return ;; esac
  (set +u; "$2") >"$folder/$2.log" 2>&1
  case $? in
    0) result=passed ;;
    77) result=$(tail -n 1 "$folder/$2.log") ;;
    *)
      result="FAILED: $folder/$2.log"
      failed=1
      tail -n 15 "$folder/$2.log" >&2
      ;;
  esac
  table="$table$(printf '%-36s %s' "$1" "$result")
"
  printf '%-36s %s\n' "$1" "$result" >&2
}

try "install, and move the tree" installed
try "ABI description against the headers" abi
try "C++ (CMake, pkg-config)" cpp
try "Rust crates" rust
try "C# package (Mono)" csharp
try "C# package (.NET)" dotnet
try "LuaJIT module" lua
try "static library (CMake, pkg-config)" static
try "tarball" tarball
try "packages for Debian" deb
try "two builds, the same bytes" reproducible
try "Conan recipe" conan
try "vcpkg port" vcpkg
printf '\n%s' "$table"
exit $failed
