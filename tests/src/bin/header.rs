//! Writes `include/srbf.h` anew: `cargo run --release -p srbf-tests --bin header`.

fn main() -> std::io::Result<()> {
    let path = srbf_tests::header::path();
    std::fs::write(&path, srbf_tests::header::generate())?;
    println!("wrote {}", path.display());
    Ok(())
}
