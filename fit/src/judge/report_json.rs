//! A report in words and as JSON, with the verdict on it.

use crate::complete::{CompletionReport, Gaps};
use crate::judge::appearance::Appearance;
use crate::judge::cross::CrossValidation;
use crate::judge::method::Fitted;
use crate::judge::reciprocity::{Reciprocity, reciprocity};
use crate::judge::report::{Ending, Input, LARGE_ERROR, Report, ViewReport, factor_bytes, mean_error};
use crate::judge::spectral::SpectralReport;
use crate::judge::verdict::{Summary, Verdict};
use crate::look::Look;
use crate::{FitError, Settings};
use serde_json::{Value, json};
use srbf_core::{Material, printable, printable_lines};

/// Share of the hemisphere without samples from which on the albedo of samples is a guess.
const KNOWN: f64 = 0.3;

impl Report {
    /// Facts that one has to know to judge the fit, a sentence each.
    pub fn notes(&self) -> Vec<String> {
        let mut notes = Vec::new();
        let mut note = |of: &dyn Fn(&ViewReport) -> bool, text: &str| {
            let views: Vec<&ViewReport> = self.views.iter().filter(|v| of(v)).collect();
            let mut places: Vec<String> =
                views.iter().map(|v| format!("{:.1}", v.theta.to_degrees())).collect();
            places.dedup();
            if !places.is_empty() {
                notes.push(format!("view at {} degrees: {text}", places.join(", ")));
            }
        };
        note(&|v| v.is_black, "black; no relative error, and in no mean");
        // Of a few samples, such as those of a plane, the albedo is not known.
        let is_known = |v: &ViewReport| {
            self.completion.as_ref().is_none_or(|completion| completion.gaps.share_at(v.theta) < KNOWN)
        };
        note(
            &|v| v.is_albedo_cut && is_known(v),
            "the data's albedo is above 0.95, which lobes were held to",
        );
        note(&|v| v.is_too_dark(), "darker than a material can store");
        let is_off = |v: &ViewReport| !v.is_black && !v.is_too_dark() && v.error > LARGE_ERROR;
        note(&is_off, "relative L2 error above 50 %");
        notes
    }

    /// The report as JSON, with the settings, the provenance of the material and its reciprocity error.
    ///
    /// # Errors
    /// As [`Fitted::view`].
    pub fn to_json(
        &self,
        material: &Material<impl AsRef<[u8]> + Sync>,
        input: &Input,
        settings: &Settings,
    ) -> Result<String, FitError> {
        let mut json = self.json_of(material, "tracked", input, Verdict::of_material)?;
        let more = json!({
            "provenance": printable_lines(material.provenance()).to_string(),
            "settings": settings.to_json(),
            "bytes": material.bytes().len(),
            "lobes": material.lobe_count(),
            "squeezed": material.squeezed_count(),
            "mirrored": material.mirrored_count(),
            "stored_views": material.view_count(),
            "factors": factors_json(material),
        });
        if let (Some(json), Value::Object(more)) = (json.as_object_mut(), more) {
            json.extend(more);
        }
        Ok(format!("{json:#}\n"))
    }

    /// The part of a report that all methods have.
    ///
    /// # Errors
    /// As [`Fitted::view`].
    pub fn to_json_of(&self, fitted: &dyn Fitted, method: &str, input: &Input) -> Result<Value, FitError> {
        self.json_of(fitted, method, input, Verdict::new)
    }

    fn json_of(
        &self,
        fitted: &dyn Fitted,
        method: &str,
        input: &Input,
        judged: fn(&Self, &Reciprocity) -> Verdict,
    ) -> Result<Value, FitError> {
        let views = |views: &[ViewReport]| views.iter().map(ViewReport::to_json).collect::<Vec<_>>();
        let held_out = (!self.held_out.is_empty()).then(|| mean_error(&self.held_out));
        let found = reciprocity(fitted)?;
        let Reciprocity { median, worst, pairs } = found;
        Ok(json!({
            // Keys are written in the order of the alphabet: whose file it is has to stand near its start, where `srbf` looks for it.
            "by": concat!("srbf ", env!("CARGO_PKG_VERSION")),
            "method": method,
            "version": env!("CARGO_PKG_VERSION"),
            "input": {"name": printable(&input.name).to_string(), "sha256": input.sha256},
            "seconds": self.seconds,
            "evaluations": self.evaluations,
            "stopped": self.ending.map(|ending| match ending {
                Ending::Converged => "improvement",
                Ending::Steps => "steps",
            }),
            "notes": self.notes(),
            "summary": Summary::new(self).to_json(),
            "appearance": self.appearance.as_ref().map(Appearance::to_json),
            "verdict": judged(self, &found).to_json(),
            "mean_relative_l2": self.mean_error(),
            "mean_relative_l2_held_out": held_out,
            "cross_validation": self.cross_validation.as_ref().map(CrossValidation::to_json),
            "factor_sizes": self.factor_sizes.iter().map(|(bytes, left)| json!({"bytes": bytes, "share_of_error": left})).collect::<Vec<_>>(),
            "not_measured": self.gaps.as_ref().map(Gaps::to_json),
            "spectra": self.spectra.as_ref().map(SpectralReport::to_json),
            "look": self.look.as_ref().map(Look::to_json),
            "completion": self.completion.as_ref().map(CompletionReport::to_json),
            "reciprocity": {"median_abs_log_ratio": median, "worst_abs_log_ratio": worst, "pairs": pairs},
            "views": views(&self.views),
            "held_out": views(&self.held_out),
        }))
    }
}

/// The table of factors of a material; null if it has none.
fn factors_json(material: &Material<impl AsRef<[u8]>>) -> Value {
    material.factor_nodes().map_or(Value::Null, |nodes| {
        json!({"nodes": nodes, "signed": material.has_signed_factors(), "largest": material.largest_factor(), "bytes": factor_bytes(material)})
    })
}
