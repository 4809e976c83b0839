//! temporary
#[path = "../tests/hmi_sample/mod.rs"]
mod hmi_sample;
use kt830::defs::page::Page;
use kt830::defs::text::Lang;
fn main() {
    let dir = std::env::args().nth(1).unwrap_or("/tmp/w/shots".into());
    let _ = std::fs::create_dir_all(&dir);
    for (w, h) in [(1024, 768), (1280, 800), (1920, 1080), (768, 1024)] {
        for page in Page::ALL {
            let s = if *page == Page::Grinding { hmi_sample::snapshot(*page) } else { hmi_sample::running(*page) };
            kt830::hmi::shot(&s, Lang::Zh, (w, h)).save(format!("{dir}/{}_{w}.png", page.id())).ok();
        }
    }
    kt830::hmi::shot(&hmi_sample::alarm(Page::Grinding), Lang::En, (1024, 768)).save(format!("{dir}/en_1024.png")).ok();
}
