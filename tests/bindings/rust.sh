#!/bin/sh
# rust.sh SOURCE LIBRARIES FOLDER: the crates' tests against the library in LIBRARIES.
set -eu
source=$1 folder=$3
command -v cargo >/dev/null || { echo "skipped: no cargo"; exit 77; }
mkdir -p "$folder"
unset RUST_BACKTRACE 2>/dev/null || true
export PBF_LIB_DIR="$2" CARGO_TARGET_DIR="$folder/target"
cp -R "$source/bindings/rust/." "$folder/crates" # cargo writes its lock file beside them
cargo test --offline --quiet --manifest-path "$folder/crates/Cargo.toml"
cargo run --offline --quiet --manifest-path "$folder/crates/Cargo.toml" --example splash | tee "$folder/printed"
grep -q '1\.0 s: front at 1\.9' "$folder/printed"
cargo run --offline --quiet --manifest-path "$folder/crates/Cargo.toml" --example pour | tee "$folder/printed"
grep -q ', 0\.2[3-6] m high, 2[01][0-9][0-9] N on the floor, density \(0\.9\|1\.0\)$' "$folder/printed"
# By pkg-config, from a folder whose name wants a backslash in a shell.
command -v pkg-config >/dev/null || exit 0
prefix="$folder/a préfix"
mkdir -p "$prefix/lib/pkgconfig"
ln -sf "$2"/libpbf.so* "$prefix/lib"
ln -sfn "$2/pbf" "$prefix/lib/pbf"
# shellcheck disable=SC2016 # variables of pkg-config's
printf 'libdir=${pcfiledir}/..\nName: pbf\nDescription: pbf\nVersion: 0\nLibs: -L${libdir} -lpbf\n' >"$prefix/lib/pkgconfig/pbf.pc"
unset PBF_LIB_DIR
export PKG_CONFIG_PATH="$prefix/lib/pkgconfig"
cargo run --offline --quiet --manifest-path "$folder/crates/Cargo.toml" --example splash | grep '1\.0 s: front at 1\.9'
