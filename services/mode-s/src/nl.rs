//! NL: how many longitude zones CPR has at a latitude, 59 at the equator down to 1 at the poles.
//!
//! NL(lat) = floor(2π / acos(1 − (1 − cos(π/30)) / cos²(lat))). The table holds the latitudes at which it steps, so that the
//! processor only compares integers; a test holds the table against the formula and against every latitude that CPR can encode
//! nearest to a step, so that rounding to 1e-7 degrees never changes the answer: for that the step to NL 41 is one unit higher than
//! the rounded formula, because a surface latitude lies 0.7 units below the true step and rounds onto it.
//! Source: the formula as "The 1090 Megahertz Riddle" prints it, chapter on CPR.

/// Entry i: the latitude in 1e-7 degrees below which NL is at least i + 2. At exactly 87° NL is still 2.
#[rustfmt::skip]
static STEPS: [i32; 58] = [
    870_000_000, 865_353_700, 857_554_162, 848_916_619, 839_917_356, 830_719_944, 821_395_698, 811_980_135,
    802_492_321, 792_942_823, 783_337_408, 773_678_946, 763_968_439, 754_205_626, 744_389_342, 734_517_744,
    724_588_454, 714_598_647, 704_545_107, 694_424_263, 684_232_202, 673_964_677, 663_617_101, 653_184_531,
    642_661_652, 632_042_748, 621_321_666, 610_491_777, 599_545_928, 588_476_378, 577_274_735, 565_931_876,
    554_437_844, 542_781_747, 530_951_615, 518_934_247, 506_715_017, 494_277_644, 481_603_913, 468_673_326,
    455_462_672, 441_945_495, 428_091_401, 413_865_183, 399_225_668, 384_124_189, 368_502_511, 352_289_960,
    335_399_344, 317_720_971, 299_113_569, 279_389_871, 258_292_471, 235_450_449, 210_293_949, 181_862_636,
    148_281_744, 104_704_713,
];

/// NL at a latitude in 1e-7 degrees, 1-59. It is the same north and south.
pub fn nl(latitude: i32) -> u8 {
    let latitude = latitude.saturating_abs();
    if latitude == STEPS[0] {
        return 2;
    }
    // The steps fall as NL grows: those above the latitude come first.
    1 + STEPS.partition_point(|&step| latitude < step) as u8
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    /// Latitude in degrees below which NL is at least `n`, for n of 3 and more.
    fn step(n: usize) -> f64 {
        let a = 1.0 - (PI / 30.0).cos();
        (a / (1.0 - (2.0 * PI / n as f64).cos()))
            .sqrt()
            .acos()
            .to_degrees()
    }

    #[test]
    fn steps_agree_with_the_formula() {
        assert_eq!(STEPS[0], 870_000_000);
        for n in 3..=59 {
            let nudge = if n == 41 { 1 } else { 0 };
            let formula = (step(n) * 1e7).round() as i32;
            assert_eq!(STEPS[n - 2], formula + nudge, "NL {n}");
        }
    }

    #[test]
    fn ends_of_the_range() {
        assert_eq!(nl(0), 59);
        assert_eq!(nl(870_000_000), 2);
        assert_eq!(nl(-870_000_001), 1);
        assert_eq!(nl(900_000_000), 1);
        assert_eq!(nl(i32::MIN), 1);
    }

    #[test]
    fn rounding_changes_no_latitude_that_cpr_can_encode() {
        for n in 3..=59 {
            for zones in [60.0, 59.0, 240.0, 236.0] {
                let quantum = 360.0 / zones / 131_072.0;
                let below = (step(n) / quantum).floor();
                for count in [below - 1.0, below, below + 1.0, below + 2.0] {
                    let latitude = count * quantum;
                    let expected = if latitude < step(n) { n } else { n - 1 };
                    assert_eq!(
                        nl((latitude * 1e7).round() as i32),
                        expected as u8,
                        "NL {n}"
                    );
                }
            }
        }
    }
}
