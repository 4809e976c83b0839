//! The picture of the open page as a texture, in the colours of the theme. Source: spec K5.12, H4.

use std::sync::Arc;

use egui::{ColorImage, Context, TextureHandle, TextureId, TextureOptions};

use super::theme;
use crate::link::screens::Picture;

/// The picture that is shown.
#[derive(Default)]
pub struct PagePicture {
    /// Whether its colours are those of the light theme, and its texture; none of a picture that is no BMP.
    shown: Option<(Arc<Picture>, bool, Option<TextureHandle>)>,
}

impl PagePicture {
    /// Loads a picture that has come, or whose colours change.
    pub fn follow(&mut self, ctx: &Context, wanted: Option<&Arc<Picture>>, light: bool) {
        let is_shown = |wanted: &Arc<Picture>| {
            self.shown.as_ref().is_some_and(|(shown, of, _)| Arc::ptr_eq(wanted, shown) && *of == light)
        };
        match wanted {
            Some(wanted) if is_shown(wanted) => {}
            Some(wanted) => self.shown = Some((Arc::clone(wanted), light, load(ctx, wanted, light))),
            None => self.shown = None,
        }
    }

    /// Its texture.
    pub fn texture(&self) -> Option<TextureId> {
        self.shown.as_ref().and_then(|(_, _, texture)| texture.as_ref()).map(TextureHandle::id)
    }
}

fn load(ctx: &Context, picture: &Picture, light: bool) -> Option<TextureHandle> {
    let mut rgb = image::load_from_memory_with_format(&picture.0, image::ImageFormat::Bmp).ok()?.into_rgb8();
    if light {
        theme::for_light_theme(&mut rgb);
    }
    let image = ColorImage::from_rgb([rgb.width() as usize, rgb.height() as usize], &rgb);
    Some(ctx.load_texture("page picture", image, TextureOptions::LINEAR))
}
