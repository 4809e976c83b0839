//! The levels of detail of a tool path.

use kt830::link::toolpath::{BoundingBox, MoveKind, PathPoint, Toolpath};

/// A million strokes over 100 mm, each 0.1 µm deeper: a screen shows only some thousands of them.
#[test]
fn h9_a_million_moves_are_some_thousand_on_a_screen() {
    let points = (0..1_000_000_u32).map(|index| {
        let x = if index.is_multiple_of(2) { 0.0 } else { 100.0 };
        let z = index as f32 * 1e-4;
        PathPoint { at: [x, 0.0, z], kind: if index == 0 { MoveKind::Break } else { MoveKind::Feed } }
    });
    let mut drawing = Toolpath::default();
    drawing.set_path(points.collect());
    let coarsest = drawing.levels.last().expect("levels");
    // 100 mm / 2048: each row of cells once in each direction, with its breaks.
    assert!(coarsest.points.len() < 2_048 * 4, "{}", coarsest.points.len());
    // The coarsest level covers the whole path.
    let reaches = |axis: usize, beyond: fn(f32) -> bool| {
        coarsest.chunk_boxes.iter().any(|of| beyond(of.low[axis]) || beyond(of.high[axis]))
    };
    assert!(reaches(0, |x| x > 99.9) && reaches(2, |z| z > 99.9) && reaches(2, |z| z < 0.1));
}

#[test]
fn b6_a_short_path_is_kept_as_it_is() {
    let mut drawing = Toolpath::default();
    let points = vec![
        PathPoint { at: [0.0; 3], kind: MoveKind::Break },
        PathPoint { at: [1.0, 0.0, 2.0], kind: MoveKind::Feed },
    ];
    drawing.set_path(points.clone());
    assert_eq!((drawing.levels.len(), &drawing.levels[0].points), (1, &points));
    assert_eq!(drawing.levels[0].chunk_boxes, [BoundingBox { low: [0.0; 3], high: [1.0, 0.0, 2.0] }]);
}
