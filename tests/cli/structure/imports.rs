//! Who imports whom: the paths of a file, followed through `use` and `pub use` to the file that declares a name; and the
//! circles among the files.

use std::collections::{BTreeMap, BTreeSet};

use super::tokens::{after_bracket, is_word, tokens, without_tests};

/// Most re-exports from a name to its declaration.
const RE_EXPORTS: usize = 8;

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
pub struct Crate(BTreeMap<Vec<String>, Module>);

impl Crate {
    /// Reads files, named by their paths below `src`.
    pub fn read<'a>(files: impl IntoIterator<Item = (&'a str, &'a str)>) -> Self {
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
    pub fn edges(&self) -> Edges {
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
pub type Edges = BTreeMap<String, BTreeMap<String, String>>;

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
pub fn circles(edges: &Edges) -> Vec<String> {
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
