//! `cargo xtask manual`: what is written from the registry of settings and commands, and from cargo's list of crates. A test fails when a file is
//! not what this would write.
//!
//! | file | for |
//! |---|---|
//! | `docs/at-commands.md` | people |
//! | `docs/completion/squitter.bash` | their shells: the commands behind `squitter twin --at` |
//! | `services/shell/src/licenses.txt` | `AT+3RD_PARTY_LICENSES` |

use settings::{ENTRIES, Entry, Field, Group, Kind, Port, Scope, Settings, Value, What};
use std::fmt::Write;
use std::process::Command;

use crate::workspace;

const MANUAL: &str = "docs/at-commands.md";
const COMPLETION: &str = "docs/completion/squitter.bash";
const LICENSES: &str = "services/shell/src/licenses.txt";

/// Writes all three.
pub fn run() -> Result<(), String> {
    let root = workspace::root()?;
    for (name, text) in files()? {
        let path = root.join(name);
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)
                .map_err(|error| format!("{}: {error}", folder.display()))?;
        }
        std::fs::write(&path, text).map_err(|error| format!("{name}: {error}"))?;
        println!("wrote {name}");
    }
    Ok(())
}

fn files() -> Result<[(&'static str, String); 3], String> {
    Ok([
        (MANUAL, manual()),
        (COMPLETION, completion()),
        (LICENSES, licenses()?),
    ])
}

const HEAD: &str = "\
# AT commands

Written by `cargo xtask manual` from the registry in `services/settings`; how the console behaves is in [console.md](console.md).

In RUN, CONSOLE (USB) speaks the ADSBee dialect: upper case, `AT+X=v` answers `OK`, `AT+X?` answers `+X=v`, a refusal `ERROR <why>`; a blank
argument leaves its value as it is. In CONFIGURATION (`AT+CONFIG=1`, on either port) the Aerobits dialect holds: any case after `AT+`, `AT+OK`,
`AT+X=v`, `AT+ERROR (<why>)`, and `AT+X=?` describes a setting. Names and numbers of a choice are both taken in both.

A setting *of each port* is told for both in RUN and set by `AT+X=<CONSOLE|COMMS_UART>,<value>`; `AT+X=<value>` means the port it is typed on.
Changes act at once (COMMS_UART's rate in CONFIGURATION: on leaving). In RUN they last over a restart after `AT+SETTINGS=SAVE`; CONFIGURATION saves on
leaving.
";

fn manual() -> String {
    let mut out = HEAD.to_owned();
    for group in Group::ALL {
        let entries = ENTRIES.iter().filter(|entry| entry.group == group);
        let _ = write!(out, "\n## {}\n\n", title(group));
        if group == Group::Commands {
            out += "| command | written | does |\n|---|---|---|\n";
            entries.for_each(|entry| command(&mut out, entry));
        } else {
            out += "| setting | values | factory | is |\n|---|---|---|---|\n";
            entries.for_each(|entry| setting(&mut out, entry));
        }
    }
    out
}

const fn title(group: Group) -> &'static str {
    match group {
        Group::System => "System",
        Group::Adsb => "ADS-B reports",
        Group::Asterix => "ASTERIX",
        Group::Gnss => "GNSS",
        Group::Receiver => "Receiver",
        Group::Commands => "Commands",
    }
}

/// Name and aliases.
fn names(entry: &Entry) -> String {
    let mut text = format!("`{}`", entry.name);
    for alias in entry.aliases {
        let _ = write!(text, ", `{alias}`");
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('|', "\\|")
}

fn setting(out: &mut String, entry: &Entry) {
    let (values, factory, notes) = match entry.what {
        What::Setting {
            fields,
            scope,
            restart,
            secret,
        } => {
            let mut notes = String::new();
            if scope == Scope::Port {
                notes += "; of each port";
            }
            if restart {
                notes += "; acts after a restart";
            }
            if secret {
                notes += "; never told";
            }
            (values(entry, fields, scope), factory(fields, scope), notes)
        }
        What::Value { writable, .. } => {
            let values = if writable {
                entry.arguments
            } else {
                "read only"
            };
            (escaped(values), String::new(), String::new())
        }
        What::Command { .. } => (String::new(), String::new(), String::new()),
    };
    let help = escaped(entry.help);
    let names = names(entry);
    let _ = writeln!(out, "| {names} | {values} | {factory} | {help}{notes} |");
}

/// What may stand behind the sign.
fn values(entry: &Entry, fields: &[Field], scope: Scope) -> String {
    let [field] = fields else {
        return format!("`{}`", escaped(entry.arguments));
    };
    if !matches!(scope, Scope::Device | Scope::Port | Scope::Echoed) {
        return format!("`{}`", escaped(entry.arguments));
    }
    match field.kind() {
        Kind::Choice(choices) => {
            let shown = choices.iter().map(|choice| match choice.number() {
                Some(number) => format!("{number} {}", choice.name),
                None => choice.name.to_owned(),
            });
            shown.collect::<Vec<_>>().join(", ")
        }
        kind @ Kind::Hexadecimal { .. } => {
            let (_, max) = kind.range();
            format!("0 to {max:X}, hexadecimal")
        }
        kind => {
            let (min, max) = kind.range();
            format!("{min} to {max}")
        }
    }
}

/// The factory's value; both where the ports differ.
fn factory(fields: &[Field], scope: Scope) -> String {
    let shown = |port: Port| {
        let values = fields.iter().map(|field| {
            let mut text = String::new();
            let value: Value = field.get(&Settings::FACTORY, port);
            // Into a string nothing fails.
            let _ = field.kind().write(&mut text, value, true);
            text
        });
        values.collect::<Vec<_>>().join(",")
    };
    let [console, comms] = Port::ALL.map(shown);
    match scope {
        Scope::Position => "NONE".to_owned(),
        Scope::SerialNumber => "the flash part's unique id".to_owned(),
        Scope::Port if console != comms => format!("{console}; COMMS_UART {comms}"),
        _ => console,
    }
}

fn command(out: &mut String, entry: &Entry) {
    let What::Command { forms, .. } = entry.what else {
        let help = escaped(entry.help);
        let _ = writeln!(out, "| {} | `AT+{}?` | {help} |", names(entry), entry.name);
        return;
    };
    let mut written = Vec::new();
    if forms.bare {
        written.push(format!("`AT+{}`", entry.name));
    }
    let arguments = entry.arguments.trim_start_matches("?|");
    if forms.query {
        written.push(format!("`AT+{}?`", entry.name));
    }
    if forms.set {
        let sign = if arguments.starts_with(['?', '=']) {
            ""
        } else {
            "="
        };
        written.push(format!("`AT+{}{sign}{}`", entry.name, escaped(arguments)));
    }
    let written = written.join(", ");
    let help = escaped(entry.help);
    let _ = writeln!(out, "| {} | {written} | {help} |", names(entry));
}

/// Completion of bash for `squitter`: commands behind `--at`, protocols behind `--protocol`, files elsewhere.
fn completion() -> String {
    let mut words = Vec::new();
    for entry in ENTRIES {
        for name in [entry.name].iter().chain(entry.aliases) {
            let (bare, query, set) = match entry.what {
                What::Setting { .. } => (false, true, true),
                What::Value { writable, .. } => (false, true, writable),
                What::Command { forms, .. } => (forms.bare, forms.query, forms.set),
            };
            for (is, sign) in [(bare, ""), (query, "?"), (set, "=")] {
                if is {
                    words.push(format!("AT+{name}{sign}"));
                }
            }
        }
    }
    let Kind::Choice(protocols) = Field::Protocol.kind() else {
        return String::new();
    };
    let protocols: Vec<&str> = protocols.iter().map(|choice| choice.name).collect();
    format!(
        "# Completion of bash for squitter; written by `cargo xtask manual`. Use: source docs/completion/squitter.bash\n\
         _squitter() {{\n\
         \x20   local word=\"${{COMP_WORDS[COMP_CWORD]}}\" before=\"${{COMP_WORDS[COMP_CWORD-1]}}\"\n\
         \x20   case \"$before\" in\n\
         \x20       --at) COMPREPLY=($(compgen -W '{}' -- \"$word\")) ;;\n\
         \x20       --protocol) COMPREPLY=($(compgen -W '{}' -- \"$word\")) ;;\n\
         \x20       *) COMPREPLY=($(compgen -f -- \"$word\")) ;;\n\
         \x20   esac\n\
         }}\n\
         complete -o nospace -F _squitter squitter\n",
        words.join(" "),
        protocols.join(" ")
    )
}

/// `<crate>: <licence>` of what the images hold and is not ours.
fn licenses() -> Result<String, String> {
    let output = Command::new(env!("CARGO"))
        .current_dir(workspace::root()?)
        .args(["tree", "--offline", "-p", "app", "-p", "bootloader"])
        .args(["--target", "thumbv6m-none-eabi"])
        .args(["-e", "normal,no-proc-macro", "--prefix", "none"])
        .args(["-f", "{p}|{l}|{r}"])
        .output()
        .map_err(|error| format!("cannot start cargo: {error}"))?;
    if !output.status.success() {
        return Err(String::from_utf8_lossy(&output.stderr).into_owned());
    }
    let text = String::from_utf8_lossy(&output.stdout);
    let mut lines: Vec<String> = text
        .lines()
        .filter_map(|line| {
            let (package, license) = line.split_once('|')?;
            // Ours stand with their folder.
            let is_ours = package.contains('(');
            let name = package.split(' ').next()?;
            let license = license.split('|').next()?.trim_end_matches(" (*)");
            (!is_ours).then(|| format!("{name}: {license}\n"))
        })
        .collect();
    lines.sort();
    lines.dedup();
    Ok(lines.concat())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_written_from_the_registry_is_up_to_date() {
        let root = workspace::root().expect("a checkout");
        for (name, text) in files().expect("cargo tells the licences") {
            let found = std::fs::read_to_string(root.join(name)).unwrap_or_default();
            assert!(found == text, "{name} is stale: run `cargo xtask manual`");
        }
    }

    #[test]
    fn every_name_is_in_the_manual() {
        let manual = manual();
        for entry in ENTRIES {
            assert!(
                manual.contains(&format!("`{}`", entry.name)),
                "{}",
                entry.name
            );
        }
    }
}
