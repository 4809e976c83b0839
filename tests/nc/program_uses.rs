//! The variables and programs that a program uses.

use kt830::nc::program_uses::find_uses;
use kt830::nc::{Dialect, Source};

fn of(text: &str, dialect: Dialect) -> Vec<(u16, bool, bool)> {
    let found = find_uses(&Source::new(1001, "", text.as_bytes().to_vec(), dialect), dialect);
    found.variables.values().map(|one| (one.variable, one.reads, one.writes)).collect()
}

#[test]
fn k7_4_what_a_program_reads_and_writes() {
    let text = "#101=#500-#502 (#503)\nIF[#504 EQ 1]GOTO 5\nG01 X#505 F[#506*2]\n//X#507\n;#508\n#1=#[#2+3]\n#434=1\n";
    let read = |variable| (variable, true, false);
    assert_eq!(of(text, Dialect::LatheA), [(101, false, true), read(500), read(502), read(504), read(505), read(506)]);
    assert_eq!(
        of("G65 H02 P#510 Q#511 R1\n#512=#512+1", Dialect::Mill),
        [(510, false, true), (511, true, false), (512, true, true)]
    );
    assert_eq!(of("IF[#500==1]GOTO 1", Dialect::LatheA), [read(500)]);
}

#[test]
fn s1_r_parameters_are_variables() {
    let text = "R60=R60-R28 ; R1\nX=R20\nMSG(\"R5\")\nG2 X1 CR=5\nIF (R7==R8) GOTOF AA1";
    let found: Vec<_> = of(text, Dialect::Sinumerik).into_iter().map(|(number, ..)| number - 600).collect();
    assert_eq!(found, [7, 8, 20, 28, 60]);
}

#[test]
fn k7_4_called_programs_are_named() {
    let text = "M98 P9010 L2\nG65 P9011 A1\nM98 P00029012\nG65 H80 P100";
    let found = find_uses(&Source::new(1, "", text.as_bytes().to_vec(), Dialect::LatheA), Dialect::LatheA);
    // P418 says whether P29012 is twice O9012 or O29012.
    assert_eq!(found.calls, [9010, 9011, 9012, 29012]);
}
