//! Hands the linker its scripts: the memory map of the repository's root, cortex-m-rt's layout, and
//! defmt's section of log strings for the application, or its absence for the link proof.

use std::{env, fs, path::PathBuf};

fn main() {
    let out = PathBuf::from(env::var_os("OUT_DIR").expect("cargo sets OUT_DIR"));
    let here = PathBuf::from(env::var_os("CARGO_MANIFEST_DIR").expect("cargo sets it"));
    let map = here.join("../memory.x");
    fs::copy(&map, out.join("memory.x"))
        .unwrap_or_else(|error| panic!("cannot copy {}: {error}", map.display()));
    println!("cargo:rustc-link-search={}", out.display());
    println!("cargo:rerun-if-changed={}", map.display());
    println!("cargo:rerun-if-changed=build.rs");
    println!("cargo:rustc-link-arg-bins=-Tlink.x");
    // Vectors and code stay in flash pages that probe-rs and QEMU load: no page alignment of the ELF.
    println!("cargo:rustc-link-arg-bins=--nmagic");
    println!("cargo:rustc-link-arg-bin=palpate-firmware=-Tdefmt.x");
    let proof = here.join("proof.x");
    println!("cargo:rerun-if-changed={}", proof.display());
    println!("cargo:rustc-link-arg-bin=panic-free=-T{}", proof.display());
}
