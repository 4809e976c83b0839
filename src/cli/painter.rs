//! Who paints the screen for a browser. A build without a screen has no picture.

use super::args::SharedArgs;
use crate::gateway::Painter;

/// A painter of the screen as PNG files; with the settings as they were at the start.
#[cfg(feature = "hmi")]
pub fn painter(shared: &SharedArgs) -> Option<Painter> {
    use super::setup;
    use crate::hmi::offscreen::OffscreenHmi;

    /// Size of the pictures.
    const SIZE: (u32, u32) = (1_024, 768);

    // A spectator cannot move the part of a zoomed screen.
    let (mut stage, shared) = (None, SharedArgs { zoom: None, ..shared.clone() });
    Some(Box::new(move |snapshot| {
        let stage = stage.get_or_insert_with(|| OffscreenHmi::new(setup::screen(&shared), SIZE));
        // What the page asks the control for when it opens is not sent: this is a view. It is complete in its second frame.
        (0..2).for_each(|_| drop(stage.frame(snapshot)));
        let mut png = std::io::Cursor::new(Vec::new());
        stage.picture().write_to(&mut png, image::ImageFormat::Png).ok()?;
        Some(png.into_inner())
    }))
}

/// A painter of the screen as PNG files.
#[cfg(not(feature = "hmi"))]
pub const fn painter(_: &SharedArgs) -> Option<Painter> {
    None
}
