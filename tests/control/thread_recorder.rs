//! The lead error of a thread, measured while it is cut.

use kt830::controller::axes::thread_recorder::ThreadRecorder;

#[test]
fn l5_the_error_of_a_thread_is_measured_after_three_leads() {
    let mut recorder = ThreadRecorder::default();
    recorder.measure(1.0, Some(0.0));
    recorder.finish();
    assert!(recorder.threads().is_empty(), "nothing was cut");
    recorder.begin(7, 2.0, 10.0);
    recorder.measure(7.0, Some(6.0)); // in the run-up: not counted
    for (z, nominal) in [(4.0, 3.99), (0.0, 0.005), (-4.0, -4.0)] {
        recorder.measure(z, Some(nominal));
    }
    recorder.measure(-6.0, None); // in the run-out
    recorder.finish();
    let [cut] = recorder.threads() else { panic!("{:?}", recorder.threads()) };
    assert_eq!((cut.line, cut.lead_mm.to_bits()), (7, 2.0_f64.to_bits()));
    assert!((cut.length_mm - 14.0).abs() < 1e-12 && (cut.error_mm - 0.015).abs() < 1e-12, "{cut:?}");
}
