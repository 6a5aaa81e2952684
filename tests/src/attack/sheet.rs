//! Sheets: bytes of several materials, evaluated and drawn from on both sides, one hit and many.

use super::input::{any_direction, put_right, random};
use srbf_core::{Draws, Quarter, Request, Sheet, SheetMixture, Towards, printable_lines};

/// Hits of a request: more than are taken together.
const HITS: usize = 70;

/// The `.srbf` bytes of a sheet, whose lengths and checksums are put right, those of its materials too.
pub fn sheet(bytes: &[u8]) -> bool {
    let mut bytes = bytes.to_vec();
    put_quarters_right(&mut bytes);
    put_right(&mut bytes);
    let Ok(sheet) = Sheet::from_bytes(&bytes[..]) else { return false };
    assert!(!printable_lines(sheet.provenance()).to_string().contains('\u{1b}'));
    let mut random = random(&bytes);
    let mut pair = SheetMixture::<64>::empty();
    let there = Quarter::ALL.into_iter().filter(|q| sheet.quarter(*q).is_some()).count();
    assert!(there > 0 && sheet.lobe_count() <= 64);
    let directions = [(); HITS].map(|()| [any_direction(&mut random), any_direction(&mut random)]);
    for [wo, wi] in &directions[..8] {
        let share = sheet.reflected_share(*wo);
        assert!((0.0..=1.0).contains(&share), "{share}");
        let (value, pdf) = sheet.evaluate_and_pdf(*wo, *wi);
        assert!(value.is_finite() && pdf >= 0.0 && pdf.is_finite(), "{wo} {wi}: {value} {pdf}");
        sheet.prepare(*wo, &mut pair).expect("a unit vector and room for every lobe");
        let (value, pdf) = pair.evaluate_and_pdf(*wi);
        assert!(value.is_finite() && pdf >= 0.0 && pdf.is_finite(), "{wo} {wi}: {value} {pdf}");
        for sample in [sheet.sample(*wo, random.three()), pair.sample(random.three())].into_iter().flatten() {
            assert!(sample.pdf > 0.0 && sample.weight.is_finite(), "{wo}: {sample:?}");
            assert!((sample.direction.length() - 1.0).abs() < 1e-3, "{wo}: {sample:?}");
        }
    }
    let of = |place: usize, axis: usize| directions.map(|pair| pair[place][axis]);
    let (wo, wi) = ([0, 1, 2].map(|k| of(0, k)), [0, 1, 2].map(|k| of(1, k)));
    let u = [(); 3].map(|()| [(); HITS].map(|()| random.three()[0]));
    let (mut direction, mut value, mut pdf) = ([[0.0; HITS]; 3], [[0.0; HITS]; 3], [0.0; HITS]);
    let draw = Draws {
        u: u.each_ref().map(|s| &s[..]),
        direction: direction.each_mut().map(|s| &mut s[..]),
        pdf: Some(&mut pdf),
        weight: None,
    };
    let towards = Towards {
        wi: wi.each_ref().map(|s| &s[..]),
        value: Some(value.each_mut().map(|s| &mut s[..])),
        pdf: None,
    };
    let asked = Request { draw: Some(draw), evaluate: Some(towards) };
    sheet.ask(wo.each_ref().map(|s| &s[..]), asked).expect("slices of one length");
    assert!(direction.iter().chain(&value).flatten().chain(&pdf).all(|v| v.is_finite()));
    true
}

/// Gives the materials within a sheet their lengths and checksums.
pub fn put_quarters_right(bytes: &mut [u8]) {
    const QUARTERS: [&[u8]; 4] = [b"FREF", b"FTRA", b"BREF", b"BTRA"];
    let mut at = 40;
    while let Some(head) = bytes.get(at..at + 8) {
        let length = u32::from_le_bytes([head[4], head[5], head[6], head[7]]) as usize;
        let is_quarter = QUARTERS.contains(&&head[..4]);
        let Some(end) =
            at.checked_add(8).and_then(|n| n.checked_add(length)).filter(|end| *end <= bytes.len())
        else {
            return;
        };
        if is_quarter {
            put_right(&mut bytes[at + 8..end]);
        }
        at = end.next_multiple_of(4);
    }
}
