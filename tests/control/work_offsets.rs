//! Work offsets from a program and on their page: G10 L2 and L20, G52, G54.1, #5201 … (rows B2, B3, B6).

use crate::stories::{ready, ready_with, tell};

/// A ready machine stands at X−80 (diameter), Z−150; all origins are 0.
const PROGRAM: &str = "G98
G10 L2 P2 X-20 Z-30
G10 L2 P0 Z1
G10 L20 P3 Z-50
G55
#501=#5041
#502=#5042
G54.1 P3
#503=#5042
G52 Z-2
#504=#5042
G54
#505=#5042
M30
";

#[test]
fn b2_origins_from_a_program_act_at_once_and_are_kept() {
    let mut rig = ready_with(PROGRAM);
    // X −80 − (−20); Z −150 − (−30) − 1 = −121; P3: −150 + 50 − 1; with G52 Z−2: + 2; G54 with G52 and external: −149.
    tell(
        &mut rig,
        "mode auto\nkey cycle-start\nwait until idle max 10 s\nexpect no alarm
         expect #501 -60\nexpect #502 -121\nexpect #503 -101\nexpect #504 -99\nexpect #505 -149
         power cut\npower on\nexpect #5241 -20\nexpect #5242 -30\nexpect #5202 1\nexpect #7042 -50",
    );
}

#[test]
fn b2_a_local_zero_ends_with_its_program() {
    let mut rig = ready_with("#500=#5042\nG52 Z-5\n#501=#5042\nM30\n");
    for _ in 0..2 {
        tell(
            &mut rig,
            "mode auto\nkey cycle-start\nwait until idle\nexpect #500 -150\nexpect #501 -145\nexpect Z -150 ±0.001",
        );
    }
}

#[test]
fn b3_an_origin_out_of_range_is_refused_and_changes_nothing() {
    let mut rig = ready();
    tell(&mut rig, "mdi #5221=-20\nmdi #5221=10000\nexpect alarm 204\nkey reset\nexpect #5221 -20");
}

/// G500 of the 802D: no work offset is active, and no row of the page is.
#[test]
fn s1_g500_has_no_row_of_the_page() {
    let mut rig = crate::stories::ready_of(kt830::defs::kind::Kind::Vertical);
    assert_eq!(rig.snapshot().offsets.active_origin, Some(1));
    tell(&mut rig, "mdi G500");
    assert_eq!(rig.snapshot().offsets.active_origin, None);
}
