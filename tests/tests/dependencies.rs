//! Limits on the locked dependencies, without the network: licences that `deny.toml` lists, and no newer compiler than
//! the workspace asks for.

use serde_json::Value;
use std::process::Command;

/// The packages of the workspace and all that they depend on here, as `cargo metadata` has them.
fn packages() -> Vec<Value> {
    let output = Command::new(env!("CARGO"))
        .args(["metadata", "--locked", "--format-version", "1", "--manifest-path"])
        .args([concat!(env!("CARGO_MANIFEST_DIR"), "/Cargo.toml"), "--filter-platform"])
        .arg(format!("{}-unknown-linux-gnu", std::env::consts::ARCH))
        .output()
        .unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let mut metadata: Value = serde_json::from_slice(&output.stdout).unwrap();
    let Value::Array(packages) = metadata["packages"].take() else { panic!("no packages") };
    assert!(packages.len() > 50, "{} packages", packages.len());
    packages
}

fn name(package: &Value) -> String {
    format!("{} {}", package["name"].as_str().unwrap(), package["version"].as_str().unwrap())
}

/// The words between quotes in the list `allow` of `deny.toml`.
fn allowed() -> Vec<&'static str> {
    let (_, list) = include_str!("../../deny.toml").split_once("allow = [").unwrap();
    let (list, _) = list.split_once("\n]").unwrap();
    list.lines().filter_map(|line| line.split('"').nth(1)).collect()
}

#[test]
fn licences_are_allowed() {
    let allowed = allowed();
    let is_allowed = |licence: &spdx::LicenseReq| {
        let text = licence.to_string();
        allowed.contains(&text.as_str())
    };
    for package in packages() {
        let licence = package["license"].as_str().unwrap_or_else(|| panic!("{}: no licence", name(&package)));
        let terms = spdx::Expression::parse_mode(licence, spdx::ParseMode::LAX).unwrap();
        assert!(terms.evaluate(is_allowed), "{}: {licence}", name(&package));
    }
}

#[test]
fn no_dependency_asks_for_a_newer_compiler() {
    let number =
        |text: &str| text.split('.').map(|n| n.parse().unwrap()).chain([0, 0]).take(3).collect::<Vec<u32>>();
    let ours = number(env!("CARGO_PKG_RUST_VERSION"));
    for package in packages() {
        let Some(asked) = package["rust_version"].as_str() else { continue };
        assert!(number(asked) <= ours, "{}: {asked}", name(&package));
    }
}
