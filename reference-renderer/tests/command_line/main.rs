//! The program `srbf` as a user calls it: errors are named, the exit status is 2, and nothing half-written is left.

mod files;
mod fits;
mod harness;
mod options;
mod outputs;
mod packs;
mod pictures;
mod sheets;
mod strangers;
#[cfg(target_os = "linux")]
mod viewed;

use harness::{command, folder, refused, srbf};

/// The program that is tested.
const PROGRAM: &str = env!("CARGO_BIN_EXE_srbf");

/// Samples of a diffuse surface at two views.
fn rows() -> String {
    let mut text = String::from("wi_x,wi_y,wi_z,wo_x,wo_y,wo_z,r,g,b\n");
    for (wo_x, wo_z) in [(0.0f64, 1.0f64), (0.6, 0.8)] {
        for i in 0..60 {
            let (z, phi) = ((f64::from(i) + 0.5) / 60.0, 2.4 * f64::from(i));
            let r = (1.0 - z * z).sqrt();
            text += &format!("{},{},{z},{wo_x},0,{wo_z},0.2,0.1,0.05\n", r * phi.cos(), r * phi.sin());
        }
    }
    text
}
