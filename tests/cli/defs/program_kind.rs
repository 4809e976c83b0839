//! Tests of `kt830::defs::program_kind`.

use kt830::defs::kind::Kind;
use kt830::defs::program_kind::kinds_of;

#[test]
fn b6_a_program_names_its_kinds_before_its_first_block() {
    for (text, kinds) in [
        ("%\nO1007 (平面往复磨削) (机型 GS)\n(x)\nG00 X1\n", vec![Kind::Gs]),
        ("O1\n\n(kind gc, GA)\nM30\n", vec![Kind::Gc, Kind::Ga]),
        ("; 机型 GS\nM30\n", vec![Kind::Gs]),
        ("(机型：GS、GA)\nM30\n", vec![Kind::Gs, Kind::Ga]),
        // No kind, a word that is none, a comment behind the first block.
        ("O1 (KIND)\nM30\n", vec![]),
        ("O1 (KIND OF BLUE)\nM30\n", vec![]),
        ("O1 (A KIND GS)\nM30\n", vec![]),
        ("G00 X1\n(机型 GS)\nM30\n", vec![]),
        ("", vec![]),
    ] {
        assert_eq!(kinds_of(text.lines()), kinds, "{text}");
    }
}
