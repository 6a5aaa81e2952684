//! A client without `glam`: directions and colours go in as arrays and come out as arrays, with the digits of `Vec3`.

use srbf_core::{Error, Gaussian, Lobe, Material, Mixture, Sample, Vec3, luminance};

const WO: [f32; 3] = [-0.48, 0.36, 0.8];
const WI: [f32; 3] = [0.6, 0.0, 0.8];

#[test]
fn a_material_takes_arrays() {
    let bytes = include_bytes!("../../presets/garnet_red.srbf");
    let material = Material::from_bytes(&bytes[..]).unwrap();
    let (mut of_arrays, mut of_vectors) = (Mixture::<16>::empty(), Mixture::<16>::empty());
    material.prepare(WO, &mut of_arrays).unwrap();
    material.prepare(Vec3::from(WO), &mut of_vectors).unwrap();

    let (value, pdf) = of_arrays.evaluate_and_pdf(WI);
    assert_eq!((value, pdf), of_vectors.evaluate_and_pdf(Vec3::from(WI)));
    assert_eq!(of_arrays.evaluate(WI), of_vectors.evaluate(Vec3::from(WI)));
    assert_eq!(of_arrays.pdf(WI), of_vectors.pdf(Vec3::from(WI)));
    let [red, green, blue]: [f32; 3] = value.into();
    assert!(red > green && red > blue, "garnet is red: {red} {green} {blue}");

    let Sample { direction, pdf, .. } = of_arrays.sample([0.3, 0.6, 0.9]).unwrap();
    let direction: [f32; 3] = direction.into();
    assert!((of_arrays.pdf(direction) - pdf).abs() <= 1e-5 * pdf);
    assert_eq!(material.factor(WO, WI), material.factor(Vec3::from(WO), Vec3::from(WI)));
}

#[test]
fn lobes_take_arrays() {
    let lobe = Lobe::new(WI, 40.0, [1.0, 0.5, 0.25]).unwrap();
    assert_eq!(Lobe::new(Vec3::from(WI), 40.0, Vec3::new(1.0, 0.5, 0.25)), Ok(lobe));
    assert_eq!(lobe.value(WI), lobe.amplitude);
    assert_eq!(lobe.gaussian.pdf(WO), Gaussian::new(WI, 40.0).unwrap().pdf(Vec3::from(WO)));
    assert_eq!(luminance([1.0; 3]), luminance(Vec3::ONE));

    let mixture = Mixture::<16>::hemisphere(&[lobe]).unwrap().with_diffuse([0.1, 0.2, 0.3]).unwrap();
    assert_eq!(mixture.diffuse().to_array(), [0.1, 0.2, 0.3]);
    // Meaningless numbers are refused as before.
    assert_eq!(Lobe::new([2.0, 0.0, 0.0], 40.0, [1.0; 3]), Err(Error::Axis));
}
