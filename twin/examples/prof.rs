use twin::board::Board;
use twin::front_end::{FrontEnd, Player};
use twin::source::{Format, Recording, RecordingOptions};
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut b = Board::power_on(std::path::Path::new(&a[1])).unwrap();
    b.wait_for_console().unwrap();
    let o = RecordingOptions::new(Format::Cu8, 2_000_000);
    let r = Recording::open(std::path::Path::new("../shared/data/modes1.bin"), &o).unwrap();
    b.play(Box::new(Player::new(r, &FrontEnd::ADSBEE_1090)))
        .unwrap();
    b.chip.profile(1);
    let c0 = b.chip.busy_cycles();
    let n0 = b.chip.now();
    while !b.playback_finished() {
        b.run_ms(1).unwrap();
    }
    let c1 = b.chip.busy_cycles();
    eprintln!(
        "busy {:?} of {}",
        [c1[0] - c0[0], c1[1] - c0[1]],
        b.chip.now() - n0
    );
    for (pc, n) in b.chip.profile(1) {
        println!("{pc:x} {n}");
    }
}
