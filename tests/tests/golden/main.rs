#[test]
fn x() {
    let _ = rs1090::decode::Message::try_from(&[0u8; 7][..]);
    let _ = adsb_deku::Frame::from_bytes(&[0u8; 7]);
}
