//! The ADSBee's own client, PyPI `adsbee`, types at the shipped image: what its users' scripts do works.

use serde_json::Value;
use tests::adsbee_dialogue::dialogue;
use twin::board::Board;

#[test]
fn the_adsbees_own_client_sets_reads_saves_and_is_told_what_is_not_there() {
    let mut board = Board::power_on(&tests::image()).expect("the image is flashed");
    board.wait_for_capture().expect("capture starts");
    board.wait_for_console().expect("the console opens");
    board.console_read();
    let steps = dialogue(&mut board).unwrap_or_else(|reason| panic!("{reason}"));
    let found = |step: &str| -> &Value {
        let step = steps.iter().find(|value| value["step"] == step);
        &step.unwrap_or_else(|| panic!("{steps:?}"))["found"]
    };
    assert_eq!(
        *found("protocol"),
        serde_json::json!(["+PROTOCOL=CONSOLE,NONE", "+PROTOCOL=COMMS_UART,MAVLINK1"])
    );
    assert_eq!(found("info")["part_code"], "5351554954544552");
    let version = found("info")["rp2040_firmware_version"].as_str();
    assert!(
        version.is_some_and(|text| text.starts_with("0.1.0.0 (")),
        "{steps:?}"
    );
    assert_eq!(*found("save"), serde_json::json!(["OK"]));
    assert_eq!(*found("dump"), serde_json::json!(["OK"]));
    assert_eq!(*found("help"), serde_json::json!(["OK"]));
    assert_eq!(*found("ota"), true);
}
