//! The rest of a material: numbers of lobes, views, factors, channels and bits.

use srbf_core::{Material, PackOptions};

/// The content of a packed material.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PackedForm {
    /// Lobes of a mixture, those that are mirrored counted twice.
    pub lobes: usize,
    /// Views of the material.
    pub views: usize,
    /// Nodes of the table of factors, if there is one.
    pub factors: Option<[usize; 3]>,
    /// Bits and channels.
    pub pack: PackOptions,
}

/// Shares of the lobes and of the views of the whole material that are tried, the least first, and whether there are factors.
const SHARES: [(f64, f64, bool); 9] = [
    (0.34, 0.5, false),
    (0.5, 0.5, false),
    (0.5, 0.7, false),
    (0.67, 0.7, false),
    (0.67, 0.7, true),
    (0.67, 1.0, true),
    (0.84, 0.84, true),
    (1.0, 0.84, true),
    (1.0, 1.0, true),
];

/// The smallest table of factors that is tried.
const FEW_NODES: [usize; 3] = [16, 6, 3];

impl PackedForm {
    /// All that a material has, in codes.
    pub fn of(material: &Material<impl AsRef<[u8]>>, pack: PackOptions) -> Self {
        let (lobes, views, factors) = (material.lobe_count(), material.view_count(), material.factor_nodes());
        Self { lobes, views, factors, pack }
    }
}

/// Forms of a material, each with more in it than the one before, up to all of it.
pub fn forms(material: &Material<impl AsRef<[u8]>>, pack: PackOptions) -> Vec<PackedForm> {
    let whole = PackedForm::of(material, pack);
    let share =
        |of: usize, share: f64, least: usize| ((of as f64 * share).round() as usize).clamp(least.min(of), of);
    let mut forms: Vec<PackedForm> = Vec::new();
    for (of_lobes, of_views, has_factors) in SHARES {
        let few = |nodes: [usize; 3]| [0, 1, 2].map(|i| nodes[i].min(FEW_NODES[i]));
        let factors = whole
            .factors
            .filter(|_| has_factors)
            .map(|nodes| if of_lobes < 1.0 { few(nodes) } else { nodes });
        let form = PackedForm {
            lobes: share(whole.lobes, of_lobes, 1),
            views: share(whole.views, of_views, 2),
            factors,
            pack,
        };
        if !forms.contains(&form) {
            forms.push(form);
        }
    }
    forms
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forms_grow_from_a_third_of_the_lobes_to_the_whole() {
        let material =
            Material::from_bytes(include_bytes!("../../../presets/garnet_red.srbf").as_slice()).unwrap();
        let forms = forms(&material, PackOptions::default());
        let whole = PackedForm::of(&material, PackOptions::default());
        assert_eq!(forms.last(), Some(&whole));
        assert!(forms.len() >= 5, "{forms:?}");
        assert!(forms.windows(2).all(|w| w[0].lobes <= w[1].lobes), "{forms:?}");
        assert!(forms[0].lobes * 2 < whole.lobes && forms[0].views <= whole.views / 2 + 1, "{forms:?}");
    }
}
