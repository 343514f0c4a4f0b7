use twin::front_end::*;
use twin::source::*;
fn main() {
    let a: Vec<String> = std::env::args().collect();
    let log = MessageLog::open(std::path::Path::new(&a[1]), 1_000_000_000).unwrap();
    let mut p = Player::new(Air::new(log, AirOptions::default()), &FrontEnd::ADSBEE_1090);
    let t = std::time::Instant::now();
    let mut n = 0;
    let mut out = vec![];
    for i in 1..=500u64 {
        out.clear();
        p.next_edges(i * 10_000_000_000, &mut out);
        n += out.len();
    }
    println!("5 s of edges: {n} in {:?}", t.elapsed());
}
