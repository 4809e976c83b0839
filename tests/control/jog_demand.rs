//! What jog keys and detents demand of the axes.

use kt830::controller::axes::jog_demand::{JogDemand, JogLimits};
use kt830::controller::axes::{Axes, soft_limits};
use kt830::defs::key::Key;
use kt830::defs::kind::Kind;
use kt830::defs::param::{self, Params};
use kt830::io::InputImage;
use kt830::units::{Axis, Micros, PerAxis};

const LIMITS: JogLimits = JogLimits { jog_mode: true, rapid_jog: false, feed: 1.0, rapid: 1.0, slow_axis: None };

fn begin() -> (Params, Axes, JogDemand) {
    let params = Params::factory(Kind::Gc);
    let axes = Axes::new(&params, &InputImage::default(), PerAxis::default());
    (params, axes, JogDemand::default())
}

#[test]
fn b5_a_jog_key_without_refresh_lets_go() {
    let (params, mut axes, mut jog) = begin();
    let silence = Micros::from_millis_f64(params.get(param::JOG_KEEP_ALIVE));
    jog.press_jog_key(Axis::X, 1.0, Micros::ZERO);
    assert!(!jog.tick(&mut axes, silence, &params, LIMITS) && jog.is_active());
    jog.keep_alive(Key::XMinus, silence);
    assert!(jog.tick(&mut axes, silence + Micros(1), &params, LIMITS), "another key does not refresh it");
    assert!(!jog.is_active());
    jog.press_jog_key(Axis::X, 1.0, Micros::ZERO);
    jog.keep_alive(Key::XPlus, silence);
    assert!(!jog.tick(&mut axes, silence + Micros(1), &params, LIMITS) && jog.is_active());
}

#[test]
fn k2_3_detents_add_up_and_stop_at_the_soft_limit_of_a_homed_axis() {
    let (params, mut axes, mut jog) = begin();
    axes.finish_homing(Axis::Z, &params);
    let (low, _) = soft_limits(&params, Axis::Z);
    jog.move_by(Axis::Z, -0.1, &axes, &params);
    jog.move_by(Axis::Z, -0.1, &axes, &params);
    assert!((jog.target(Axis::Z).unwrap_or_default() + 0.2).abs() < 1e-12);
    jog.move_by(Axis::Z, -1e6, &axes, &params);
    assert!((jog.target(Axis::Z).unwrap_or_default() - low).abs() < 1e-12);
    jog.stop_all();
    assert!(!jog.is_active());
}
