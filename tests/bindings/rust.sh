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
