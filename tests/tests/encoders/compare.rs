//! What must be told beside what was understood.

use serde_json::Value;
use std::collections::BTreeMap;

/// What a field must be.
#[derive(Debug)]
pub enum Say {
    /// Exactly this.
    Is(Value),
    /// This number, within so much.
    Near(f64, f64),
}

/// A message's fields by name.
pub type Told = BTreeMap<String, Say>;

/// Exactly this.
pub fn is(value: impl Into<Value>) -> Say {
    Say::Is(value.into())
}

/// This, or the null of an empty field.
pub fn or_null<T>(value: Option<T>, say: impl FnOnce(T) -> Say) -> Say {
    value.map_or(Say::Is(Value::Null), say)
}

/// Fields from pairs.
pub fn told<const N: usize>(fields: [(&str, Say); N]) -> Told {
    fields
        .into_iter()
        .map(|(name, say)| (name.into(), say))
        .collect()
}

/// Compares messages in order, every field both ways; panics with the first differences.
pub fn compare(client: &str, expected: &[Told], understood: &[Value]) {
    let (agreed, differences) = differences(expected, understood);
    assert!(
        differences.is_empty(),
        "{client}: {} differences in {} messages, first\n{}",
        differences.len(),
        understood.len(),
        differences[..differences.len().min(20)].join("\n")
    );
    assert_eq!(expected.len(), understood.len(), "{client}: messages");
    println!(
        "{client}: {} messages, {agreed} fields agree",
        understood.len()
    );
}

/// How many fields agree, and what does not.
fn differences(expected: &[Told], understood: &[Value]) -> (usize, Vec<String>) {
    let mut differences = Vec::new();
    let mut agreed = 0;
    for (number, (expected, understood)) in expected.iter().zip(understood).enumerate() {
        let Some(understood) = understood.as_object() else {
            differences.push(format!("{number}: {understood} is no object"));
            continue;
        };
        for (name, say) in expected {
            match understood.get(name) {
                Some(value) if agrees(say, value) => agreed += 1,
                value => {
                    differences.push(format!("{number} {name}: {say:?}, understood {value:?}"))
                }
            }
        }
        for name in understood
            .keys()
            .filter(|name| !expected.contains_key(*name))
        {
            differences.push(format!(
                "{number} {name}: not expected, understood {}",
                understood[name]
            ));
        }
    }
    (agreed, differences)
}

fn agrees(say: &Say, value: &Value) -> bool {
    match say {
        Say::Is(expected) => match (expected.as_f64(), value.as_f64()) {
            (Some(expected), Some(value)) => expected == value,
            _ => expected == value,
        },
        Say::Near(expected, within) => value
            .as_f64()
            .is_some_and(|value| (value - expected).abs() <= *within),
    }
}

/// A field that no message has told proves nothing: each of these names was told by some message, and left unknown by another.
pub fn assert_seen(expected: &[Told], names: &[&str]) {
    for name in names {
        let seen = expected.iter().any(|told| match told.get(*name) {
            Some(Say::Is(value)) => !value.is_null(),
            Some(Say::Near(..)) => true,
            None => false,
        });
        assert!(seen, "no sample tells {name}");
    }
}

#[test]
fn differences_are_found_both_ways() {
    let fails = |expected: Told, understood: &str| {
        let understood = [serde_json::from_str(understood).unwrap()];
        !differences(&[expected], &understood).1.is_empty()
    };
    let expected = || told([("a", is(1)), ("b", Say::Near(2.0, 0.1))]);
    assert!(!fails(expected(), r#"{"a": 1.0, "b": 2.05}"#));
    assert!(fails(expected(), r#"{"a": 2, "b": 2.05}"#));
    assert!(fails(expected(), r#"{"a": 1, "b": 2.2}"#));
    assert!(fails(expected(), r#"{"a": 1}"#));
    assert!(fails(expected(), r#"{"a": 1, "b": 2, "c": null}"#));
}
