//! Maps and meshes of a stranger, as the program reads them.

use glam::Vec3;
use srbf_reference_renderer::world::environment::file::{self, Projection};
use srbf_reference_renderer::world::mesh;

/// Runs a target by its name: `scene-hdr`, `scene-exr`, `scene-obj` or `scene-ply`; `None` if it is none of these.
///
/// # Panics
/// If it finds something.
pub fn run(name: &str, bytes: &[u8]) -> Option<()> {
    let ending = name.strip_prefix("scene-")?;
    match ending {
        "hdr" | "exr" => {
            for projection in [Projection::LatLong, Projection::Angular] {
                if let Ok(map) = file::from_bytes(bytes, ending, projection) {
                    let sample = map.sample([0.3, 0.6, 0.2]);
                    let (radiance, pdf) = map.radiance_and_pdf(sample.direction);
                    assert!(radiance.is_finite() && pdf.is_finite() && pdf >= 0.0, "{radiance} {pdf}");
                }
            }
        }
        _ => {
            if let Ok(mesh) = mesh::file::from_bytes(bytes, ending) {
                let count = mesh.positions.len();
                assert!(mesh.normals.len() == count && !mesh.triangles.is_empty());
                assert!(mesh.triangles.iter().flatten().all(|v| (*v as usize) < count));
                assert!(mesh.positions.iter().chain(&mesh.normals).all(|p: &Vec3| p.is_finite()));
            }
        }
    }
    Some(())
}
