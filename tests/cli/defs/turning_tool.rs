//! Tests of `kt830::defs::turning_tool`.

use kt830::defs::kind::Kind;
use kt830::defs::param::Params;
use kt830::defs::turning_tool::{TurningTool, TurningToolShape};

#[test]
fn l9_the_factory_tools_are_those_of_the_machine() {
    let params = Params::factory(Kind::Lathe);
    let turning = TurningTool::of_station(&params, 0).outline_mm();
    assert_eq!(turning, [(0.0, 0.0), (8.0, 1.5), (8.1, 8.1), (25.0, 8.1)]);
    let grooving = TurningTool::of_station(&params, 2).outline_mm();
    assert_eq!(grooving, [(0.0, 0.0), (3.0, 0.0), (3.1, 8.1), (25.0, 8.1)]);
    let threading = TurningTool::of_station(&params, 3);
    // tan 60° · 2 mm.
    assert_eq!((threading.shape, threading.outline_mm()[0]), (TurningToolShape::Threading, (-2.0, 3.464)));
}
