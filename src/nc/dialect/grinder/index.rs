//! The index of a macro program: block numbers, also behind a `;`, WHILE loops, and the texts that it shows. Source: spec B1, B3.

use crate::nc::source_index::{
    LOOP_DEPTH, LoopEnd, SourceIndex, TextLines, WhileLoop, block_head, leading_number, starts_with_word,
};
use crate::nc::statement;

/// Indexes a text.
pub(super) fn index(lines: &TextLines<'_>, index: &mut SourceIndex) {
    let mut open = OpenLoops::default();
    let divided = lines.text.contains(&b';');
    for (_, start, line) in lines.iter() {
        let (n, rest) = block_head(line, true);
        open.closed = None;
        if let Some(n) = n {
            index.block_numbers.push((n, start as u32));
        }
        let end = start + line.len();
        match rest.first() {
            Some(b'W' | b'w' | b'E' | b'e' | b'D' | b'd') => open.visit_block(&mut index.while_loops, rest, start, end),
            Some(b'#') if rest.get(1) != Some(&b'3') => {}
            Some(b'#' | b'I' | b'i') => index_messages(index, rest, end - rest.len()),
            _ => {}
        }
        if divided && line.contains(&b';') {
            index_rest_of_line(index, &lines.text[..end], start, &mut open);
        }
    }
    index.sort_block_numbers();
}

/// The texts of `#3000=n(text)` and `#3006=n(text)` in a line that begins with them or with IF.
fn index_messages(index: &mut SourceIndex, line: &[u8], start: usize) {
    let is_message = |word: &[u8]| word == b"#3000" || word == b"#3006";
    let mut at = 0;
    while let Some(found) = line[at..].windows(5).position(is_message) {
        at += found + 5;
        let Some(open) = line[at..].iter().position(|byte| *byte == b'(') else { return };
        at += open + 1;
        let Some(length) = line[at..].iter().position(|byte| *byte == b')') else { return };
        index.message_texts.push(((start + at) as u32, (start + at + length) as u32));
        at += length;
    }
}

/// Block numbers and loops behind the `;` of a line. The text ends with the line.
#[cold]
fn index_rest_of_line(index: &mut SourceIndex, text: &[u8], start: usize, open: &mut OpenLoops) {
    let mut at = start;
    while let Some(next) = statement::next_block_on_line(text, at, at > start) {
        // The previous block ends here. If it is an END, this is the block after the loop.
        let closed = open.closed.and_then(|closed| index.while_loops.get_mut(closed));
        if let Some(end) = closed.and_then(|found| found.end.as_mut()) {
            end.after = next as u32;
        }
        let (n, rest) = block_head(&text[next..], true);
        index.inner_block_numbers.extend(n.map(|n| (n, next as u32)));
        open.visit_block(&mut index.while_loops, rest, next, text.len());
        at = next;
    }
}

/// The loops that are open while the text is indexed.
#[derive(Default)]
struct OpenLoops {
    loops: [usize; LOOP_DEPTH],
    depth: usize,
    /// The loop that the last block closed.
    closed: Option<usize>,
}

impl OpenLoops {
    /// Opens or closes a loop if the block is a WHILE, DO or END. `end` is the end of its line.
    fn visit_block(&mut self, loops: &mut Vec<WhileLoop>, block: &[u8], at: usize, end: usize) {
        self.closed = None;
        if starts_with_word(block, b"WH") || starts_with_word(block, b"DO") {
            let outer = self.depth.checked_sub(1).map(|top| self.loops[top] as u32);
            if let Some(place) = self.loops.get_mut(self.depth) {
                *place = loops.len();
                self.depth += 1;
            }
            loops.push(WhileLoop { number: do_number(block), while_at: at as u32, end: None, outer });
        } else if starts_with_word(block, b"END") {
            let number = leading_number(&block[3..], true).unwrap_or(0) as u8;
            let Some(index) = self.depth.checked_sub(1).map(|top| self.loops[top]) else { return };
            if let Some(place) = loops.get_mut(index).filter(|place| place.number == number) {
                place.end = Some(LoopEnd { at: at as u32, after: end as u32 });
                self.closed = Some(index);
                self.depth -= 1;
            }
        }
    }
}

/// The number after the last DO of a block, 0 if there is none.
fn do_number(block: &[u8]) -> u8 {
    let end = block.iter().position(|byte| matches!(byte, b'\r' | b'\n' | b';')).unwrap_or(block.len());
    let block = &block[..end];
    let place = block.windows(2).rposition(|pair| pair.eq_ignore_ascii_case(b"DO"));
    place.and_then(|place| leading_number(&block[place + 2..], true)).map_or(0, |number| number.min(255) as u8)
}
