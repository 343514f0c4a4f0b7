use twin::board::Board;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let mut b = Board::power_on(std::path::Path::new(&a[1])).unwrap();
    let ms: u64 = a[2].parse().unwrap();
    let t = std::time::Instant::now();
    let mut result = Ok(());
    for _ in 0..ms {
        result = b.run_ms(1);
        if result.is_err() {
            break;
        }
        let c = b.comms_read();
        if !c.is_empty() {
            println!("COMMS {:.4} {:?}", b.seconds(), String::from_utf8_lossy(&c));
        }
        let c = b.console_read();
        if !c.is_empty() {
            println!(
                "CONSOLE {:.4} {:?}",
                b.seconds(),
                String::from_utf8_lossy(&c)
            );
        }
    }
    let el = t.elapsed().as_secs_f64();
    println!(
        "{result:?} cycles {} time {:.3}s wall {el:.3}s  {:.1} MHz busy {:?} pcs {:x?} {:x?} resets {:?} usb {:?} open {} xip1 {} {:x}",
        b.chip.now(),
        b.seconds(),
        b.chip.now() as f64 / el / 1e6,
        b.chip.busy_cycles(),
        b.chip.program_counter(0),
        b.chip.program_counter(1),
        b.chip.resets,
        b.chip.bus.usb_host.faults,
        b.chip.bus.usb_host.open,
        b.chip.bus.core1_xip,
        b.chip.bus.core1_xip_first
    );
}
