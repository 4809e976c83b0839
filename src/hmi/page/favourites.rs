//! Favourites: what the operator keeps on the home page, with live values. The key KEEP of the help and its search keeps an
//! entry, and lets it go again.
//! Source: spec H7; issue "the face", part 7.

use egui::Rect;

use super::variables::{entry_page, variable_label};
use super::{HandOver, PageContext};
use crate::defs::favourite::{Favourite, MAX_FAVOURITES};
use crate::defs::page::Page;
use crate::defs::param_row;
use crate::hmi::{Area, View, keycap, theme};
use crate::link::Command;
use crate::link::page_command::PageCommand;
use crate::link::snapshot::DirectoryRow;

/// Height of the row on the home page: a touch target with two lines of words.
pub const HEIGHT: f32 = 58.0;
/// Height of the upper of the two lines.
const NAME_HEIGHT: f32 = 22.0;

/// The favourites after one was kept, or after a kept one was let go; `None` if there is no room for more.
pub fn toggled(kept: &[Favourite], favourite: &Favourite) -> Option<Vec<Favourite>> {
    if kept.contains(favourite) {
        return Some(kept.iter().filter(|other| *other != favourite).cloned().collect());
    }
    (kept.len() < MAX_FAVOURITES).then(|| kept.iter().chain([favourite]).cloned().collect())
}

/// The page of a favourite, and what it shows first; `None` if this machine or its folder lacks it.
pub fn target(view: &View<'_>, favourite: &Favourite) -> Option<(Page, Option<HandOver>)> {
    let machine = view.snapshot.fitted();
    let (page, what) = match favourite {
        Favourite::Page(page) => (*page, None),
        Favourite::Param(at) => {
            param_row::name_of(*at, machine)?;
            (Page::Params, Some(HandOver::Param(*at)))
        }
        Favourite::Variable(number) => (entry_page(view, *number), Some(HandOver::Variable(*number))),
        Favourite::Program(name) => (Page::Directory, Some(HandOver::Program(program(view, name)?.number))),
    };
    page.exists_on(machine).then_some((page, what))
}

fn program<'a>(view: &View<'a>, name: &str) -> Option<&'a DirectoryRow> {
    view.snapshot.directory.iter().find(|row| row.name == name)
}

/// Draws the row, and opens what is touched; what is gone is let go.
pub fn ui(rect: Rect, ctx: &mut PageContext<'_>) {
    let view = ctx.view;
    if view.favourites.is_empty() {
        let words = view.text(
            "收藏：查找 (/) 一个页面、参数、变量或程序，按「收藏」，它就在这里",
            "favourites: search (/) a page, parameter, variable or program and press KEEP; it is here then",
        );
        return view.note(rect, words);
    }
    for (index, favourite) in view.favourites.iter().take(MAX_FAVOURITES).enumerate() {
        if !tile(view, rect.cell(index, MAX_FAVOURITES), index, favourite) {
            continue;
        }
        match target(view, favourite) {
            Some((page, what)) => {
                *ctx.hand_over = what;
                ctx.out.push(Command::OpenPage(page));
            }
            // The search finds it no more: it is let go here.
            None => {
                ctx.out.extend(toggled(view.favourites, favourite).map(PageCommand::SetFavourites).map(Command::Page))
            }
        }
    }
}

/// What a favourite shows: its code and name, and below it the larger text; an empty one leaves both lines to the name.
struct Caption {
    code: String,
    name: String,
    value: String,
}

fn caption(view: &View<'_>, favourite: &Favourite) -> Caption {
    if target(view, favourite).is_none() {
        let code = favourite.to_string();
        let code = code.split_once(' ').map_or(code.as_str(), |(_, name)| name);
        let value = view.text("没有了，碰一下取下", "gone: touch to remove").to_owned();
        return Caption { code: code.to_owned(), name: String::new(), value };
    }
    let (code, name, value) = match favourite {
        Favourite::Page(page) => {
            let title = page.title_on(view.snapshot.kind).get(view.lang);
            (String::new(), String::new(), title.to_owned())
        }
        Favourite::Param(at) => {
            let name = param_row::name_of(*at, view.snapshot.fitted()).map(|name| name.get(view.lang).into_owned());
            let value = view.snapshot.params.read(*at).map_or_else(|_| "—".to_owned(), |value| value.to_string());
            (at.to_string(), name.unwrap_or_default(), value)
        }
        Favourite::Variable(number) => {
            (format!("#{number}"), variable_label(view, *number).to_owned(), view.variable(*number))
        }
        Favourite::Program(name) => {
            let comment = program(view, name).map(|row| row.comment_in(view.lang).to_owned());
            (name.clone(), String::new(), comment.unwrap_or_default())
        }
    };
    Caption { code, name, value }
}

/// True if it was touched.
fn tile(view: &View<'_>, rect: Rect, index: usize, favourite: &Favourite) -> bool {
    let Caption { code, name, value } = caption(view, favourite);
    let response = keycap::plain(view, rect, ("favourite", index), format!("{favourite} {value}"));
    let inside = rect.shrink2(egui::vec2(8.0, 6.0));
    let ink = if target(view, favourite).is_some() { view.theme.text } else { view.theme.muted };
    if code.is_empty() {
        view.text_rows(inside, &value, theme::LABEL, ink, 2);
        return response.clicked();
    }
    let (above, below) = inside.split_top(NAME_HEIGHT);
    let of_code = view.fit_left(above, &code, theme::SMALL, view.theme.info);
    view.fit_left(above.with_min_x(of_code.max.x + 4.0), &name, theme::SMALL, view.theme.muted);
    view.fit_left(below, &value, theme::TITLE, ink);
    response.clicked()
}
