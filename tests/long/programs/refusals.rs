//! Senseless values on a grinding page: an alarm that names the variable, and nothing has moved or been switched.

use kt830::defs::signal::Output;

use super::shop::{End, shop};

/// The program, one value that makes no sense, the alarm, and the variable that it names.
const SENSELESS: [(u32, u16, f64, u16, &str); 147] = [
    (1001, 506, -1.0, 3001, "#506"),
    (1001, 506, 1e6, 3002, ""),
    (1001, 512, 0.0, 3003, "#512"),
    (1001, 511, 1e6, 3004, "#511"),
    (1005, 646, 0.0, 3023, "#646"),
    (1002, 521, 40.5, 3001, "#521"),
    (1002, 525, 0.5, 3002, "#525"),
    (1002, 521, 0.0, 3003, "#521"),
    (1002, 522, 40.0, 3004, "#522"),
    (1002, 527, 0.0, 3005, "#527"),
    (1002, 530, 1.0, 3006, "#530"),
    (1003, 601, -1.0, 3010, "#601"),
    (1003, 601, 40.3, 3011, "#601"),
    (1003, 602, 40.0, 3012, "#602"),
    (1003, 604, 8.5, 3013, "#604"),
    (1003, 605, 0.4, 3014, "#605"),
    (1003, 606, 0.0, 3015, "#606"),
    (1003, 607, 0.02, 3016, "#607"),
    (1003, 608, 99.0, 3017, "#608"),
    (1003, 610, 0.0, 3018, "#610"),
    (1004, 621, 41.0, 3011, "#621"),
    (1004, 622, 40.0, 3012, "#622"),
    (1004, 624, -1.0, 3013, "#624"),
    (1004, 625, 0.0, 3014, "#625"),
    (1004, 629, 0.0, 3015, "#629"),
    (1004, 627, 2.0, 3016, "#626"),
    (1004, 632, 0.0, 3017, "#632"),
    (1005, 640, 0.0, 3010, "#640"),
    (1005, 641, 9.0, 3011, "#641"),
    (1005, 642, 0.5, 3012, "#642"),
    (1005, 644, 2.0, 3013, "#643"),
    (1005, 646, 120.0, 3015, "#646"),
    (1005, 676, 31.0, 3024, "#676"),
    (1008, 715, 15.3, 3023, "#715"),
    (1008, 716, 0.0, 3024, "#716"),
    (1008, 717, 54.0, 3025, "#717"),
    (1009, 735, 25.0, 3023, "#735"),
    (1009, 736, 15.0, 3024, "#736"),
    (1009, 737, -30.0, 3025, "#737"),
    (1016, 876, 3.0, 3022, "#876"),
    (1008, 718, 0.11, 3026, "#718"),
    (1009, 739, -0.11, 3026, "#739"),
    (1005, 649, -0.2, 3019, "#649"),
    (1005, 652, 101.0, 3017, "#652"),
    (1006, 660, 0.0, 3010, "#660"),
    (1006, 663, 30.0, 3011, "#663"),
    (1006, 661, 99.0, 3012, "锥度"),
    (1006, 668, 0.02, 3015, "#668"),
    (1006, 664, 41.0, 3016, "#664"),
    (1007, 681, 20.1, 3011, "#681"),
    (1007, 682, 20.0, 3012, "#682"),
    (1007, 686, -35.0, 3014, "#686"),
    (1007, 688, 0.2, 3016, "#688"),
    (1007, 690, 0.0, 3018, "#690"),
    (1007, 811, -1.0, 3024, "#811"),
    (1008, 812, -1.0, 3028, "#812"),
    (1009, 813, -1.0, 3028, "#813"),
    (1010, 754, -1.0, 3024, "#754"),
    (1008, 701, 15.5, 3011, "#701"),
    (1008, 706, 6.0, 3014, "#706"),
    (1008, 707, 40.0, 3017, "砂轮窄"),
    (1008, 711, 0.1, 3018, "#711"),
    (1009, 726, 14.0, 3013, "#726"),
    (1009, 728, 29.0, 3016, "#728"),
    (1009, 732, -1.0, 3021, "#732"),
    (1010, 741, 26.0, 3011, "#741"),
    (1010, 750, 999.0, 3019, "#750"),
    (1011, 763, 0.5, 3030, "#763"),
    (1013, 803, 0.0, 3030, "#803"),
    (1014, 826, 0.0, 3033, "#826"),
    (1015, 850, -1.0, 3001, "#850"),
    (1015, 841, 0.0, 3003, "#841"),
    (1015, 842, 0.4, 3004, "#842"),
    (1015, 844, 2.0, 3005, "#844"),
    (1015, 845, -1.0, 3006, "#845"),
    (1015, 847, 0.5, 3007, "#847"),
    (1015, 849, -1.0, 3008, "#849"),
    // Seat 2 at Z15: the wheel would cover Z20, where seat 1 is larger.
    (1015, 853, 15.0, 3010, "#851"),
    (1015, 840, 50.3, 3011, "#840"),
    (1015, 858, 15.0, 3012, "#858"),
    (1015, 859, 2.0, 3015, "#859"),
    (1015, 848, 0.1, 3017, "#848"),
    (1015, 773, 0.5, 3065, "#773"),
    // Two seats at one place.
    (1015, 853, 20.0, 3010, "#851"),
    (1016, 860, 0.0, 3010, "#860"),
    (1016, 862, 0.0, 3011, "#862"),
    (1016, 863, 0.0, 3012, "#863"),
    (1016, 864, 0.4, 3013, "#864"),
    (1016, 866, 2.0, 3014, "#866"),
    (1016, 867, 999.0, 3015, "#867"),
    (1016, 869, -1.0, 3016, "#869"),
    (1016, 870, 40.3, 3017, "#870"),
    (1016, 872, 0.5, 3018, "#872"),
    (1016, 873, 0.1, 3019, "#873"),
    (1016, 875, 0.1, 3020, "#875"),
    (1016, 871, 30.1, 3021, "#871"),
    (1016, 863, 0.9, 3064, "#863"),
    (1016, 790, 0.5, 3065, "#790"),
    (1017, 880, 0.0, 3010, "#880"),
    (1017, 882, 10.5, 3011, "#882"),
    (1017, 885, 0.0, 3012, "#885"),
    (1017, 886, 0.4, 3013, "#886"),
    (1017, 887, 0.1, 3014, "#887"),
    (1017, 888, 0.02, 3014, "#888"),
    (1017, 889, 0.0, 3015, "#889"),
    (1017, 891, 200.0, 3016, "#891"),
    (1017, 798, 0.0, 3017, "#798"),
    (1017, 893, 11.0, 3018, "#893"),
    (1017, 883, 39.8, 3019, "#883"),
    (1017, 799, 38.5, 3019, "#799"),
    (1017, 884, 50.5, 3020, "#884"),
    (1017, 894, -1.0, 3021, "#894"),
    (1017, 896, 0.0, 3022, "#896"),
    (1017, 897, -320.0, 3023, "#897"),
    (1017, 895, 41.0, 3024, "#895"),
    (1017, 797, 1.0, 3026, "#797"),
    (1017, 898, -1.0, 3026, "#898"),
    (1017, 899, 0.2, 3026, "#899"),
    (1018, 900, 5.0, 3010, "#900"),
    (1018, 901, 0.0, 3012, "#901"),
    (1018, 904, 9.0, 3013, "#904"),
    (1018, 906, 9.0, 3014, "#906"),
    (1018, 905, 100.0, 3014, "#905"),
    (1018, 907, 0.0, 3015, "#907"),
    (1018, 902, 0.0, 3018, "#902"),
    (1018, 901, 41.0, 3019, "#901"),
    (1019, 921, 0.0, 3010, "#921"),
    (1019, 921, 40.3, 3011, "#921"),
    (1019, 922, 40.3, 3012, "#922"),
    (1019, 924, 0.4, 3013, "#924"),
    (1019, 926, 2.0, 3014, "#926"),
    (1019, 931, -0.005, 3017, "#931"),
    (1019, 933, 0.0, 3018, "#933"),
    (1019, 934, 0.5, 3019, "#934"),
    (1019, 936, 0.9, 3020, "#936"),
    (1019, 935, 41.0, 3021, "#935"),
    (1019, 935, -1.0, 3022, "#935"),
    (1019, 935, 39.5, 3021, "#935"),
    (1020, 940, 3.0, 3010, "#940"),
    (1020, 942, 0.5, 3012, "#942"),
    (1020, 945, 8.0, 3015, "#945"),
    (1020, 951, -1.0, 3019, "#947"),
    (1020, 950, 0.5, 3020, "#946"),
    (1020, 949, 20.0, 3021, "80"),
    (1020, 958, 19.0, 3053, "P78"),
    (1020, 958, 25.0, 3053, "P78"),
    (1020, 940, 2.0, 3055, "#940"),
];

#[test]
fn k7_5_senseless_values_are_refused_before_anything_moves() {
    for (program, variable, value, number, named) in SENSELESS {
        let mut shop = shop(program);
        shop.set(variable, value);
        let before = shop.rig.machine().slide_mm();
        let End::Alarm(alarm, text) = shop.run() else { panic!("O{program} #{variable}={value} was not refused") };
        assert_eq!(alarm, number, "O{program} #{variable}={value}: {text}");
        assert!(text.contains(named), "O{program} #{variable}={value}: {text}");
        assert_eq!(shop.rig.machine().slide_mm(), before, "O{program} #{variable}={value} moved something");
        let outputs = shop.rig.controller().outputs();
        for output in [Output::Wheel, Output::Coolant, Output::HeadstockHigh, Output::AxialGauge] {
            let port = shop.rig.retained().params.output_port(output);
            assert!(!outputs.terminals.is_closed(port), "O{program} #{variable}={value}: {}", output.id());
        }
        assert_eq!(shop.events(), []);
    }
}

#[test]
fn k7_5_a_page_without_values_is_refused_too() {
    for program in 1002..=1020 {
        let mut shop = super::shop::shop_with(program, 1, |part| part.variables.clear());
        let before = shop.rig.machine().slide_mm();
        assert!(matches!(shop.run(), End::Alarm(3000.., _)), "O{program}");
        assert_eq!(shop.rig.machine().slide_mm(), before, "O{program}");
    }
}

#[test]
fn p8_a_dead_gauge_is_an_alarm_and_the_wheel_is_off_the_part() {
    for (program, alarm) in
        [(1003, 3019), (1004, 3094), (1006, 3020), (1007, 3020), (1010, 3020), (1015, 3094), (1016, 3094)]
    {
        let mut shop = shop(program);
        shop.rig.machine_mut().inject_fault("gauge-dead").unwrap();
        let End::Alarm(number, _) = shop.run() else { panic!("O{program} ended without its gauge") };
        assert_eq!(number, alarm, "O{program}");
        assert_eq!(shop.events(), [], "O{program}");
        // Drawn back before the alarm: nothing is ground any more.
        let before = shop.rig.machine().measure();
        (0..2_000).for_each(|_| shop.rig.step());
        assert_eq!(shop.rig.machine().measure(), before, "O{program}");
    }
}

#[test]
fn k4_5_no_reference_face_is_alarm_183() {
    let mut shop = super::shop::shop_with(1005, 1, |part| {
        part.surfaces.remove(0);
    });
    assert!(matches!(shop.run(), End::Alarm(183, _)));
    assert_eq!(shop.events(), []);
}

/// Empty #531 and #631 meant a dressing before every part, empty #530 an alarm behind the part.
#[test]
fn k7_5_an_empty_interval_or_compensation_is_zero() {
    for (program, variable) in [(1002, 530), (1002, 531), (1004, 631)] {
        let run = |value: Option<f64>| {
            let mut shop = shop(program);
            shop.rig.send(kt830::link::Command::SetVariable(variable, value));
            shop.rig.step();
            (shop.run(), shop.rig.now(), shop.rig.machine().measure())
        };
        let empty = run(None);
        assert_eq!(empty.0, End::Finished, "O{program} #{variable}");
        assert_eq!(empty, run(Some(0.0)), "O{program} #{variable}");
    }
}

/// Positions on a grinding page: an axis without a coordinate does not move.
const POSITIONS: [(u32, &[u16]); 15] = [
    (1001, &[500, 501, 502, 503, 504, 514]),
    (1002, &[523]),
    (1003, &[603, 604]),
    (1004, &[623]),
    (1005, &[650, 651, 652]),
    (1006, &[662, 663]),
    (1007, &[683, 684, 685, 686]),
    (1008, &[703, 704]),
    (1009, &[723, 724]),
    (1010, &[743, 744]),
    (1015, &[851, 853, 855, 857]),
    (1016, &[861, 871]),
    (1017, &[881, 882, 883, 884]),
    (1018, &[903]),
    (1019, &[923]),
];

/// Without #502 the wheel of O1001 ran into the part, without #523 O1002 ground where it stood.
#[test]
fn k7_5_an_empty_position_is_refused_before_anything_moves() {
    for (program, variables) in POSITIONS {
        for variable in variables {
            let mut shop = shop(program);
            shop.rig.send(kt830::link::Command::SetVariable(*variable, None));
            shop.rig.step();
            let before = shop.rig.machine().slide_mm();
            let End::Alarm(alarm, text) = shop.run() else { panic!("O{program} without #{variable} was not refused") };
            // Alarm 3009, or one of a comparison that fails before.
            assert!(
                (3_001..3_100).contains(&alarm) && text.contains(&format!("#{variable}")),
                "O{program} #{variable}: {alarm} {text}"
            );
            assert_eq!(shop.rig.machine().slide_mm(), before, "O{program} without #{variable} moved something");
        }
    }
}
