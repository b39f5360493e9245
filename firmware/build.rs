//! Hands the linker its scripts: the memory map, cortex-m-rt's layout, the board's vector table, and
//! defmt's section of log strings for the application, or its absence for the link proof.

use std::{env, fs, path::PathBuf};

fn main() {
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let (mut chosen, mut names) = (Vec::new(), Vec::new());
    for entry in fs::read_dir(here.join("src/board")).expect("the boards' folders") {
        let folder = entry.expect("a folder").path();
        let name = folder.file_name().unwrap_or_default().to_string_lossy();
        if env::var_os(format!("CARGO_FEATURE_{}", name.to_uppercase())).is_some() {
            chosen.push(folder.clone());
        }
        names.push(name.into_owned());
    }
    names.sort();
    let [board] = &chosen[..] else {
        let names = names.join(", ");
        println!(
            "cargo::error=choose one board: `--no-default-features --features` with one of {names}"
        );
        return;
    };
    // The memory map of the repository's root, unless the board's folder has another one.
    let root = here.join("..");
    for folder in [board, &root] {
        println!("cargo:rustc-link-search={}", folder.display());
        println!(
            "cargo:rerun-if-changed={}",
            folder.join("memory.x").display()
        );
    }
    println!("cargo:rerun-if-changed={}", board.display());
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    let vectors = board.join("vectors.x");
    if vectors.exists() {
        println!("cargo:rustc-link-arg-bins=-T{}", vectors.display());
    }
    // Vectors and code stay in flash pages that probe-rs and QEMU load: no page alignment of the ELF.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bin=palpate-firmware=-Tdefmt.x");
    let proof = here.join("proof.x");
    println!("cargo:rerun-if-changed={}", proof.display());
    println!("cargo:rustc-link-arg-bin=panic-free=-T{}", proof.display());
}
