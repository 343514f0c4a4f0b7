//! The receiver alone: what it drives and sends, when.

use super::*;

const NETS: Nets = Nets {
    uart: 0,
    pps: 26,
    enable: None,
};

/// Edges of PPS and the sentences with their times, up to `until_s`, the enable pin high from `enabled_ms` on.
struct Heard {
    edges: Vec<(u128, bool)>,
    bursts: Vec<(u128, String)>,
}

fn listen(gnss: &mut Gnss, until_s: u128, enabled_ms: u128) -> Heard {
    let mut heard = Heard {
        edges: Vec::new(),
        bursts: Vec::new(),
    };
    while let Some(at) = gnss.next_ps().filter(|at| *at < until_s * SECOND_PS) {
        let levels = if at >= enabled_ms * MS_PS { 1 << 3 } else { 0 };
        let mut wires = Wires::new(at, levels);
        gnss.act(&mut wires);
        assert!(gnss.next_ps() >= Some(at), "time runs on");
        heard.edges.extend(wires.pins.iter().map(|p| (at, p.1)));
        for (_, bytes) in wires.bytes {
            let text = String::from_utf8_lossy(&bytes).into_owned();
            heard.bursts.push((at, text));
        }
    }
    heard
}

fn once(range: Range<u64>) -> Vec<Range<u64>> {
    std::iter::once(range).collect()
}

fn options() -> Options {
    Options {
        jitter: Jitter::EXACT,
        cold_start_ms: 4_000,
        ..Options::default()
    }
}

#[test]
fn a_cold_start_knows_the_time_first_and_the_place_later() {
    let heard = listen(&mut Gnss::new(options(), NETS), 8, 0);
    let status = |n: usize| {
        let rmc = heard.bursts[n].1.lines().next().unwrap();
        rmc[7..].chars().take(11).collect::<String>()
    };
    // Seconds start at 0.37 s: the first is before 1 s, the fifth the first after 4 s.
    assert!(status(0).starts_with(",V,"), "{}", status(0));
    assert_eq!(status(1), "120001.00,V");
    assert_eq!(status(3), "120003.00,V");
    assert_eq!(status(4), "120004.00,A");
    let rises: Vec<u128> = heard.edges.iter().filter(|e| e.1).map(|e| e.0).collect();
    assert_eq!(rises[0], 4_370 * MS_PS);
    assert_eq!(rises.len(), 4);
}

#[test]
fn sentences_follow_their_second_and_pulses_last_100_ms() {
    let heard = listen(&mut Gnss::new(options(), NETS), 6, 0);
    assert_eq!(heard.bursts[5].0, (5_370 + 120) * MS_PS);
    let pair: Vec<_> = heard.edges[..2].to_vec();
    assert_eq!(pair[1].0 - pair[0].0, 100 * MS_PS);
    assert_eq!((pair[0].1, pair[1].1), (true, false));
}

#[test]
fn outages_take_away_just_what_they_name() {
    let mut set = options();
    set.cold_start_ms = 0;
    set.outages = Outages {
        fix: once(2_000..4_000),
        pps: once(5_000..6_000),
        nmea: once(7_000..8_000),
        late: vec![(9_000..10_000, 900)],
        garbled: Vec::new(),
    };
    let heard = listen(&mut Gnss::new(set, NETS), 12, 0);
    let rises: Vec<u128> = heard
        .edges
        .iter()
        .filter(|e| e.1)
        .map(|e| e.0 / SECOND_PS)
        .collect();
    assert_eq!(rises, [0, 1, 4, 6, 7, 8, 9, 10, 11]);
    let times: Vec<u128> = heard.bursts.iter().map(|b| b.0 / MS_PS).collect();
    assert_eq!(
        times,
        [
            490, 1490, 2490, 3490, 4490, 5490, 6490, 8490, 10_390, 10_490, 11_490
        ]
    );
    assert!(heard.bursts[2].1.contains(",V,") && heard.bursts[4].1.contains(",A,"));
}

#[test]
fn sentences_late_by_seconds_keep_their_order() {
    let mut set = options();
    set.outages.late = vec![(2_000..3_000, 2_500)];
    let heard = listen(&mut Gnss::new(set, NETS), 8, 0);
    let times: Vec<u128> = heard.bursts.iter().map(|b| b.0 / MS_PS).collect();
    assert_eq!(times, [490, 1490, 4990, 4990, 4990, 5490, 6490, 7490]);
    assert!(
        heard.bursts[2].1.contains(",120002.00,"),
        "{}",
        heard.bursts[2].1
    );
}

#[test]
fn garbled_sentences_are_wrong_at_the_rate_asked_for_and_the_same_each_time() {
    let run = |per_million| {
        let mut set = options();
        set.outages.garbled = vec![(0..u64::MAX, per_million)];
        let heard = listen(&mut Gnss::new(set, NETS), 60, 0);
        heard.bursts.into_iter().map(|b| b.1).collect::<String>()
    };
    let (clean, noisy) = (run(0), run(20_000));
    let wrong = clean.chars().zip(noisy.chars()).filter(|(a, b)| a != b);
    let share = wrong.count() as f64 / clean.len() as f64;
    assert!((0.015..0.025).contains(&share), "{share}");
    assert_eq!(noisy, run(20_000));
}

#[test]
fn an_enable_net_that_is_low_keeps_it_off_and_starts_it_cold() {
    let nets = Nets {
        enable: Some(3),
        ..NETS
    };
    let heard = listen(&mut Gnss::new(options(), nets), 12, 5_000);
    assert_eq!(heard.bursts[0].0 / SECOND_PS, 5);
    let first = heard.edges[0].0;
    // Seen at 5.37 s, and four seconds from there.
    assert_eq!(first / MS_PS, 9_370);
}

#[test]
fn a_power_cut_starts_it_cold_again() {
    let mut gnss = Gnss::new(options(), NETS);
    listen(&mut gnss, 10, 0);
    gnss.power(false, 10 * SECOND_PS);
    assert!(listen(&mut gnss, 12, 0).bursts.is_empty());
    gnss.power(true, 12 * SECOND_PS);
    let heard = listen(&mut gnss, 18, 0);
    assert!(heard.bursts[0].1.contains(",V,"));
    assert_eq!(heard.edges.iter().find(|e| e.1).unwrap().0 / MS_PS, 16_370);
}

#[test]
fn every_edge_lies_where_its_error_puts_it() {
    let mut set = options();
    set.cold_start_ms = 0;
    set.jitter = Jitter::default();
    let jitter = set.jitter;
    let heard = listen(&mut Gnss::new(set, NETS), 20, 0);
    let rises = heard.edges.iter().filter(|e| e.1);
    for (n, (at, _)) in rises.enumerate() {
        let second = 370 * MS_PS + n as u128 * SECOND_PS;
        assert_eq!(
            *at as i128 - second as i128,
            i128::from(jitter.error_ps(n as u64))
        );
    }
}
