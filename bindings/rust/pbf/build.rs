//! Tests and examples of this crate find libpbf where it was found to link.
fn main() {
    if let Ok(folder) = std::env::var("DEP_PBF_LIBDIR") {
        for kind in ["tests", "examples"] {
            println!("cargo:rustc-link-arg-{kind}=-Wl,-rpath,{folder}");
        }
    }
}
