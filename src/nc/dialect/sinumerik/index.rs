//! The index of an 802D program: its block numbers, jump labels and the texts that it shows. Source: spec S1.

use super::expression::identifier;
use super::read::message_range;
use crate::defs::program_number;
use crate::nc::dialect::rules::ProgramHeading;
use crate::nc::lexer::Cursor;
use crate::nc::source_index::{SourceIndex, TextLines, after_blanks, block_head, starts_with_word};

/// Indexes a text.
pub(super) fn index(lines: &TextLines<'_>, index: &mut SourceIndex) {
    for (line, start, text) in lines.iter() {
        let (n, mut head) = block_head(text, false);
        index.block_numbers.extend(n.map(|n| (n, start as u32)));
        if let Some((name, behind)) = leading_label(head) {
            index.jump_labels.push((name.to_ascii_uppercase().into_boxed_slice(), line));
            head = after_blanks(behind, false);
        }
        if starts_with_word(head, b"MSG") {
            let at = start + text.len() - head.len();
            let message = message_range(&mut Cursor::window(lines.text, at + 3)).ok();
            index.message_texts.extend(message.map(|range| (range.start as u32, range.end as u32)));
        }
    }
    index.sort_block_numbers();
    index.jump_labels.sort_unstable();
    index.message_texts.sort_unstable();
}

/// The label at the start of a block, and the text behind its `:`.
fn leading_label(text: &[u8]) -> Option<(&[u8], &[u8])> {
    let name = identifier(text)?;
    let behind = after_blanks(&text[name.len()..], false).strip_prefix(b":")?;
    Some((name, behind))
}

/// The name in the line that begins a program of an archive: `%_N_L10_SPF`.
pub(super) fn program_heading(line: &[u8]) -> Option<ProgramHeading> {
    let word = line.trim_ascii().strip_prefix(b"%_N_")?;
    let (stem, extension) = std::str::from_utf8(word).ok()?.rsplit_once('_')?;
    let (stem, extension) = (stem.to_ascii_uppercase(), extension.to_ascii_uppercase());
    let known = ["MPF", "SPF"].contains(&extension.as_str()) && !stem.is_empty();
    known.then(|| (program_number::from_name(&stem), Some(format!("{stem}.{extension}"))))
}

#[cfg(test)]
mod tests {
    use crate::nc::settings::Dialect;
    use crate::nc::source::Source;

    #[test]
    fn s1_an_802d_text_has_labels_and_neither_loops_nor_bracket_comments() {
        let text = "AB1:G0\nN20 CD2: X=(R1)\n; EF3:\nN40 G22\nG80 M2\nNEXT: G0\nN60 NUM_1:G0\n";
        let source = Source::new(1, "T.TXT", text.as_bytes(), Dialect::Sinumerik);
        assert_eq!(source.find_label(0..3, 5, false).ok(), Some(0));
        assert_eq!(source.find_label(11..14, 0, true).ok(), Some(1));
        let label = |name: &str| {
            let at = text.find(name).unwrap();
            source.find_label(at..at + name.len(), 0, true).ok()
        };
        assert_eq!((label("NEXT"), label("NUM_1")), (Some(5), Some(6)));
        assert_eq!((source.find_block(20, 0), source.find_block(6, 0)), (Some(7), None));
        assert_eq!((source.counted_loop_at(3), source.main_end_line()), (None, None));
        assert_eq!(source.comment_title().as_deref(), Some("EF3:"));
    }
}
