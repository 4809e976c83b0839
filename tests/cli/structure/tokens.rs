//! Sources as tokens: what they declare, and how many parameters their functions have.

/// The tokens of a text: words, `::`, `->`, `=>` and single signs. Comments, literals and lifetimes are left out.
pub fn tokens(text: &str) -> Vec<&str> {
    let mut found = with_strings(text);
    found.retain(|token| !token.starts_with('"'));
    found
}

/// The tokens of a text with its plain strings.
pub fn with_strings(text: &str) -> Vec<&str> {
    let bytes = text.as_bytes();
    let word =
        |at: usize| bytes.get(at).is_some_and(|byte| byte.is_ascii_alphanumeric() || *byte == b'_' || *byte >= 128);
    let mut found = Vec::new();
    let mut at = 0;
    while at < bytes.len() {
        let rest = &text[at..];
        let start = at;
        if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at += block_comment(rest);
        } else if let Some(length) = raw_string(rest) {
            at += length;
        } else if rest.starts_with('"') || rest.starts_with("b\"") {
            at += quoted(rest, b'"');
            found.extend(rest.starts_with('"').then(|| &text[start..at]));
        } else if let Some(inside) = rest.strip_prefix('\'') {
            // A character, else a lifetime: `'a'`, `'\n'`, `'值'`; `'a`.
            let character = inside.starts_with('\\') || inside.chars().nth(1) == Some('\'');
            at += 1;
            if character {
                at += quoted(rest, b'\'') - 1;
            } else {
                at += (at..).take_while(|at| word(*at)).count();
            }
        } else if word(at) {
            at += (at..).take_while(|at| word(*at)).count();
            found.push(&text[start..at]);
        } else if ["::", "->", "=>"].iter().any(|sign| rest.starts_with(sign)) {
            at += 2;
            found.push(&text[start..at]);
        } else {
            at += 1;
            if !bytes[start].is_ascii_whitespace() {
                found.push(&text[start..at]);
            }
        }
    }
    found
}

/// Length of a block comment, with those inside it.
fn block_comment(text: &str) -> usize {
    let (mut depth, mut at) = (0, 0);
    loop {
        let rest = &text.as_bytes()[at..];
        match rest {
            [b'/', b'*', ..] => (depth, at) = (depth + 1, at + 2),
            [b'*', b'/', ..] => (depth, at) = (depth - 1, at + 2),
            [] => return at,
            _ => at += 1,
        }
        if depth == 0 {
            return at;
        }
    }
}

/// Length of a raw string, if the text begins with one.
fn raw_string(text: &str) -> Option<usize> {
    let hashes = text.strip_prefix('r').or_else(|| text.strip_prefix("br"))?;
    let inside = hashes.trim_start_matches('#');
    let end = format!("\"{}", "#".repeat(hashes.len() - inside.len()));
    let body = inside.strip_prefix('"')?;
    Some(text.len() - body.len() + body.find(&end).map_or(body.len(), |at| at + end.len()))
}

/// Length of a literal up to its closing quote, with escapes.
fn quoted(text: &str, quote: u8) -> usize {
    let bytes = text.as_bytes();
    let mut at = text.find(char::from(quote)).map_or(text.len(), |at| at + 1);
    while at < bytes.len() && bytes[at] != quote {
        at += if bytes[at] == b'\\' { 2 } else { 1 };
    }
    (at + 1).min(bytes.len())
}

/// The place after the bracket that closes the one at `open`.
pub fn after_bracket(tokens: &[&str], open: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(open) {
        match *token {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth == 0 {
            return at + 1;
        }
    }
    tokens.len()
}

/// The tokens without the items of unit tests.
pub fn without_tests<'a>(tokens: &[&'a str]) -> Vec<&'a str> {
    let mut kept = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        if tokens[at..].starts_with(&["#", "[", "cfg", "(", "test", ")", "]"]) {
            at += 7;
            while at < tokens.len() && tokens[at] != ";" && tokens[at] != "{" {
                at = if tokens[at] == "(" || tokens[at] == "[" { after_bracket(tokens, at) } else { at + 1 };
            }
            at = if tokens.get(at) == Some(&"{") { after_bracket(tokens, at) } else { at + 1 };
        } else {
            kept.push(tokens[at]);
            at += 1;
        }
    }
    kept
}

pub fn is_word(token: &str) -> bool {
    token.starts_with(|sign: char| sign.is_alphabetic() || sign == '_')
}

/// The functions of a text with the numbers of their parameters. `self` is not counted, a tuple counts as its elements.
pub fn functions<'a>(tokens: &[&'a str]) -> Vec<(&'a str, usize)> {
    let heads = tokens.windows(2).enumerate().filter(|(_, pair)| pair[0] == "fn" && is_word(pair[1]));
    heads.map(|(at, pair)| (pair[1], parameters(&tokens[at + 2..]))).collect()
}

/// The number of parameters in a list that stands behind its generics.
fn parameters(tokens: &[&str]) -> usize {
    let mut angles = 0;
    let list = tokens.iter().position(|token| {
        angles += i32::from(*token == "<") - i32::from(*token == ">");
        angles == 0 && *token == "("
    });
    let Some(open) = list else { return 0 };
    let list = &tokens[open + 1..after_bracket(tokens, open) - 1];
    let parameters = starts(list).into_iter().map(|at| {
        let name = at + unqualified(&list[at..]);
        if list.get(name) == Some(&"self") {
            return 0;
        }
        let behind = if list.get(name + 1) == Some(&":") { name + 2 } else { name };
        elements(&list[behind + unqualified(&list[behind..])..])
    });
    parameters.sum()
}

/// Where the elements of a list begin, between commas outside brackets.
fn starts(list: &[&str]) -> Vec<usize> {
    let (mut depth, mut fresh, mut starts) = (0, true, Vec::new());
    for (at, token) in list.iter().enumerate() {
        match *token {
            "(" | "[" | "{" | "<" => depth += 1,
            ")" | "]" | "}" | ">" => depth -= 1,
            "," if depth == 0 => {
                fresh = true;
                continue;
            }
            _ => {}
        }
        if std::mem::take(&mut fresh) {
            starts.push(at);
        }
    }
    starts
}

/// Where `&` and `mut` end.
fn unqualified(tokens: &[&str]) -> usize {
    tokens.iter().take_while(|token| ["&", "mut"].contains(*token)).count()
}

/// The number of elements of the tuple at the head; 1 if there is none.
fn elements(tokens: &[&str]) -> usize {
    if tokens.first() != Some(&"(") {
        return 1;
    }
    starts(&tokens[1..after_bracket(tokens, 0) - 1]).len().max(1)
}

/// The types, functions and modules that a text declares: keyword and name.
pub fn declared<'a>(tokens: &[&'a str]) -> Vec<(&'a str, &'a str)> {
    const NAMED: &[&str] = &["struct", "enum", "union", "trait", "type", "fn", "mod"];
    tokens
        .windows(2)
        .filter(|pair| NAMED.contains(&pair[0]) && is_word(pair[1]))
        .map(|pair| (pair[0], pair[1]))
        .collect()
}

/// The types that a text defines, without those of unit tests and without associated types.
pub fn types<'a>(tokens: &[&'a str]) -> Vec<&'a str> {
    let tokens = without_tests(tokens);
    let mut depth = 0;
    let mut found = Vec::new();
    for pair in tokens.windows(2) {
        depth += i32::from(pair[0] == "{") - i32::from(pair[0] == "}");
        let defines = ["struct", "enum", "union", "trait"].contains(&pair[0]) || pair[0] == "type" && depth == 0;
        if defines && is_word(pair[1]) {
            found.push(pair[1]);
        }
    }
    found
}

#[test]
fn parameters_are_counted_beside_self() {
    let count = |text: &'static str| functions(&tokens(text));
    assert_eq!(count("fn f(a: u8, b: u8, c: u8, d: u8, e: u8, f: u8) {}"), [("f", 6)]);
    assert_eq!(count("fn f(&mut self, a: (u8, u8), b: Map<u8, [u8; 2]>,) {}"), [("f", 3)]);
    assert_eq!(count("fn f((a, mut b): (A, Map<u8, B>), c: &mut (dyn Fn(u8, u8)), d: &(C, [D; 2],)) {}"), [("f", 5)]);
    assert_eq!(count("fn f<'a, F: Fn(u8, u8) -> u8>(&'a self, run: impl Fn(u8, u8) -> u8, last: u8) {}"), [("f", 2)]);
    assert_eq!(
        count("fn f(self: Box<Self>); fn g(); type F = fn(u8, u8); fn h(Pair { a, b }: Pair) {}"),
        [("f", 0), ("g", 0), ("h", 1)]
    );
}

#[test]
fn a_name_is_declared_by_its_keyword() {
    let text =
        "pub enum Post {} impl Path for Post {} fn happen() { let mst_lock = Path::new(\"struct Tube\"); } mod x;";
    assert_eq!(declared(&tokens(text)), [("enum", "Post"), ("fn", "happen"), ("mod", "x")]);
}

#[test]
fn associated_types_and_those_of_tests_are_not_defined() {
    let text = "pub struct A<T> {} mod inner { enum B {} } type C = A<u8>; trait D { type E; } impl D for A { type E = u8; }\n\
        #[cfg(test)] mod tests { struct A; } fn f(union: &str) -> &'static str { \"struct F\" }";
    assert_eq!(types(&tokens(text)), ["A", "B", "C", "D"]);
}
