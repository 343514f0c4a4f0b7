//! The edges of the dependency graph that the architecture rests on: services and the bootloader's pure parts never see hardware.
//!
//! | crate | may depend on, of ours |
//! |---|---|
//! | `services/*` | services |
//! | `bootloader/contract` | nothing |
//! | `bootloader/core` | the contract |
//! | `bootloader/release` (host) | the contract, the core |
//! | `hal` | nothing |
//! | `drivers` | `hal` |
//! | `bootloader` | `hal`, the contract, the core |
//! | `app` | `hal`, `drivers`, services, the contract |
//! | `twin` | services; never firmware, or it would test itself |
//!
//! No crate that holds no hardware reaches a chip crate (`rp2040-*`, `cortex-m*`, `usb-device`) through any chain of normal dependencies.

use serde_json::Value;
use std::collections::{BTreeMap, BTreeSet};

use crate::workspace;

/// A dependency graph: every package with what it needs in the images (no dev-dependencies).
pub struct Graph {
    /// Name and folder of the workspace's packages.
    pub ours: BTreeMap<String, String>,
    pub needs: BTreeMap<String, BTreeSet<String>>,
}

/// What a package of ours may use of ours, by its folder.
fn allowed(folder: &str) -> Option<&'static [&'static str]> {
    Some(match folder {
        f if f.starts_with("services/") => &["services/"],
        "bootloader/contract" | "hal" => &[],
        "bootloader/core" => &["bootloader/contract"],
        "bootloader/release" => &["bootloader/contract", "bootloader/core"],
        "drivers" => &["hal"],
        "bootloader" => &["hal", "bootloader/contract", "bootloader/core"],
        "app" => &["hal", "drivers", "services/", "bootloader/contract"],
        "twin" => &["services/"],
        _ => return None,
    })
}

/// Folders whose crates run unchanged on the host.
fn without_hardware(folder: &str) -> bool {
    folder.starts_with("services/") || folder.starts_with("bootloader/") || folder == "twin"
}

fn is_hardware(package: &str) -> bool {
    package.starts_with("rp2040-")
        || package.starts_with("cortex-m")
        || package.starts_with("usb-device")
}

/// Every edge that should not be, as a line.
pub fn violations(graph: &Graph) -> Vec<String> {
    let mut found = Vec::new();
    for (name, folder) in &graph.ours {
        let needs = graph.needs.get(name).into_iter().flatten();
        if let Some(allowed) = allowed(folder) {
            for other in needs.filter_map(|n| Some((n, graph.ours.get(n)?))) {
                let fits = |a: &str| other.1 == a || (a.ends_with('/') && other.1.starts_with(a));
                if !allowed.iter().any(|a| fits(a)) {
                    found.push(format!("{folder} depends on {} ({})", other.0, other.1));
                }
            }
        }
        if without_hardware(folder) {
            for package in reached(graph, name).into_iter().filter(|p| is_hardware(p)) {
                found.push(format!("{folder} reaches the hardware crate {package}"));
            }
        }
    }
    found
}

fn reached(graph: &Graph, from: &str) -> BTreeSet<String> {
    let mut seen = BTreeSet::new();
    let mut open = vec![from.to_string()];
    while let Some(name) = open.pop() {
        for next in graph.needs.get(&name).into_iter().flatten() {
            if seen.insert(next.clone()) {
                open.push(next.clone());
            }
        }
    }
    seen
}

/// Reads the graph of this workspace from cargo.
pub fn read() -> Result<Graph, String> {
    let metadata = workspace::metadata()?;
    graph(&metadata).ok_or_else(|| "cargo metadata has another shape than expected".to_string())
}

fn graph(metadata: &Value) -> Option<Graph> {
    let root = metadata["workspace_root"].as_str()?;
    let members: BTreeSet<&str> = metadata["workspace_members"]
        .as_array()?
        .iter()
        .filter_map(Value::as_str)
        .collect();
    let mut names = BTreeMap::new();
    let mut ours = BTreeMap::new();
    for package in metadata["packages"].as_array()? {
        let (id, name) = (package["id"].as_str()?, package["name"].as_str()?);
        names.insert(id, name);
        if members.contains(id) {
            let manifest = package["manifest_path"].as_str()?;
            let folder = manifest
                .strip_prefix(root)?
                .trim_start_matches('/')
                .strip_suffix("/Cargo.toml")?;
            ours.insert(name.to_string(), folder.to_string());
        }
    }
    let mut needs = BTreeMap::new();
    for node in metadata["resolve"]["nodes"].as_array()? {
        let mut set = BTreeSet::new();
        for dependency in node["deps"].as_array()? {
            // A kind of null is a normal dependency.
            let normal = dependency["dep_kinds"]
                .as_array()?
                .iter()
                .any(|k| k["kind"].is_null());
            if normal {
                set.insert(names.get(dependency["pkg"].as_str()?)?.to_string());
            }
        }
        needs.insert(names.get(node["id"].as_str()?)?.to_string(), set);
    }
    Some(Graph { ours, needs })
}

/// `cargo xtask check`'s part of it.
pub fn check() -> Result<(), String> {
    let found = violations(&read()?);
    if found.is_empty() {
        return Ok(());
    }
    Err(format!(
        "dependency edges that the architecture forbids:\n  {}",
        found.join("\n  ")
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn made_up(edges: &[(&str, &str)]) -> Graph {
        let folders = [
            ("mode-s", "services/mode-s"),
            ("tracker", "services/tracker"),
            ("hal", "hal"),
            ("app", "app"),
            ("boot-core", "bootloader/core"),
            ("twin", "twin"),
        ];
        let mut needs: BTreeMap<String, BTreeSet<String>> = BTreeMap::new();
        for (from, to) in edges {
            needs
                .entry(from.to_string())
                .or_default()
                .insert(to.to_string());
        }
        Graph {
            ours: folders.map(|(n, f)| (n.to_string(), f.to_string())).into(),
            needs,
        }
    }

    #[test]
    fn the_workspace_keeps_its_edges() {
        assert_eq!(violations(&read().unwrap()), Vec::<String>::new());
    }

    #[test]
    fn a_service_on_the_hal_is_found() {
        assert!(!violations(&made_up(&[("tracker", "hal")])).is_empty());
    }

    #[test]
    fn a_service_that_reaches_the_chip_through_others_is_found() {
        let graph = made_up(&[("tracker", "innocent"), ("innocent", "cortex-m")]);
        assert_eq!(
            violations(&graph),
            ["services/tracker reaches the hardware crate cortex-m"]
        );
    }

    #[test]
    fn a_twin_that_uses_the_app_is_found() {
        assert_eq!(
            violations(&made_up(&[("twin", "app")])),
            ["twin depends on app (app)"]
        );
    }

    #[test]
    fn allowed_edges_are_quiet() {
        let graph = made_up(&[
            ("tracker", "mode-s"),
            ("app", "hal"),
            ("app", "tracker"),
            ("hal", "cortex-m"),
        ]);
        assert_eq!(violations(&graph), Vec::<String>::new());
    }
}
