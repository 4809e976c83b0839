//! The structure of the sources: no circle of imports, no wide parameter list, no retired name.
//!
//! The sources are read as tokens. The path of a name is followed through `use` and `pub use` to the file that declares
//! it, so that a circle does not hide behind a re-export. A file and the files below it may import each other.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::path::Path;

/// Most parameters of a function, beside `self`.
const PARAMETERS: usize = 5;
/// Most re-exports from a name to its declaration.
const RE_EXPORTS: usize = 8;

/// Names of an earlier version and what stands in their place; docs/architecture.md has the table. No type, function,
/// module or file has such a name.
#[rustfmt::skip]
const RETIRED: &[(&str, &str)] = &[
    ("System", "Dialect"), ("Frames", "WorkOffsets"), ("Preset", "SetCoordinateSystem"), ("Post", "ToolTurret"),
    ("Proof", "ProgramPreflight"), ("Foresight", "InterlockCheck"), ("foresight", "interlock_check"),
    ("Planned", "LookaheadState"), ("Act", "QueuedAction"), ("Doing", "Activity"), ("Did", "ActionStatus"),
    ("Around", "ControlState"), ("Facts", "InterlockInputs"), ("Path", "TrajectoryPlanner"),
    ("Trail", "SetpointBuffer"), ("Warp", "FeedScaling"), ("Tube", "ToleranceBand"), ("Window", "LookaheadWindow"),
    ("Stroke", "TwoPositionActuator"), ("Hand", "Jog"), ("by_hand", "jog"), ("mst_lock", "aux_function_lock"),
    ("ScrewTable", "LeadscrewCompensation"), ("Effect", "StorageRequest"), ("PageWish", "StorageRequest"),
    ("Office", "JobRunner"), ("Keeper", "RetainedStore"), ("Vault", "PasswordStore"), ("Stick", "UsbDrive"),
    ("Courier", "SerialTransfer"), ("Said", "LocalizedText"), ("Face", "KindUi"), ("Rig", "HeadlessHost"),
    ("happen", "transition"),
];

/// Where a retired name means something else. A file `window` is that of the screen.
const HOMONYMS: &[(&str, &str, &str)] = &[
    ("src/hmi/window.rs", "Window", "the window of the operating system"),
    ("tests/hmi/operators.rs", "Hand", "the operator's hand on the screen"),
    ("tests/sim/bench.rs", "Rig", "a machine alone, without a control"),
];

/// The tokens of a text: words, `::`, `->`, `=>` and single signs. Comments, literals and lifetimes are left out.
fn tokens(text: &str) -> Vec<&str> {
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
        } else if rest.starts_with('\'') {
            // A character, else a lifetime: `'a'`, `'\n'`, `'值'`; `'a`.
            let character = rest[1..].starts_with('\\') || rest.chars().nth(2) == Some('\'');
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
fn after_bracket(tokens: &[&str], open: usize) -> usize {
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
fn without_tests<'a>(tokens: &[&'a str]) -> Vec<&'a str> {
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

fn is_word(token: &str) -> bool {
    token.starts_with(|sign: char| sign.is_alphabetic() || sign == '_')
}

/// A path as written, and the module in which it stands.
struct Mention {
    from: Vec<String>,
    path: Vec<String>,
}

/// What a file declares and mentions.
#[derive(Default)]
struct Module {
    /// Names declared here.
    items: BTreeSet<String>,
    /// Names brought in by `use`, and their paths.
    imports: BTreeMap<String, Vec<String>>,
    /// Paths of `use …::*`.
    globs: Vec<Vec<String>>,
    /// All paths, of `use` and inline.
    mentions: Vec<Mention>,
}

/// Keywords before the name of a declaration.
const DECLARES: &[&str] = &["struct", "enum", "union", "trait", "type", "fn", "mod", "const", "static", "macro_rules"];

/// Reads the file of the module `name`.
fn read_module(name: &[String], text: &str) -> Module {
    let tokens = without_tests(&tokens(text));
    let mut module = Module::default();
    let mut scope = name.to_vec();
    // Where the modules inside the file end.
    let mut ends = Vec::new();
    let mut at = 0;
    while at < tokens.len() {
        while ends.last().is_some_and(|end| at >= *end) {
            ends.pop();
            scope.pop();
        }
        let next = tokens.get(at + 1).copied().unwrap_or_default();
        let begins_path = at == 0 || tokens[at - 1] != "::";
        if tokens[at] == "use" {
            at += 1;
            use_tree(&tokens, &mut at, &mut Vec::new(), &mut |path, alias| module.import(&scope, path, alias));
        } else if tokens[at] == "mod" && tokens.get(at + 2) == Some(&"{") {
            scope.push(next.to_owned());
            ends.push(after_bracket(&tokens, at + 2));
            at += 3;
        } else if DECLARES.contains(&tokens[at]) {
            let declared = if next == "!" || next == "mut" { tokens.get(at + 2) } else { tokens.get(at + 1) };
            module.items.extend(declared.filter(|name| is_word(name)).map(|name| (*name).to_owned()));
            at += 1;
        } else if is_word(tokens[at]) && next == "::" && begins_path {
            let mut path = vec![tokens[at].to_owned()];
            while tokens.get(at + 1) == Some(&"::") && tokens.get(at + 2).is_some_and(|token| is_word(token)) {
                path.push(tokens[at + 2].to_owned());
                at += 2;
            }
            module.mentions.push(Mention { from: scope.clone(), path });
            at += 1;
        } else {
            at += 1;
        }
    }
    module
}

impl Module {
    fn import(&mut self, scope: &[String], path: &[String], alias: Option<&str>) {
        let (last, folder) = path.split_last().unwrap();
        if last == "*" {
            self.globs.push(folder.to_vec());
        } else if let Some(name) = alias.or(Some(last)).filter(|name| *name != "_") {
            self.imports.insert(name.to_owned(), path.to_vec());
        }
        let path = if last == "*" { folder } else { path };
        self.mentions.push(Mention { from: scope.to_vec(), path: path.to_vec() });
    }
}

/// Reads one tree of a `use`, up to its `,`, `}` or `;`, and hands over every path of it with its other name.
fn use_tree(tokens: &[&str], at: &mut usize, path: &mut Vec<String>, found: &mut impl FnMut(&[String], Option<&str>)) {
    let depth = path.len();
    let mut alias = None;
    while let Some(token) = tokens.get(*at).filter(|token| ![",", "}", ";"].contains(*token)) {
        *at += 1;
        if *token == "{" {
            while tokens.get(*at).is_some_and(|token| *token != "}" && *token != ";") {
                use_tree(tokens, at, path, found);
                *at += usize::from(tokens.get(*at) == Some(&","));
            }
            *at += 1;
            return path.truncate(depth);
        }
        match *token {
            "as" => {
                alias = tokens.get(*at).copied();
                *at += 1;
            }
            // `a::{self}` is `a`.
            "self" if !path.is_empty() => {}
            token if is_word(token) || token == "*" => path.push(token.to_owned()),
            _ => {}
        }
    }
    if !path.is_empty() {
        found(path, alias);
    }
    path.truncate(depth);
}

/// The modules of a crate by their paths. The root is the empty path.
struct Crate(BTreeMap<Vec<String>, Module>);

impl Crate {
    /// Reads files, named by their paths below `src`.
    fn read<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
        let module = |(file, text): (&str, &str)| {
            let mut name: Vec<String> = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
            if name == ["lib"] || name.last().is_some_and(|last| last == "mod") {
                name.pop();
            }
            let read = read_module(&name, text);
            (name, read)
        };
        Self(files.into_iter().map(module).collect())
    }

    /// A path from the root of the crate. `None`: it is of another crate.
    fn absolute(&self, from: &[String], path: &[String]) -> Option<Vec<String>> {
        let mut base = from.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" => {
                base.clear();
                rest = &path[1..];
            }
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|word| word == "super") {
                    base.pop();
                    rest = &rest[1..];
                }
            }
            first => {
                base.push(first.to_owned());
                let child = self.0.contains_key(&base);
                base.pop();
                if !child {
                    let import = self.file_of(from).0.imports.get(first)?;
                    if import.first().is_some_and(|word| word == first) {
                        return None;
                    }
                    let mut full = self.absolute(from, import)?;
                    full.extend_from_slice(&path[1..]);
                    return Some(full);
                }
            }
        }
        base.extend_from_slice(rest);
        Some(base)
    }

    /// The file in which a path ends, and what is left of the path behind it.
    fn file_of<'a>(&self, path: &'a [String]) -> (&Module, &'a [String], &'a [String]) {
        let length = (0..=path.len()).rev().find(|length| self.0.contains_key(&path[..*length])).unwrap();
        (&self.0[&path[..length]], &path[..length], &path[length..])
    }

    /// The file that declares a name: re-exports are followed.
    fn declares(&self, path: &[String], re_exports: usize) -> Vec<String> {
        let (module, file, rest) = self.file_of(path);
        let Some(name) = rest.first().filter(|name| !module.items.contains(*name)) else { return file.to_vec() };
        if re_exports == 0 {
            return file.to_vec();
        }
        let behind = |import: &[String], rest: &[String]| {
            let mut full = self.absolute(file, import)?;
            full.extend_from_slice(rest);
            Some(full)
        };
        if let Some(import) = module.imports.get(name) {
            let full = behind(import, &rest[1..]);
            return full.map_or_else(|| file.to_vec(), |full| self.declares(&full, re_exports - 1));
        }
        let of_globs = module.globs.iter().filter_map(|glob| behind(glob, rest)).find(|full| {
            let (target, _, rest) = self.file_of(full);
            rest.first().is_none_or(|name| target.items.contains(name) || target.imports.contains_key(name))
        });
        of_globs.map_or_else(|| file.to_vec(), |full| self.declares(&full, re_exports - 1))
    }

    /// Who imports whom, and by which path; without a file and the files below it.
    fn edges(&self) -> Edges {
        let mut edges = Edges::new();
        for (name, module) in &self.0 {
            for Mention { from, path } in &module.mentions {
                let Some(full) = self.absolute(from, path) else { continue };
                let target = self.declares(&full, RE_EXPORTS);
                if !target.starts_with(name) && !name.starts_with(&target) {
                    edges.entry(name.join("::")).or_default().entry(target.join("::")).or_insert(path.join("::"));
                }
            }
        }
        edges
    }
}

/// From a file to a file, with a path that leads there.
type Edges = BTreeMap<String, BTreeMap<String, String>>;

/// All files that a file imports, directly or through others.
fn reached<'a>(edges: &'a Edges, from: &str) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut open: Vec<&str> = vec![from];
    while let Some(file) = open.pop() {
        for target in edges.get(file).into_iter().flat_map(BTreeMap::keys) {
            if found.insert(target.as_str()) {
                open.push(target);
            }
        }
    }
    found
}

/// The circles of files, each with its edges.
fn circles(edges: &Edges) -> Vec<String> {
    let reach: BTreeMap<&str, BTreeSet<&str>> =
        edges.keys().map(|file| (file.as_str(), reached(edges, file))).collect();
    let mut seen = BTreeSet::new();
    let mut found = Vec::new();
    for (file, targets) in &reach {
        if !targets.contains(file) || !seen.insert(*file) {
            continue;
        }
        let circle: BTreeSet<&str> =
            targets.iter().filter(|other| reach.get(*other).is_some_and(|back| back.contains(file))).copied().collect();
        let mut text = format!("circle of {} files", circle.len());
        for from in &circle {
            for (to, path) in edges[*from].iter().filter(|(to, _)| circle.contains(to.as_str())) {
                text += &format!("\n    {from} -> {to}  by {path}");
            }
        }
        seen.extend(circle);
        found.push(text);
    }
    found
}

/// The functions of a text with the numbers of their parameters, `self` not counted.
fn functions<'a>(tokens: &[&'a str]) -> Vec<(&'a str, usize)> {
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
    let (mut depth, mut count, mut fresh) = (0, 0, true);
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
        if fresh {
            let first = list[at..].iter().find(|token| !["&", "mut"].contains(*token));
            count += usize::from(first != Some(&"self"));
            fresh = false;
        }
    }
    count
}

/// The types, functions and modules that a text declares: keyword and name.
fn declared<'a>(tokens: &[&'a str]) -> Vec<(&'a str, &'a str)> {
    const NAMED: &[&str] = &["struct", "enum", "union", "trait", "type", "fn", "mod"];
    tokens
        .windows(2)
        .filter(|pair| NAMED.contains(&pair[0]) && is_word(pair[1]))
        .map(|pair| (pair[0], pair[1]))
        .collect()
}

/// The files of a folder of the repository, and of those below it: path and text.
fn files(folder: &str) -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let (mut found, mut open) = (Vec::new(), vec![root.join(folder)]);
    while let Some(folder) = open.pop() {
        for entry in fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                open.push(path);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let name = path.strip_prefix(root).unwrap().to_string_lossy().replace('\\', "/");
                found.push((name, fs::read_to_string(&path).unwrap()));
            }
        }
    }
    found.sort();
    found
}

fn sources_and_tests() -> impl Iterator<Item = (String, String)> {
    files("src").into_iter().chain(files("tests"))
}

#[test]
fn no_files_import_each_other_in_a_circle() {
    let files = files("src");
    let named = files.iter().map(|(name, text)| (name.trim_start_matches("src/"), text.as_str()));
    let circles = circles(&Crate::read(named).edges());
    assert!(circles.is_empty(), "{}", circles.join("\n"));
}

#[test]
fn no_function_has_more_than_five_parameters() {
    let mut wide = Vec::new();
    for (name, text) in sources_and_tests() {
        for (function, count) in functions(&tokens(&text)) {
            if count > PARAMETERS {
                wide.push(format!("{name}: fn {function} has {count} parameters"));
            }
        }
    }
    assert!(wide.is_empty(), "{}", wide.join("\n"));
}

/// The name of a module for a type: `ScrewTable` is `screw_table`.
fn file_name(name: &str) -> String {
    let letters = name.char_indices().map(|(at, sign)| match sign.is_uppercase() && at > 0 {
        true => format!("_{}", sign.to_lowercase()),
        false => sign.to_lowercase().to_string(),
    });
    letters.collect()
}

#[test]
fn no_retired_name_is_declared() {
    let files: BTreeMap<String, &str> = RETIRED.iter().map(|(name, today)| (file_name(name), *today)).collect();
    let retired_file = |name: &str| files.get(name).filter(|_| name != "window");
    let mut wrong = Vec::new();
    for (file, text) in sources_and_tests() {
        for part in file.trim_end_matches(".rs").split('/') {
            wrong.extend(retired_file(part).map(|today| format!("{file}: a file named {part} is retired: {today}")));
        }
        for (keyword, name) in declared(&tokens(&text)) {
            let homonym = HOMONYMS.iter().any(|(at, word, _)| *at == file && *word == name);
            let by_name = RETIRED.iter().find(|(retired, _)| *retired == name && !homonym).map(|(_, today)| today);
            let today = by_name.or_else(|| retired_file(name).filter(|_| keyword == "mod"));
            wrong.extend(today.map(|today| format!("{file}: {keyword} {name} is retired: {today}")));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_homonym_is_still_there() {
    for (file, word, meaning) in HOMONYMS {
        let text = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join(file)).unwrap();
        let found = declared(&tokens(&text)).iter().any(|(_, name)| name == word);
        assert!(found, "{file} declares no {word} ({meaning})");
    }
}

/// The circles of a crate given by its files.
fn circles_of(files: &[(&str, &str)]) -> Vec<String> {
    circles(&Crate::read(files.iter().copied()).edges())
}

#[test]
fn a_circle_is_found_with_its_edges() {
    let found = circles_of(&[
        ("lib.rs", "mod a; mod b; mod c;"),
        ("a.rs", "use crate::b::B; pub struct A;"),
        ("b.rs", "pub struct B; fn f() -> crate::c::C { super::c::C }"),
        ("c.rs", "use super::{a::{self, A as Other}, units::*}; pub struct C;"),
    ]);
    let edges = "circle of 3 files\n    a -> b  by crate::b::B\n    b -> c  by crate::c::C\n    c -> a  by super::a";
    assert_eq!(found, [edges]);
}

#[test]
fn a_re_export_is_followed_to_the_file_that_declares() {
    let re_export = |line: &'static str| {
        circles_of(&[
            ("p/mod.rs", line),
            ("p/a.rs", "use super::B; pub struct A;"),
            ("p/b.rs", "use super::a::A; pub struct B;"),
        ])
    };
    assert_eq!(re_export("mod a; mod b; pub use b::B;").len(), 1, "by name");
    assert_eq!(re_export("mod a; mod b; use self::b::*;").len(), 1, "all of it");
    assert_eq!(re_export("mod a; mod b; pub struct B;").len(), 0, "declared in the parent");
    let through_a_module = circles_of(&[
        ("p/mod.rs", "mod b; pub use b::B;"),
        ("p/b.rs", "pub struct B; use crate::a::A;"),
        ("a.rs", "use crate::p; pub struct A(p::B);"),
    ]);
    assert_eq!(through_a_module.len(), 1, "by the name of the module");
}

#[test]
fn a_file_and_the_files_below_it_make_no_circle() {
    let found = circles_of(&[
        ("p/mod.rs", "mod a; use a::A; pub struct P;"),
        ("p/a.rs", "use super::P; pub struct A; mod inside { use super::A; }"),
    ]);
    assert!(found.is_empty(), "{found:?}");
}

#[test]
fn comments_literals_and_unit_tests_import_nothing() {
    let text = r##"
        // use crate::b::B;
        /* crate::b::B /* nested */ crate::b::B */
        const TEXT: &str = "crate::b::B \" crate::b::B";
        const RAW: &str = r#"crate::b::B"#;
        fn quote<'a>(sign: char) -> bool { sign == '"' || sign == '\'' || sign == 'a' }
        #[cfg(test)]
        mod tests { use crate::b::B; fn f() { if true { B } } }
        pub struct A;
    "##;
    let found = circles_of(&[("a.rs", text), ("b.rs", "use crate::a::A; pub struct B;")]);
    assert!(found.is_empty(), "{found:?}");
    assert!(tokens(text).ends_with(&["pub", "struct", "A", ";"]));
}

#[test]
fn parameters_are_counted_beside_self() {
    let count = |text: &'static str| functions(&tokens(text));
    assert_eq!(count("fn f(a: u8, b: u8, c: u8, d: u8, e: u8, f: u8) {}"), [("f", 6)]);
    assert_eq!(count("fn f(&mut self, a: (u8, u8), b: Map<u8, [u8; 2]>,) {}"), [("f", 2)]);
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
    assert_eq!(file_name("ScrewTable"), "screw_table");
}
