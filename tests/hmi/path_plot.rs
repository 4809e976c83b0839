//! `kt830 plot-path`: the picture of a path and its figures. Source: docs/motion.md, tools.md.

use crate::command::kt830_in;
use image::Rgb;

const CONTOUR: &str = "(line, radius, corner)\nG64 G98\nG01 W-10 F3000\nG03 U-4 W-2 R2\nG01 U-10\nG01 W-10\nM30\n";
/// The colours of the set-points and of the limits.
const PATH: Rgb<u8> = Rgb([0, 114, 178]);
const LIMIT: Rgb<u8> = Rgb([180, 30, 30]);

/// Status, output, errors and the pixels of a colour in the left and in the right half of the picture.
fn plotted(words: &[&str]) -> (Option<i32>, String, String, impl Fn(Rgb<u8>) -> [usize; 2] + use<>) {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("O0500.NC"), CONTOUR).unwrap();
    let words = [&["plot-path", "O0500.NC", "--out", "path.png", "--lang", "en", "--size", "1280x800"], words].concat();
    let out = kt830_in(folder.path(), folder.path(), &words);
    let picture = image::open(folder.path().join("path.png")).map(|picture| picture.to_rgb8()).unwrap_or_default();
    let count = move |colour: Rgb<u8>| {
        let mut halves = [0, 0];
        picture
            .enumerate_pixels()
            .filter(|(.., at)| **at == colour)
            .for_each(|(x, ..)| halves[(x / 640) as usize] += 1);
        halves
    };
    (
        out.status.code(),
        String::from_utf8_lossy(&out.stdout).into_owned(),
        String::from_utf8_lossy(&out.stderr).into_owned(),
        count,
    )
}

#[test]
fn b2_a_path_is_drawn_with_its_band_and_limits() {
    let (status, told, _, count) = plotted(&[]);
    assert_eq!(status, Some(0), "{told}");
    let number = |before: &str, behind: &str| -> f64 {
        let from = told.find(before).unwrap() + before.len();
        told[from..].split(behind).next().unwrap().trim().parse().unwrap()
    };
    // 10 + π + 5 + 10 mm at 50 mm/s are 0.563 s; with ramps and corners less than three times that.
    let seconds = number("path.png: ", " s");
    assert!((0.563..1.7).contains(&seconds), "{told}");
    let deviation_um = number("deviation up to ", " µm");
    assert!((1.0..=10.0).contains(&deviation_um), "{told}");
    // The path on the left, curves and dashed limits on the right alone.
    let ([path_left, path_right], [limit_left, limit_right]) = (count(PATH), count(LIMIT));
    assert!(path_left > 100 && path_right > 100, "{path_left} {path_right}");
    assert!(limit_left == 0 && limit_right > 100, "{limit_left} {limit_right}");
}

#[test]
fn b2_a_part_of_a_path_and_the_refusals() {
    let (status, told, ..) = plotted(&["--lines", "4-4"]);
    assert_eq!(status, Some(0), "{told}");
    // π mm of arc: 63 ms at the feed, and not the whole contour.
    let seconds: f64 = told.split(": ").nth(1).unwrap().split(' ').next().unwrap().parse().unwrap();
    assert!((0.06..0.3).contains(&seconds), "{told}");
    for (lines, why) in [("20-30", "nothing moves in these lines"), ("9-2", "write the lines as 10-25")] {
        let (status, _, warned, count) = plotted(&["--lines", lines]);
        assert!(status == Some(2) && warned.contains(why) && count(PATH) == [0, 0], "{lines}: {warned}");
    }
}
