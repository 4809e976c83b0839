//! The index of a 超人 program: block numbers, counted loops, and the M02 that ends the main program.
//! Source: spec L1, L4, L7.

use crate::nc::source_index::{CountedLoop, SourceIndex, TextLines, block_head, leading_number, starts_with_word};

/// Indexes a text.
pub(super) fn index(lines: &TextLines<'_>, index: &mut SourceIndex) {
    let mut open = Vec::new();
    for (line, start, text) in lines.iter() {
        let (n, rest) = block_head(text, true);
        index.block_numbers.extend(n.map(|n| (n, start as u32)));
        if is_code(rest, b"G22") {
            open.push(index.counted_loops.len());
            index.counted_loops.push(CountedLoop { line, end_line: None });
        } else if is_code(rest, b"G80")
            && let Some(place) = open.pop().and_then(|begun: usize| index.counted_loops.get_mut(begun))
        {
            place.end_line = Some(line);
        }
        index.main_end_line = index.main_end_line.or_else(|| has_code(text, b'M', 2).then_some(line));
    }
    index.sort_block_numbers();
}

/// Whether a line contains a code outside its comments, with or without leading zeros.
fn has_code(line: &[u8], letter: u8, number: u32) -> bool {
    let mut depth = 0_u32;
    for (at, byte) in line.iter().enumerate() {
        match byte {
            b';' if depth == 0 => return false,
            b'(' => depth += 1,
            b')' => depth = depth.saturating_sub(1),
            _ if depth == 0
                && byte.to_ascii_uppercase() == letter
                && leading_number(&line[at + 1..], true) == Some(number) =>
            {
                return true;
            }
            _ => {}
        }
    }
    false
}

/// Whether a line begins with a code that no further digit follows.
fn is_code(bytes: &[u8], word: &[u8]) -> bool {
    starts_with_word(bytes, word) && !bytes.get(word.len()).is_some_and(u8::is_ascii_digit)
}

#[cfg(test)]
mod tests {
    use crate::nc::settings::Dialect;
    use crate::nc::source::Source;

    #[test]
    fn l7_the_end_of_the_main_program_is_known_when_the_text_is_loaded() {
        let text = "N0010 (M02)\nN0020G22L0002 ;M02\nN0030G80\nN0040M02\nN0050M99\nAA1:M02";
        let source = Source::new(1, "", text.as_bytes(), Dialect::SuperMan);
        assert_eq!(source.main_end_line(), Some(3));
        assert_eq!(source.counted_loop_at(1).and_then(|found| found.end_line), Some(2));
        assert_eq!(source.find_unique_block(50), Ok(Some(4)));
        assert!(source.find_label(54..57, 0, true).is_err(), "this dialect has no labels");
    }
}
