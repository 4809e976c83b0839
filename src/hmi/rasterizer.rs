//! Software rasterizer for egui's triangles: the pictures of `shot` and of the tests, without display or driver.
//! The same input gives the same bytes on every machine: edges use integers, colours have eight bits.
//! Colours are multiplied and blended in gamma space with premultiplied alpha, as in egui's own painters.

use std::collections::HashMap;

use egui::epaint::{ClippedPrimitive, ImageData, ImageDelta, Primitive, Vertex};
use egui::{Color32, Mesh, Rect, TextureFilter, TextureId, TexturesDelta};
use image::{Rgba, RgbaImage};

/// Sub-pixel steps per pixel of a vertex position.
const SUBPIXEL_STEPS: f32 = 256.0;

/// One texture.
struct Texture {
    size: [usize; 2],
    pixels: Vec<Color32>,
    nearest: bool,
}

/// Paints frames; keeps the textures between frames.
#[derive(Default)]
pub struct Rasterizer {
    textures: HashMap<TextureId, Texture>,
}

impl Rasterizer {
    /// Applies new and changed textures of a frame.
    pub fn update(&mut self, delta: &TexturesDelta) {
        for (id, changes) in &delta.set {
            changes.iter().for_each(|change| self.apply(*id, change));
        }
    }

    /// Frees the textures that are no longer needed. Call it after painting.
    pub fn free(&mut self, delta: &TexturesDelta) {
        for id in &delta.free {
            self.textures.remove(id);
        }
    }

    fn apply(&mut self, id: TextureId, change: &ImageDelta) {
        let ImageData::Color(image) = &change.image;
        let Some([left, top]) = change.pos else {
            let nearest = change.options.magnification == TextureFilter::Nearest;
            self.textures.insert(id, Texture { size: image.size, pixels: image.pixels.clone(), nearest });
            return;
        };
        let Some(texture) = self.textures.get_mut(&id) else { return };
        let [width, height] = image.size;
        for row in 0..height {
            let from = row * width;
            let to = (top + row) * texture.size[0] + left;
            if let (Some(source), Some(target)) =
                (image.pixels.get(from..from + width), texture.pixels.get_mut(to..to + width))
            {
                target.copy_from_slice(source);
            }
        }
    }

    /// Paints tessellated shapes on a background colour.
    #[must_use]
    pub fn paint(&self, primitives: &[ClippedPrimitive], scale: f32, size: (u32, u32), ground: Color32) -> RgbaImage {
        let mut picture = RgbaImage::from_pixel(size.0, size.1, Rgba([ground.r(), ground.g(), ground.b(), 255]));
        for primitive in primitives {
            if let Primitive::Mesh(mesh) = &primitive.primitive
                && let Some(texture) = self.textures.get(&mesh.texture_id)
            {
                paint_mesh(&mut picture, mesh, texture, scale, &Clip::new(primitive.clip_rect, scale, size));
            }
        }
        picture
    }
}

/// The pixels inside the clip rectangle.
struct Clip {
    left: i64,
    top: i64,
    right: i64,
    bottom: i64,
}

impl Clip {
    fn new(rect: Rect, scale: f32, size: (u32, u32)) -> Self {
        let side = |value: f32, limit: u32| ((value * scale).round().clamp(0.0, limit as f32)) as i64;
        let (left, top) = (side(rect.min.x, size.0), side(rect.min.y, size.1));
        Self { left, top, right: side(rect.max.x, size.0), bottom: side(rect.max.y, size.1) }
    }
}

fn paint_mesh(picture: &mut RgbaImage, mesh: &Mesh, texture: &Texture, scale: f32, clip: &Clip) {
    for corners in mesh.indices.chunks_exact(3) {
        let corner = |index: u32| mesh.vertices.get(index as usize);
        if let (Some(a), Some(b), Some(c)) = (corner(corners[0]), corner(corners[1]), corner(corners[2])) {
            triangle(picture, [a, b, c], texture, scale, clip);
        }
    }
}

/// A vertex on the sub-pixel grid.
#[derive(Clone, Copy)]
struct SubPixelPoint {
    x: i64,
    y: i64,
}

/// Twice the signed area of the triangle a, b, p.
const fn edge(a: SubPixelPoint, b: SubPixelPoint, p: SubPixelPoint) -> i64 {
    (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x)
}

/// Top-left rule: whether pixels exactly on this edge belong to the triangle. Each shared edge is painted once.
const fn is_top_left_edge(a: SubPixelPoint, b: SubPixelPoint) -> bool {
    (a.y == b.y && b.x > a.x) || b.y < a.y
}

fn triangle(picture: &mut RgbaImage, corners: [&Vertex; 3], texture: &Texture, scale: f32, clip: &Clip) {
    let place = |vertex: &Vertex| SubPixelPoint {
        x: (vertex.pos.x * scale * SUBPIXEL_STEPS).round() as i64,
        y: (vertex.pos.y * scale * SUBPIXEL_STEPS).round() as i64,
    };
    let mut corners = corners;
    let mut points = corners.map(place);
    if edge(points[0], points[1], points[2]) < 0 {
        corners.swap(1, 2);
        points.swap(1, 2);
    }
    let area = edge(points[0], points[1], points[2]);
    if area == 0 {
        return;
    }
    let uv = corners[0].uv;
    let flat = corners[1..].iter().all(|other| other.uv == uv).then(|| texture.sample(uv.x, uv.y));
    let shade = TriangleShader::new(corners, area as f32);
    let steps = SUBPIXEL_STEPS as i64;
    let low = |pick: fn(&SubPixelPoint) -> i64| points.iter().map(pick).min().unwrap_or(0).div_euclid(steps);
    let high = |pick: fn(&SubPixelPoint) -> i64| points.iter().map(pick).max().unwrap_or(0).div_euclid(steps) + 1;
    let bias = [(1, 2), (2, 0), (0, 1)].map(|(a, b)| if is_top_left_edge(points[a], points[b]) { 0 } else { -1 });
    for y in low(|p| p.y).max(clip.top)..high(|p| p.y).min(clip.bottom) {
        for x in low(|p| p.x).max(clip.left)..high(|p| p.x).min(clip.right) {
            let here = SubPixelPoint { x: x * steps + steps / 2, y: y * steps + steps / 2 };
            let weights =
                [edge(points[1], points[2], here), edge(points[2], points[0], here), edge(points[0], points[1], here)];
            if weights.iter().zip(bias).all(|(weight, bias)| weight + bias >= 0) {
                let source = shade.colour(weights, texture, flat);
                blend(picture.get_pixel_mut(x as u32, y as u32), source);
            }
        }
    }
}

/// Interpolates colour and texture coordinates across a triangle.
struct TriangleShader {
    colours: [[f32; 4]; 3],
    uvs: [[f32; 2]; 3],
    area: f32,
}

impl TriangleShader {
    fn new(corners: [&Vertex; 3], area: f32) -> Self {
        Self {
            colours: corners.map(|corner| corner.color.to_array().map(f32::from)),
            uvs: corners.map(|corner| [corner.uv.x, corner.uv.y]),
            area,
        }
    }

    fn colour(&self, weights: [i64; 3], texture: &Texture, flat: Option<[f32; 4]>) -> [f32; 4] {
        let part = weights.map(|weight| weight as f32 / self.area);
        let mix = |values: [f32; 3]| values[0] * part[0] + values[1] * part[1] + values[2] * part[2];
        let texel = flat.unwrap_or_else(|| {
            let u = mix([self.uvs[0][0], self.uvs[1][0], self.uvs[2][0]]);
            let v = mix([self.uvs[0][1], self.uvs[1][1], self.uvs[2][1]]);
            texture.sample(u, v)
        });
        std::array::from_fn(|channel| {
            mix([self.colours[0][channel], self.colours[1][channel], self.colours[2][channel]]) * texel[channel] / 255.0
        })
    }
}

impl Texture {
    fn texel(&self, x: i64, y: i64) -> [f32; 4] {
        let column = x.clamp(0, self.size[0] as i64 - 1) as usize;
        let row = y.clamp(0, self.size[1] as i64 - 1) as usize;
        self.pixels.get(row * self.size[0] + column).map_or([0.0; 4], |pixel| pixel.to_array().map(f32::from))
    }

    /// The texture at coordinates from 0 to 1: bilinear between four texels, or the nearest texel.
    fn sample(&self, u: f32, v: f32) -> [f32; 4] {
        let (x, y) = (u * self.size[0] as f32, v * self.size[1] as f32);
        if self.nearest {
            return self.texel(x.floor() as i64, y.floor() as i64);
        }
        // Coordinates snap to 1/64 texel: a sample at the centre of a texel must not mix in its neighbour.
        let snap = |value: f32| ((value - 0.5) * 64.0).round() / 64.0;
        let (x, y) = (snap(x), snap(y));
        let (column, row) = (x.floor() as i64, y.floor() as i64);
        let (right, down) = (x - x.floor(), y - y.floor());
        let [a, b] = [self.texel(column, row), self.texel(column + 1, row)];
        let [c, d] = [self.texel(column, row + 1), self.texel(column + 1, row + 1)];
        std::array::from_fn(|i| {
            let (above, below) = (a[i] + (b[i] - a[i]) * right, c[i] + (d[i] - c[i]) * right);
            above + (below - above) * down
        })
    }
}

fn blend(target: &mut Rgba<u8>, source: [f32; 4]) {
    let keep = 1.0 - source[3] / 255.0;
    for (channel, value) in target.0.iter_mut().zip(source).take(3) {
        *channel = (value + f32::from(*channel) * keep + 0.5).clamp(0.0, 255.0) as u8;
    }
}
