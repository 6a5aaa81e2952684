//! A fit does not depend on the processor: kernels and solvers at every level. Alone in its process, as the level is that of the process.

use srbf_core::Level;
use srbf_fit::{Settings, fit_content};
use std::path::Path;

#[test]
fn every_level_gives_the_same_bytes() {
    let best = Level::current();
    let anisotropic = Settings { lobes: 4, starts: 2, steps: 8, ..Settings::default() };
    // Views and exchanges can be set of isotropic surfaces only.
    let isotropic = Settings { views: Some(5), exchanges: 2, ..anisotropic.clone() };
    for (model, settings) in
        [("model:ggx:alpha=0.2", isotropic), ("model:ward:alpha_x=0.2,alpha_y=0.4", anisotropic)]
    {
        let content = srbf_fit::read::read(Path::new(model)).unwrap().content;
        let fits: Vec<_> = Level::ALL
            .into_iter()
            .filter(|level| level.set().is_ok())
            .map(|level| (level, fit_content(&content, &settings, |_| {}).unwrap()))
            .collect();
        assert_eq!(fits.len(), best as usize, "one fit at each level up to {best:?}");
        println!("{model}: {} levels", fits.len());
        for (level, fit) in &fits[1..] {
            assert!(fit.bytes == fits[0].1.bytes, "{model}: {level:?} and {:?} differ", fits[0].0);
            assert_eq!(fit.report.views, fits[0].1.report.views, "{model}: {level:?}");
            assert_eq!(fit.report.held_out, fits[0].1.report.held_out, "{model}: {level:?}");
        }
    }
}
