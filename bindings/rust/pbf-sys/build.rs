//! Finds libpbf: in the folder PBF_LIB_DIR, or by pkg-config. Programs that run where the system's
//! loader does not look get the folder as DEP_PBF_LIBDIR in build scripts of crates that depend on
//! this one.
use std::path::{Path, PathBuf};
use std::process::Command;

fn main() {
    for name in ["PBF_LIB_DIR", "PKG_CONFIG_PATH", "PKG_CONFIG"] {
        println!("cargo:rerun-if-env-changed={name}");
    }
    if std::env::var_os("DOCS_RS").is_some() {
        return; // nothing is linked there
    }
    match std::env::var_os("PBF_LIB_DIR") {
        Some(folder) => from_folder(Path::new(&folder)),
        None => from_pkg_config(),
    }
}

fn from_folder(folder: &Path) {
    let file = |ending: &str| folder.join(format!("libpbf.{ending}"));
    if !file("so").exists() && !file("a").exists() && !file("dylib").exists() {
        panic!("PBF_LIB_DIR is {}, where there is no libpbf", folder.display());
    }
    let described = std::fs::read_to_string(folder.join("pkgconfig/pbf.pc")).unwrap_or_default();
    let words = described.lines().find_map(|line| line.strip_prefix("Libs:")).unwrap_or("-lpbf");
    // What a static library wants beside itself; its own folder is named in variables.
    let flags: Vec<&str> = words.split_whitespace().filter(|word| !word.starts_with("-L")).collect();
    link(Some(folder.to_path_buf()), &flags);
}

fn from_pkg_config() {
    let program = std::env::var("PKG_CONFIG").unwrap_or_else(|_| "pkg-config".into());
    let ask = |what: &str| match Command::new(&program).args([what, "pbf"]).output() {
        Ok(output) if output.status.success() => words_of(&output.stdout),
        Ok(output) => panic!(
            "{program} does not find pbf: set PKG_CONFIG_PATH to PREFIX/lib/pkgconfig, or PBF_LIB_DIR to PREFIX/lib\n{}",
            String::from_utf8_lossy(&output.stderr)
        ),
        Err(error) => panic!("{program} can't be run ({error}): set PBF_LIB_DIR to the folder of libpbf"),
    };
    let flags = ask("--libs");
    let folder = ask("--variable=libdir").join(" ");
    link(
        Some(PathBuf::from(folder)).filter(|folder| folder.is_dir()),
        &flags.iter().map(String::as_str).collect::<Vec<_>>(),
    );
}

/// As a shell reads them: pkg-config has a backslash before each space of a folder's name, and before
/// each byte of other letters.
fn words_of(printed: &[u8]) -> Vec<String> {
    let mut words = vec![Vec::new()];
    let mut bytes = printed.iter();
    while let Some(&byte) = bytes.next() {
        let last = words.len() - 1;
        match byte {
            b'\\' => words[last].extend(bytes.next()),
            _ if byte.is_ascii_whitespace() => words.push(Vec::new()),
            _ => words[last].push(byte),
        }
    }
    words.retain(|word| !word.is_empty());
    words.iter().map(|word| String::from_utf8_lossy(word).into_owned()).collect()
}

fn link(folder: Option<PathBuf>, flags: &[&str]) {
    if let Some(folder) = folder {
        println!("cargo:rustc-link-search=native={}", folder.display());
        println!("cargo:libdir={}", folder.display());
    }
    for flag in flags {
        if let Some(name) = flag.strip_prefix("-l") {
            println!("cargo:rustc-link-lib={name}");
        } else if let Some(path) = flag.strip_prefix("-L") {
            println!("cargo:rustc-link-search=native={path}");
        } else if *flag == "-pthread" {
            println!("cargo:rustc-link-lib=pthread");
        }
    }
}
