//! An image in `rp2040js`, by node and `tests/peers/image_peer.mjs`.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

use super::Account;
use super::scenario::Scenario;

/// Oldest node that runs the package.
const NODE_MAJOR: u32 = 18;

/// The version of node; fails with what to install when it is missing or too old.
pub fn find_node() -> Result<String, String> {
    let output = Command::new("node").arg("--version").output();
    let output = output.map_err(|error| {
        format!("node does not start ({error}); install it: apt-get install nodejs npm")
    })?;
    let version = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    let major = version.trim_start_matches('v').split('.').next();
    match major.and_then(|major| major.parse::<u32>().ok()) {
        Some(major) if major >= NODE_MAJOR => Ok(version),
        _ => Err(format!(
            "node is {version}, and rp2040js needs {NODE_MAJOR} at least"
        )),
    }
}

/// Runs it; `packages` is the folder that holds `node_modules`.
pub fn run(scenario: &Scenario, image: &Path, packages: &Path) -> Result<Account, String> {
    let mut node = Command::new("node")
        .arg(crate::root().join("tests/peers/image_peer.mjs"))
        .arg(image)
        .arg(packages)
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .map_err(|error| format!("node: {error}"))?;
    if let Some(mut stdin) = node.stdin.take() {
        stdin
            .write_all(scenario.text().as_bytes())
            .map_err(|error| format!("node: {error}"))?;
    }
    let output = node.wait_with_output().map_err(|error| error.to_string())?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr);
        return Err(format!("{}: the peer failed: {said}", scenario.image));
    }
    read(&String::from_utf8_lossy(&output.stdout))
        .ok_or_else(|| format!("{}: the peer's answer is not whole", scenario.image))
}

/// What it printed.
fn read(text: &str) -> Option<Account> {
    let mut account = Account::default();
    let mut ended = false;
    for line in text.lines() {
        let mut words = line.split(' ');
        let kind = words.next()?;
        let rest: Vec<&str> = words.collect();
        let number = |n: usize| rest.get(n)?.parse::<u64>().ok();
        match kind {
            "t" => {
                let record = (number(0)?, number(1)? as u32, number(2)? as u32);
                account.records.push(record);
            }
            "p" => account.pins.push((number(0)?, number(1)? as u32)),
            "u" => {
                let bytes = account.bytes.entry(rest.first()?.to_string()).or_default();
                bytes.extend(rest[1..].iter().filter_map(|byte| byte.parse::<u8>().ok()));
            }
            "a" => {
                account
                    .amended
                    .insert(rest.first()?.to_string(), number(1)?);
            }
            "end" => {
                account.end = number(0)? as u32;
                ended = true;
            }
            _ => account.errors.push(line.to_owned()),
        }
    }
    account.bytes.entry("uart".into()).or_default();
    ended.then_some(account)
}
